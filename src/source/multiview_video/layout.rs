//! Folder layouts of multi-camera images.
//!
//! - *One folder per camera* next to one calibration, which names each camera once: by an image of its folder
//!   (`cam00/0000.png`, as COLMAP has calibrated one time step), or by the folder (`cam00`, `cam00.png`).
//! - *One folder per time step* next to one calibration: `0000/cam00.png`; it names the cameras as the files are named.
//! - *One folder per time step with a calibration of its own*: `frame_0000/transforms.json`, `colmap_0/sparse`. These
//!   need
//!   no calibration above them.
//!
//! *None of these.* A calibration that names several images of a folder is one of a camera that moved around one scene.
//! If the images that it names are next to the numbered folders, these are copies of them (`images_4`).

use super::clock::{Timed, timed, together};
use crate::natural::natural_order;
use crate::natural::{NamePiece, Runs};
use crate::photos::{self, Calibration, is_picture};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of a scene that contain the folders of cameras and time steps.
const BASES: &[&str] = &[
    "", "images", "image", "frames", "cameras", "videos", "input", "rgb", "photos", "imgs", "ims",
];

/// Possible sub-folders for images within the folder of a camera or time step.
const WITHIN: &[&str] = &["", "images", "image", "rgb", "data"];

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 200_000;

/// Layout of the images in folders.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Layout {
    /// The folder of each camera; none of a camera without one.
    Cameras(Vec<Option<PathBuf>>),
    /// Folders of time steps, in which images have the names of their cameras (in lower case, without an extension).
    TimeSteps { family: Family, stems: Vec<String> },
    /// Folders of time steps, each with a calibration.
    Sets(Family),
}

/// Folders whose names differ by their last number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Family {
    parent: PathBuf,
    pattern: String,
}

/// Time step and the location of its images.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FoundTimeStep {
    /// Names it: an image of it, or its folder.
    pub(super) timed: Timed,
    pub(super) images: Images,
}

/// Images of a time step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Images {
    /// Image of each camera, if it has one.
    OfCameras(Vec<Option<PathBuf>>),
    /// In a folder with a calibration.
    InFolder(PathBuf),
    /// Images of a calibration that were taken at one time, by their indices.
    Listed(Vec<usize>),
}

impl Layout {
    /// Returns the layout of the images that `calibration` names; `None` if it names images of one time step.
    pub(super) fn of(calibration: &Calibration) -> Option<Self> {
        let names: Vec<String> = calibration.names().map(plain_name).collect();
        let bases: Vec<PathBuf> = calibration
            .folders()
            .iter()
            .flat_map(|folder| BASES.iter().map(move |base| folder.join(base)))
            .filter(|base| base.is_dir())
            .collect();
        let found = cameras_in(&bases, &names).or_else(|| time_steps_in(&bases, &names))?;
        // A single time step is a set of images.
        (found.time_steps().len() > 1).then_some(found)
    }

    /// The layout of a folder without a calibration, in whose folders there are some.
    pub(super) fn of_sets(folder: &Path) -> Option<Self> {
        let mut families = families_in(folder).into_iter();
        let is_set = |path: &PathBuf| matches!(photos::find(path), Ok(Some(_)));
        let is_one = |(pattern, folders): (String, Vec<PathBuf>)| {
            // Two are checked because one alone could be misleading: folders of many scans are not examined one by one.
            let is_one = folders.len() > 1 && folders.iter().take(2).all(is_set);
            is_one.then(|| {
                Self::Sets(Family {
                    parent: folder.to_owned(),
                    pattern,
                })
            })
        };
        families.find_map(is_one)
    }

