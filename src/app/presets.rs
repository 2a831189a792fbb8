//! Settings under a name, kept between runs in a small JSON file.

use super::preferences::offered_settings;
use crate::kept;
use crate::octree::StopCriterion;
use crate::scene::{Lod, Primitive, Settings};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Changes with every change of [`Stored`] that older programs, or newer ones, would misread.
const VERSION: u32 = 1;

/// More than a menu shows.
const MAX_PRESETS: usize = 50;

/// Longest name, characters.
const MAX_NAME_CHARS: usize = 60;

/// Settings under a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// What a person calls them; not empty.
    pub name: String,
    /// All of them.
    pub settings: Settings,
}

/// The presets of this person, by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Presets {
    list: Vec<Preset>,
    file: Option<PathBuf>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    presets: Vec<Preset>,
}

/// Ways to draw that every window offers: name, what it is, and how it draws. Colours and background are not theirs.
pub(super) fn built_in() -> [(&'static str, &'static str, Settings); 4] {
    let settings = Settings::default();
    [
        (
            "Fast",
            "Surfels of octree cells up to 2 px, at half the resolution",
            Settings {
                surfel_lod: true,
                lod: Lod::ThresholdPx(2.0),
                resolution: 0.5,
                ..settings
            },
        ),
        (
            "Exact",
            "Every point as a surfel at full resolution",
            Settings {
                surfel_lod: false,
                resolution: 1.0,
                ..settings
            },
        ),
        (
            "Points",
            "Every point as a square of 2 px",
            Settings {
                primitive: Primitive::Point,
                point_size_px: 2.0,
                ..settings
            },
        ),
        (
            "Voxels",
            "Cells of an octree with a loss δ of 5 %",
            Settings {
                primitive: Primitive::Voxel,
                stop: StopCriterion::Loss(0.05),
                ..settings
            },
        ),
    ]
}

impl Presets {
    /// Those of this person.
    pub fn load() -> Self {
        kept::place_of("presets.json").map_or_else(Self::default, Self::load_from)
    }

    /// Those in `file`, which need not be there yet. A file that cannot be used is told of in the log, and left aside as a whole.
    pub fn load_from(file: PathBuf) -> Self {
        let list = read(&file).unwrap_or_else(|reason| {
            log::warn!(
                "the presets in {} cannot be used ({reason}): the list begins anew",
                file.display()
            );
            Vec::new()
        });
        let file = Some(file);
        Self { list, file }
    }

    /// By name.
    pub fn list(&self) -> &[Preset] {
        &self.list
    }

    /// Keeps `settings` under `name`, in place of those that had it. `Err` is a text for a notice.
    pub fn save(&mut self, name: &str, settings: Settings) -> Result<(), String> {
        let name: String = name.trim().chars().take(MAX_NAME_CHARS).collect();
        if name.is_empty() {
            return Err("A preset needs a name".to_owned());
        }
        let settings = offered_settings(settings);
        match self.list.binary_search_by(|preset| preset.name.cmp(&name)) {
            Ok(place) => self.list[place].settings = settings,
            Err(_) if self.list.len() == MAX_PRESETS => {
                return Err(format!("There are {MAX_PRESETS} presets: delete one first"));
            }
            Err(place) => self.list.insert(place, Preset { name, settings }),
        }
        self.write()
    }

    /// Forgets those under `name`. `Err` is a text for a notice.
    pub fn delete(&mut self, name: &str) -> Result<(), String> {
        self.list.retain(|preset| preset.name != name);
        self.write()
    }

    fn write(&self) -> Result<(), String> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let stored = Stored {
            version: VERSION,
            presets: self.list.clone(),
        };
        let written = serde_json::to_vec_pretty(&stored)
            .map_err(std::io::Error::other)
            .and_then(|bytes| kept::replace(file, &bytes));
        written.map_err(|reason| {
            let file = file.display();
            format!("the presets could not be written to {file} ({reason}): make room")
        })
    }
}

fn read(file: &Path) -> Result<Vec<Preset>, String> {
    let Some(bytes) = kept::read(file)? else {
        return Ok(Vec::new());
    };
    let stored: Stored = serde_json::from_slice(&bytes).map_err(|reason| reason.to_string())?;
    if stored.version != VERSION {
        let version = stored.version;
        return Err(format!("it has version {version} instead of {VERSION}"));
    }
    let presets = stored.presets;
    if presets.len() > MAX_PRESETS || !presets.is_sorted_by(|a, b| a.name < b.name) {
        return Err("its list is too long or not in order".to_owned());
    }
    for Preset { name, settings } in &presets {
        let has_name = !name.trim().is_empty() && name.chars().count() <= MAX_NAME_CHARS;
        if !has_name || offered_settings(*settings) != *settings {
            return Err(format!("`{name}` has values that are not offered"));
        }
    }
    Ok(presets)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_kept_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("presets.json");
        let mut presets = Presets::load_from(file.clone());
        let [(_, _, fast), (_, _, exact), ..] = built_in();
        presets.save("night", fast).unwrap();
        presets.save(" day ", exact).unwrap();
        presets.save("night", exact).unwrap();
        assert!(presets.save("  ", fast).is_err());
        let names: Vec<_> = presets.list().iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["day", "night"]);
        assert_eq!(presets.list()[1].settings, exact);
        assert_eq!(Presets::load_from(file.clone()), presets);
        presets.delete("day").unwrap();
        assert_eq!(Presets::load_from(file).list().len(), 1);
    }

    #[test]
    fn damage_and_values_that_are_not_offered_are_left_aside() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("presets.json");
        let mut presets = Presets::load_from(file.clone());
        presets.save("a", Settings::default()).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        for (from, to) in [
            ("\"version\": 1", "\"version\": 9"),
            ("\"splat_scale\": 1.0", "\"splat_scale\": 1e9"),
            ("\"splat_scale\": 1.0", "\"splat_scale\": \"big\""),
            ("\"name\": \"a\"", "\"name\": \"\""),
            ("{", ""),
        ] {
            let damaged = text.replacen(from, to, 1);
            assert_ne!(damaged, text, "{from}");
            std::fs::write(&file, damaged).unwrap();
            assert!(Presets::load_from(file.clone()).list().is_empty(), "{to}");
        }
    }

    #[test]
    fn what_is_built_in_is_offered() {
        for (name, _, settings) in built_in() {
            assert_eq!(offered_settings(settings), settings, "{name}");
        }
    }
}
