//! Resolution of a folder to its frame files, wherever below it they are.
//!
//! **How it works.** Clouds directly in the folder are its frames. Otherwise its sub-folders are searched: numbered
//! ones with one cloud each are *one folder per frame*; numbered ones whose file numbers continue from one to the next
//! are parts of one sequence; of others the only one with clouds is opened, as in the roots of KITTI
//! (`velodyne_points/data`, `velodyne`), nuScenes (`samples/LIDAR_TOP`) and SLAM programs (`pcd`, `Scans`). If several
//! are possible, the choices are returned to the caller. Clouds next to a folder of numbered frames, such as the map
//! that a SLAM program merged, are skipped.

use super::names::{Minus, SplitName};
use super::series::{Tier, is_list, largest_series};
use crate::io::Format;
use crate::natural::{natural_order, split_name};
use crate::source::SequenceError;
use crate::source::error::OpeningChoice;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Levels of folders below the one that was named: `sequences/00/velodyne_points/data` are four.
const MAX_DEPTH: usize = 5;

/// Folders that are looked into, where they are not numbered.
const MAX_FOLDERS: usize = 256;

/// Names of folders for the frames of one sensor, in lower case, the ones to prefer first.
pub(super) const FRAME_FOLDERS: [&str; 24] = [
    "velodyne_points",
    "velodyne",
    "lidar_top",
    "lidar",
    "lidars",
    "pcd",
    "pcds",
    "scans",
    "scan",
    "pointclouds",
    "pointcloud",
    "point_clouds",
    "point_cloud",
    "clouds",
    "cloud",
    "points",
    "keyframes",
    "key_frames",
    "frames",
    "data",
    "ply",
    "las",
    "samples",
    "sweeps",
];

/// Files of a folder and of those below it.
#[derive(Debug, Default)]
pub(super) struct FoundFiles {
    /// Files with known extensions, frames among them.
    pub(super) files: Vec<PathBuf>,
    /// The folder that they are in, if it is not the one that was named.
    pub(super) below: Option<PathBuf>,
    /// Clouds next to that folder.
    pub(super) skipped: Vec<PathBuf>,
    /// A sentence about other sensors.
    pub(super) note: Option<String>,
}

/// A folder as it is listed, without hidden entries.
struct Listing {
    files: Vec<PathBuf>,
    folders: Vec<PathBuf>,
}

impl Listing {
    fn of(folder: &Path) -> Result<Self, SequenceError> {
        let unreadable = |reason| SequenceError::Unreadable {
            path: folder.to_path_buf(),
            reason,
        };
        let (mut files, mut folders) = (Vec::new(), Vec::new());
        for entry in fs::read_dir(folder).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let path = entry.path();
            if is_hidden(&path) {
                continue;
            }
            let kind = entry.file_type().map_err(unreadable)?;
            // Only links need another file system access.
            let is_folder = kind.is_dir() || (kind.is_symlink() && path.is_dir());
            if is_folder {
                folders.push(path);
            } else if Format::of_extension(&path).is_some() {
                files.push(path);
            }
        }
        skip_buffers(&mut files);
        folders.sort_by(|left, right| natural_order(left, right));
        Ok(Self { files, folders })
    }

    /// Returns true if the files include frames: clouds, arrays or numbered text, and not only lists.
    fn has_frames(&self) -> bool {
        let is_cloud = |file: &PathBuf| Tier::of(file) != Tier::Text;
        self.files.iter().any(is_cloud) || largest_series(&self.files).len() > 1
    }
}

/// The files below `folder`; an empty list if there are none.
///
/// # Errors
/// [`SequenceError::Several`], and [`SequenceError::Unreadable`].
pub(super) fn find(folder: &Path) -> Result<FoundFiles, SequenceError> {
    find_to_depth(folder, MAX_DEPTH)
}

fn find_to_depth(folder: &Path, depth: usize) -> Result<FoundFiles, SequenceError> {
    let listing = Listing::of(folder)?;
    if listing.folders.is_empty() || depth == 0 {
        return Ok(direct(listing.files));
    }
    if listing.has_frames() {
        let is_merged = largest_series(&listing.files).len() < 2;
        let below = if is_merged {
            frames_below_map(&listing, depth)
        } else {
            None
        };
        return Ok(match below {
            Some(found) => FoundFiles {
                skipped: listing
                    .files
                    .into_iter()
                    .filter(|file| Tier::of(file) != Tier::Text)
                    .collect(),
                ..found
            },
            None => direct(listing.files),
        });
    }
    match below(folder, &listing, depth)? {
        Some(found) => Ok(found),
        None => Ok(direct(listing.files)),
    }
}