    /// Returns the time steps that currently exist, in order.
    pub(super) fn time_steps(&self) -> Vec<FoundTimeStep> {
        match self {
            Self::Cameras(folders) => time_steps_of_cameras(folders),
            Self::TimeSteps { family, stems } => {
                let found = family.folders().into_iter().map(|timed| {
                    let by_stem: HashMap<String, PathBuf> = pictures_within(&timed.entry.path)
                        .into_iter()
                        .rev()
                        .map(|path| (stem_of(&path), path))
                        .collect();
                    let images = stems.iter().map(|stem| by_stem.get(stem).cloned()).collect();
                    FoundTimeStep {
                        timed,
                        images: Images::OfCameras(images),
                    }
                });
                let has_image = |found: &FoundTimeStep| match &found.images {
                    Images::OfCameras(images) => images.iter().any(Option::is_some),
                    _ => true,
                };
                found.filter(has_image).collect()
            }
            Self::Sets(family) => {
                let sets = family.folders().into_iter();
                let sets = sets.filter(|timed| matches!(photos::find(&timed.entry.path), Ok(Some(_))));
                sets.map(|timed| FoundTimeStep {
                    images: Images::InFolder(timed.entry.path.clone()),
                    timed,
                })
                .collect()
            }
        }
    }

    /// Returns the display name of camera `index` of the calibration.
    pub(super) fn camera_name(&self, index: usize) -> Option<String> {
        match self {
            Self::Cameras(folders) => {
                let folder = folders.get(index)?.as_ref()?;
                let is_within = |name: &str| WITHIN.contains(&name);
                let name = |path: &Path| Some(path.file_name()?.to_string_lossy().into_owned());
                let own = name(folder)?;
                if is_within(&own) {
                    name(folder.parent()?)
                } else {
                    Some(own)
                }
            }
            Self::TimeSteps { stems, .. } => stems.get(index).cloned(),
            Self::Sets(_) => None,
        }
    }
}

impl Family {
    /// Its folders in their order.
    fn folders(&self) -> Vec<Timed> {
        let all = families_in(&self.parent).remove(&self.pattern).unwrap_or_default();
        timed(vec![all]).pop().unwrap_or_default()
    }
}

/// A separate folder for each of `names`: the folder of the image, its last part, or one named like the image.
fn cameras_in(bases: &[PathBuf], names: &[String]) -> Option<Layout> {
    let named: [fn(&str) -> &str; 3] = [
        |name| name.rsplit_once('/').map_or("", |(parent, _)| parent),
        |name| name.rsplit('/').nth(1).unwrap_or_default(),
        |name| {
            let last = name.rsplit('/').next().unwrap_or_default();
            last.rsplit_once('.').map_or(last, |(stem, _)| stem)
        },
    ];
    named.into_iter().find_map(|named| {
        let folders: Vec<Option<PathBuf>> = names.iter().map(|name| folder_named(bases, named(name))).collect();
        let known: Vec<&PathBuf> = folders.iter().flatten().collect();
        let distinct: HashSet<&PathBuf> = known.iter().copied().collect();
        // A folder that contains several of the named images does not belong to a static camera.
        let is_one_each = known.len() == distinct.len() && known.len() > 1 && 2 * known.len() >= names.len();
        is_one_each.then_some(Layout::Cameras(folders))
    })
}

/// The folder of this name that holds images.
fn folder_named(bases: &[PathBuf], name: &str) -> Option<PathBuf> {
    if name.is_empty() {
        return None;
    }
    let all = bases.iter().map(|base| base.join(name));
    all.flat_map(|folder| WITHIN.iter().map(move |within| folder.join(within)))
        .find(|folder| folder.is_dir() && !pictures_in(folder).is_empty())
        // Only the components, as `cam0/` and `cam0` are the same.
        .map(|folder| folder.components().collect())
}

/// A family of folders that hold files of the names.
fn time_steps_in(bases: &[PathBuf], names: &[String]) -> Option<Layout> {
    let stems: Vec<String> = names.iter().map(|name| stem_of(Path::new(name))).collect();
    let distinct: HashSet<&String> = stems.iter().collect();
    if distinct.len() < stems.len() || stems.len() < 2 {
        return None;
    }
    bases.iter().find_map(|base| {
        families_in(base).into_iter().find_map(|(pattern, folders)| {
            let first = folders.first().filter(|_| folders.len() > 1)?;
            let there: HashSet<String> = pictures_within(first).iter().map(|path| stem_of(path)).collect();
            let held = stems.iter().filter(|stem| there.contains(*stem)).count();
            let is_named_elsewhere = bases.iter().any(|base| {
                let of_name = |name: &String| {
                    let path = base.join(name);
                    path.is_file() && !folders.iter().any(|folder| path.starts_with(folder))
                };
                names.iter().any(of_name)
            });
            (held > 1 && 2 * held >= stems.len() && !is_named_elsewhere && !are_copies(&folders)).then(|| {
                Layout::TimeSteps {
                    family: Family {
                        parent: base.clone(),
                        pattern,
                    },
                    stems: stems.clone(),
                }
            })
        })
    })
}

