//! Named settings, stored in a small JSON file.
//!
//! **How it works.** Presets, and their values, are parsed one by one: a missing or unknown one gets its default, a
//! number that is not offered is replaced by the nearest. So presets outlive versions of this program; a file with
//! unreadable parts is copied before it is written (`stored/lenient.rs`). Several windows share it: one that saves or
//! deletes a preset changes that one alone, in the file as it is then (`stored/update.rs`).

use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::persist::{self, Fields};
use crate::scene::{Primitive, Settings, VoxelLight};
use serde::Serialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Changes where the same word would mean something else. Further settings and further words need no other version.
const VERSION: u32 = 1;

/// More than a menu shows.
const MAX_PRESETS: usize = 50;

/// Longest name, characters.
const MAX_NAME_CHARS: usize = 60;

/// Settings under a name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preset {
    /// Display name of the preset; not empty.
    pub name: String,
    /// All of them.
    pub settings: Settings,
}

/// The presets of this user, by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Presets {
    list: Vec<Preset>,
    file: Option<PathBuf>,
    problem: Option<String>,
}

/// Name of the file's contents in messages.
const WHAT: &str = "the presets";

/// The name of the list in the file.
const LIST: &str = "presets";

/// Built-in render-mode presets that every window offers: name, description, and settings. They do not include colours
/// and background.
pub(super) fn built_in() -> [(&'static str, &'static str, Settings); 4] {
    let settings = Settings::default();
    [
        (
            "Fast",
            "Surfels of octree cells up to 2 px, at half the resolution",
            settings.with(|style| {
                style.levels.surfel_lod = true;
                style.levels.lod = Lod::ThresholdPx(2.0);
                style.drawing.resolution = 0.5;
            }),
        ),
        (
            "Exact",
            "Every point as a surfel at full resolution",
            settings.with(|style| {
                style.levels.surfel_lod = false;
                style.drawing.resolution = 1.0;
            }),
        ),
        (
            "Points",
            "Every point as a square of 2 px",
            settings.with(|style| {
                style.primitive = Primitive::Point.into();
                style.points.size_px = 2.0;
            }),
        ),
        (
            "Voxels",
            "Cells of an octree, as large as it takes to close surfaces",
            settings.with(|style| {
                style.primitive = Primitive::Voxel.into();
                style.voxels.light = VoxelLight::Normals;
                style.levels.stop = StopCriterion::Spacing;
            }),
        ),
    ]
}

impl Presets {
    /// Loads the current user's presets.
    pub fn load() -> Self {
        persist::place_of("presets.json").map_or_else(Self::default, |file| Self::load_from(&file))
    }

    /// Those in `file`, which need not be there yet.
    pub fn load_from(file: &Path) -> Self {
        let read = persist::read_leniently(file, WHAT, presets_of);
        Self {
            list: read.value,
            file: read.file,
            problem: read.problem,
        }
    }

    /// Returns the load problem, if any: the unreadable parts and the path of the copy, as text for a notice.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// By name.
    pub fn list(&self) -> &[Preset] {
        &self.list
    }

    /// Saves `settings` under `name`, replacing any settings of that name. `Err` is a text for a notice.
    pub fn save(&mut self, name: &str, settings: Settings) -> Result<(), String> {
        let name = as_name(name);
        if name.is_empty() {
            return Err("A preset needs a name".to_owned());
        }
        let is_known = self.list.iter().any(|preset| preset.name == name);
        if !is_known && self.list.len() >= MAX_PRESETS {
            return Err(format!("There are {MAX_PRESETS} presets: delete one first"));
        }
        let preset = Preset {
            name,
            settings: settings.nearest(),
        };
        let stored = serde_json::to_value(&preset).map_err(|reason| reason.to_string())?;
        self.change(&preset.name.clone(), Some((preset, stored)))
    }

    /// Forgets those under `name`. `Err` is a text for a notice.
    pub fn delete(&mut self, name: &str) -> Result<(), String> {
        self.change(name, None)
    }

    /// Puts `preset` in the place of the one called `name`, here and in the file as it is now.
    fn change(&mut self, name: &str, preset: Option<(Preset, Value)>) -> Result<(), String> {
        let (preset, value) = preset.unzip();
        let list = &mut self.list;
        let Some(file) = &self.file else {
            list.retain(|preset| preset.name != name);
            list.extend(preset);
            list.sort_by(|a, b| a.name.cmp(&b.name));
            return Ok(());
        };
        let written = persist::update(file, WHAT, |stored, unread| {
            persist::note_later_version(stored, VERSION, unread);
            let mut entries = persist::readable_entries(stored, LIST, unread, is_readable);
            entries.retain(|entry| name_of(entry) != name);
            entries.extend(value);
            entries.sort_by_key(name_of);
            stored.insert(LIST.to_owned(), Value::Array(entries));
            stored.insert("version".to_owned(), VERSION.into());
            // Unreadable entries were already reported when the file was first read.
            *list = presets_of(stored, &mut Vec::new());
        });
        written.map_err(|reason| {
            let file = file.display();
            format!("{WHAT} could not be written to {file} ({reason}): free disk space")
        })
    }
}

/// `text` as a stored name; may be empty.
fn as_name(text: &str) -> String {
    text.trim().chars().take(MAX_NAME_CHARS).collect()
}

/// The name of a preset as a file holds it.
fn name_of(entry: &Value) -> String {
    as_name(entry["name"].as_str().unwrap_or_default())
}

/// Returns true if anything can be read from a list entry.
fn is_readable(entry: &Value) -> bool {
    entry["settings"].is_object() && !name_of(entry).is_empty()
}

/// The presets in the object of a file, by name.
fn presets_of(stored: &Fields, unread: &mut Vec<String>) -> Vec<Preset> {
    persist::note_later_version(stored, VERSION, unread);
    let mut presets: Vec<Preset> = Vec::new();
    for entry in persist::entries(stored, LIST, unread) {
        let name = name_of(entry);
        let Value::Object(settings) = &entry["settings"] else {
            unread.push(format!("the preset `{name}` has no settings"));
            continue;
        };
        if name.is_empty() {
            unread.push("a preset has no name".to_owned());
            continue;
        }
        let mut unread_here = Vec::new();
        let settings = persist::fields::<Settings>(settings, &mut unread_here).nearest();
        unread.extend(unread_here.iter().map(|reason| format!("`{name}`: {reason}")));
        match presets.binary_search_by(|preset| preset.name.cmp(&name)) {
            Ok(_) => unread.push(format!("`{name}` is there twice")),
            Err(place) => presets.insert(place, Preset { name, settings }),
        }
    }
    presets
}

#[cfg(test)]
mod tests;