fn direct(files: Vec<PathBuf>) -> FoundFiles {
    FoundFiles {
        files,
        ..FoundFiles::default()
    }
}

/// Numbered frames in a folder for frames, next to which a program wrote the map that it merged.
fn frames_below_map(listing: &Listing, depth: usize) -> Option<FoundFiles> {
    let folder = listing.folders.iter().find(|folder| is_frame_folder(folder))?;
    let mut found = find_to_depth(folder, depth - 1).ok()?;
    if largest_series(&found.files).len() < 2 || 2 * listing.files.len() > found.files.len() {
        return None;
    }
    found.below.get_or_insert_with(|| folder.clone());
    Some(found)
}

/// Returns true if `folder` has a name typical of a folder with the frames of one sensor.
pub(super) fn is_frame_folder(folder: &Path) -> bool {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    FRAME_FOLDERS.contains(&name.as_str())
}

/// Returns the files found in the sub-folders of `folder`; `None` if there are no clouds.
fn below(folder: &Path, listing: &Listing, depth: usize) -> Result<Option<FoundFiles>, SequenceError> {
    let numbered = numbered_folders(&listing.folders);
    if numbered.len() > 1
        && let Some(found) = of_numbered(folder, &numbered, depth)?
    {
        return Ok(Some(found));
    }
    let mut found: Vec<(PathBuf, Result<FoundFiles, SequenceError>)> = Vec::new();
    for child in listing.folders.iter().take(MAX_FOLDERS) {
        match find_to_depth(child, depth - 1) {
            Ok(files) if files.files.iter().all(|file| is_list(file)) => {}
            result => found.push((child.clone(), result)),
        }
    }
    // Text files in other folders, such as the poses and labels next to scans.
    let has_clouds = |result: &Result<FoundFiles, SequenceError>| match result {
        Ok(found) => found.files.iter().any(|file| Tier::of(file) == Tier::Cloud),
        Err(error) => matches!(error, SequenceError::Several { .. }),
    };
    if found.iter().any(|(_, result)| has_clouds(result)) {
        found.retain(|(_, result)| has_clouds(result));
    }
    let mut note = None;
    // Annotated key frames and all frames, as in nuScenes.
    if found.len() == 2
        && ["samples", "sweeps"]
            .iter()
            .all(|name| found.iter().any(|(child, _)| child.ends_with(name)))
    {
        found.retain(|(child, _)| child.ends_with("samples"));
        note = Some("the frames of sweeps are skipped: open that folder to see them".to_owned());
    }
    // Of the sensors of a car, the LiDAR on its roof.
    if let Some(place) = found.iter().position(|(child, _)| child.ends_with("LIDAR_TOP")) {
        if found.len() > 1 {
            note = Some("of several sensors LIDAR_TOP is shown: open the folder of another one to see it".to_owned());
        }
        found = vec![found.swap_remove(place)];
    }
    if found.len() > 1 {
        let choices = found.iter().map(|(child, result)| choice_of(child, result)).collect();
        return Err(SequenceError::Several {
            path: folder.to_owned(),
            choices,
        });
    }
    let Some((child, result)) = found.pop() else {
        return Ok(None);
    };
    let mut files = result?;
    files.below.get_or_insert(child);
    files.note = note.or(files.note);
    Ok(Some(files))
}

fn choice_of(folder: &Path, result: &Result<FoundFiles, SequenceError>) -> OpeningChoice {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let label = match result {
        Ok(found) => match found.files.len() {
            1 => format!("{name} (1 file)"),
            count => format!("{name} ({count} files)"),
        },
        Err(_) => name.into_owned(),
    };
    OpeningChoice {
        label: format!("{label}: {}", folder.display()),
        option: None,
        input: folder.to_owned(),
    }
}