/// Returns true for downscaled copies of the same images: `images_2`, `images_4`, `images_8`.
fn are_copies(folders: &[PathBuf]) -> bool {
    let halvings = |path: &PathBuf| {
        let name = path.file_name()?.to_str()?;
        name.strip_prefix("images_")?.parse::<u32>().ok()
    };
    folders
        .iter()
        .all(|folder| halvings(folder).is_some_and(u32::is_power_of_two))
}

fn time_steps_of_cameras(folders: &[Option<PathBuf>]) -> Vec<FoundTimeStep> {
    let images = |folder: &Option<PathBuf>| folder.as_deref().map_or_else(Vec::new, pictures_in);
    let cameras = timed(folders.iter().map(images).collect());
    let found = together(&cameras).into_iter().filter_map(|time_step| {
        let of_each = || cameras.iter().zip(&time_step.of_each);
        let first = of_each().find_map(|(images, at)| images.get((*at)?))?;
        let image = |(images, at): (&Vec<Timed>, &Option<usize>)| Some(images.get((*at)?)?.entry.path.clone());
        Some(FoundTimeStep {
            timed: first.clone(),
            images: Images::OfCameras(of_each().map(image).collect()),
        })
    });
    found.collect()
}

/// Returns the folders with a number in their name, except hidden ones, grouped by the rest of the name; each family in
/// natural order.
fn families_in(folder: &Path) -> BTreeMap<String, Vec<PathBuf>> {
    let mut families: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for path in entries_of(folder).into_iter().filter(|path| path.is_dir()) {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
            continue;
        };
        let mut pieces: Vec<NamePiece<'_>> = Runs(name).collect();
        let is_digits = |piece: &NamePiece<'_>| matches!(piece, NamePiece::Digits(_));
        let Some(last) = pieces.iter().rposition(is_digits) else {
            continue;
        };
        pieces[last] = NamePiece::Text("#");
        let text = |piece: &NamePiece<'_>| match *piece {
            NamePiece::Digits(text) | NamePiece::Text(text) => text.to_owned(),
        };
        families
            .entry(pieces.iter().map(text).collect())
            .or_default()
            .push(path);
    }
    families
}

/// The images in a folder, or in the first folder within it that has some.
fn pictures_within(folder: &Path) -> Vec<PathBuf> {
    let all = WITHIN.iter().map(|within| pictures_in(&folder.join(within)));
    all.into_iter().find(|found| !found.is_empty()).unwrap_or_default()
}

/// Returns the images in a folder, in natural order, excluding companion masks.
fn pictures_in(folder: &Path) -> Vec<PathBuf> {
    let is_mask = |path: &Path| {
        let stem = Path::new(path.file_stem().unwrap_or_default());
        let text = stem.to_string_lossy().to_lowercase();
        text.ends_with("_mask") || stem.extension().is_some_and(|second| second == "mask") || is_picture(stem)
    };
    let mut found = entries_of(folder);
    found.retain(|path| is_picture(path) && !is_mask(path));
    found
}

/// Lists the entries of a folder in natural order, excluding hidden files; empty if it cannot be listed.
pub(super) fn entries_of(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let entries = entries.take(MAX_ENTRIES).flatten();
    let is_shown = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        !name.as_encoded_bytes().starts_with(b".")
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_shown).collect();
    paths.sort_by(|left, right| natural_order(left, right));
    paths
}

/// A name with the separators of this system, from where the list is.
fn plain_name(name: &str) -> String {
    let name = name.replace('\\', "/");
    name.trim_start_matches("./").trim_end_matches('/').to_owned()
}

/// The name without folders and extension, in lower case.
fn stem_of(path: &Path) -> String {
    let stem = if is_picture(path) {
        path.file_stem()
    } else {
        path.file_name()
    };
    stem.unwrap_or_default().to_string_lossy().to_lowercase()
}