/// The folders whose names differ only in their numbers, of the most frequent kind.
fn numbered_folders(folders: &[PathBuf]) -> Vec<PathBuf> {
    let mut by_letters: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for folder in folders {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let name = SplitName::of(&name, Minus::AfterSeparator);
        if !name.numbers.is_empty() {
            by_letters.entry(name.letters()).or_default().push(folder.clone());
        }
    }
    by_letters.into_values().max_by_key(Vec::len).unwrap_or_default()
}

/// Numbered folders that are one sequence; `None` if there is nothing in them.
fn of_numbered(folder: &Path, numbered: &[PathBuf], depth: usize) -> Result<Option<FoundFiles>, SequenceError> {
    let mut parts: Vec<(PathBuf, Result<FoundFiles, SequenceError>)> = Vec::new();
    for child in numbered {
        match find_to_depth(child, depth - 1) {
            Ok(found) if found.files.iter().all(|file| is_list(file)) => {}
            Err(SequenceError::Unreadable { .. }) => {}
            result => parts.push((child.clone(), result)),
        }
    }
    if parts.is_empty() {
        return Ok(None);
    }
    let clouds: Option<Vec<Vec<PathBuf>>> = parts
        .iter()
        .map(|(_, result)| Some(clouds_of(result.as_ref().ok()?)))
        .collect();
    let files = clouds.and_then(|clouds| {
        let is_folder_per_frame = clouds.iter().all(|files| files.len() == 1) || have_equal_names(&clouds);
        (is_folder_per_frame || go_on(&clouds)).then(|| clouds.concat())
    });
    match files {
        Some(files) => Ok(Some(FoundFiles {
            files,
            below: Some(folder.to_owned()),
            ..FoundFiles::default()
        })),
        None if parts.len() == 1 => {
            let (child, result) = parts.swap_remove(0);
            let mut found = result?;
            found.below.get_or_insert(child);
            Ok(Some(found))
        }
        None => Err(SequenceError::Several {
            path: folder.to_owned(),
            choices: parts.iter().map(|(child, result)| choice_of(child, result)).collect(),
        }),
    }
}

/// The files of the best tier.
fn clouds_of(found: &FoundFiles) -> Vec<PathBuf> {
    let best = found.files.iter().map(|file| Tier::of(file)).min();
    let mut files: Vec<PathBuf> = found.files.clone();
    files.retain(|file| Some(Tier::of(file)) == best && (best != Some(Tier::Text) || !is_list(file)));
    files.sort_by(|left, right| natural_order(left, right));
    files
}

/// Returns true if the files of all folders have the same few names without numbers, as in `000/body.ply` and
/// `000/head.ply`.
fn have_equal_names(folders: &[Vec<PathBuf>]) -> bool {
    const MAX_NAMES: usize = 8;
    let names = |files: &[PathBuf]| -> Vec<String> {
        let names = files.iter().filter_map(|file| file.file_name());
        names.map(|name| name.to_string_lossy().into_owned()).collect()
    };
    let has_number = |name: &String| name.contains(|c: char| c.is_ascii_digit());
    let first = names(&folders[0]);
    let are_few = (1..=MAX_NAMES).contains(&first.len()) && !first.iter().any(has_number);
    are_few && folders.iter().all(|files| names(files) == first)
}

/// Returns true if file numbers continue from each folder to the next, as in a recording that was split into parts.
fn go_on(folders: &[Vec<PathBuf>]) -> bool {
    let last_number = |file: &PathBuf| {
        let name = SplitName::of(&split_name(file).0, Minus::AfterSeparator);
        name.numbers.last().map(|number| number.value)
    };
    let mut before = f64::NEG_INFINITY;
    for files in folders.iter().filter(|files| !files.is_empty()) {
        let (Some(first), Some(last)) = (last_number(&files[0]), last_number(&files[files.len() - 1])) else {
            return false;
        };
        if first <= before || last < first {
            return false;
        }
        before = last;
    }
    true
}

/// `.bin` files next to a glTF file are its buffers.
fn skip_buffers(files: &mut Vec<PathBuf>) {
    let has_extension = |path: &Path, wanted: &str| {
        path.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
    };
    if files.iter().any(|path| has_extension(path, "gltf")) {
        files.retain(|path| !has_extension(path, "bin"));
    }
}

pub(super) fn is_hidden(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        folder
    }

    fn found(names: &[&str]) -> Vec<String> {
        let folder = folder(names);
        let mut files = find(folder.path()).unwrap().files;
        files.sort_by(|left, right| natural_order(left, right));
        let relative = |file: &PathBuf| file.strip_prefix(folder.path()).unwrap().display().to_string();
        files.iter().map(relative).collect()
    }

    fn choices(names: &[&str]) -> Vec<String> {
        let folder = folder(names);
        match find(folder.path()) {
            Err(SequenceError::Several { choices, .. }) => choices
                .iter()
                .map(|choice| choice.input.strip_prefix(folder.path()).unwrap().display().to_string())
                .collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn gltf_buffers_are_not_scans() {
        let left_of = |names: &[&str]| {
            let mut files = names.iter().map(PathBuf::from).collect();
            skip_buffers(&mut files);
            files
        };
        assert_eq!(left_of(&["a/Fox.bin", "a/Fox.GLTF"]), [Path::new("a/Fox.GLTF")]);
        assert_eq!(left_of(&["a/0.bin", "a/1.bin"]).len(), 2);
    }

    #[test]
    fn a_folder_per_frame_is_a_sequence() {
        assert_eq!(found(&["000/cloud.ply", "001/cloud.ply"]).len(), 2);
        assert_eq!(found(&["f9/a.pcd", "f10/a.pcd", "f10/data"]), ["f9/a.pcd", "f10/a.pcd"]);
        assert_eq!(found(&["0/x/c.las", "1/x/c.las", "1/times.txt"]).len(), 2);
        assert_eq!(found(&["0.5/c.ply", "0.25/c.ply", "notes/a.md"]).len(), 2);
        assert_eq!(found(&["t/0/1.xyz", "t/1/7.xyz"]).len(), 2);
    }

    #[test]
    fn parts_of_a_recording_are_one_sequence() {
        assert_eq!(found(&["p0/1.ply", "p0/2.ply", "p1/3.ply", "p1/4.ply"]).len(), 4);
        assert_eq!(choices(&["p0/1.ply", "p0/2.ply", "p1/1.ply", "p1/2.ply"]), ["p0", "p1"]);
    }

    #[test]
    fn roots_of_data_sets_open_the_frames_in_them() {
        for files in [
            &[
                "velodyne_points/data/0.bin",
                "velodyne_points/data/1.bin",
                "oxts/data/0.txt",
                "oxts/data/1.txt",
            ][..],
            &[
                "velodyne/000000.bin",
                "velodyne/000001.bin",
                "calib.txt",
                "times.txt",
                "poses.txt",
            ],
            &["pcd/0.pcd", "pcd/1.pcd", "pose.json"],
            &[
                "Scans/0.pcd",
                "Scans/1.pcd",
                "optimized_poses.txt",
                "labels/0.txt",
                "labels/1.txt",
            ],
            &[
                "samples/LIDAR_TOP/a1.pcd.bin",
                "samples/LIDAR_TOP/a2.pcd.bin",
                "samples/RADAR/b1.pcd",
                "samples/RADAR/b2.pcd",
            ],
            &["take/0.ply", "take/1.ply", "README.txt"],
        ] {
            assert_eq!(found(files).len(), 2, "{files:?}");
        }
        let map = folder(&["GlobalMap.pcd", "Scans/0.pcd", "Scans/1.pcd", "Scans/2.pcd"]);
        let found = find(map.path()).unwrap();
        assert_eq!((found.files.len(), found.skipped.len()), (3, 1));
    }

    #[test]
    fn several_sequences_need_a_choice() {
        assert_eq!(
            choices(&["walk/0.ply", "walk/1.ply", "run/0.ply", "run/1.ply"]),
            ["run", "walk"]
        );
        let of_kitti = [
            "sequences/00/velodyne/0.bin",
            "sequences/00/velodyne/1.bin",
            "sequences/01/velodyne/0.bin",
        ];
        assert_eq!(
            choices(&[&of_kitti[..], &["sequences/01/velodyne/1.bin"]].concat()),
            ["sequences/00", "sequences/01"]
        );
    }

    #[test]
    fn clouds_in_the_folder_itself_are_its_frames() {
        assert_eq!(found(&["a.ply", "b.ply", "deeper/c.ply"]), ["a.ply", "b.ply"]);
        assert_eq!(found(&["scan.txt", "pictures/a.png"]), ["scan.txt"]);
    }
}
