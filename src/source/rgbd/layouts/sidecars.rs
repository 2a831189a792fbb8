//! Cameras and poses next to depth images, by the names that programs give them.
//!
//! A file that is named after a camera has to contain one. JSON of another name may be anything (labels, settings): it
//! is read as a camera if it is one. A text of the right name is looked for in the folder around the recording as well,
//! where data sets store files shared by all their recordings.

use super::{Calibration, Folder, FoundRecording, RgbdError};
use crate::messages::listed;
use crate::source::rgbd::folder::{has_extension, name_of};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The file of frames with their poses and lenses of nerfstudio and others.
pub(super) const TRANSFORMS: &str = "transforms.json";

/// Folders of cameras.
const CAMERA_FOLDERS: &[&str] = &["intrinsic", "intrinsics", "camera", "calibration"];

/// Extensions of cameras.
const CAMERA_FILES: &[&str] = &["json", "txt", "csv", "yaml", "yml", "xml", "npy"];

/// Extensions of trajectories.
const TRAJECTORY_FILES: &[&str] = &["log", "json", "txt", "csv", "npy", "npz", "tum", "g2o"];

/// Names of cameras that several recordings share, in the folder around them.
const SHARED: &[&str] = &[
    "cam_params.json",
    "camera-intrinsics.txt",
    "camera_intrinsics.txt",
    "intrinsics.txt",
];

/// Names of trajectories, the better first: odometry leads from frame to frame and drifts.
const TRAJECTORIES: &[&str] = &[
    "trajectory",
    "traj",
    "groundtruth",
    "pose",
    "c2w",
    "w2c",
    "cam2world",
    "extrinsics",
    "odom",
];

/// Words in the names of folders with a pose for each frame.
const POSE_FOLDERS: &[&str] = &["pose", "extrinsic", "c2w", "w2c", "cam2world", "trajectory"];

/// Point clouds that a note names.
const NAMED: usize = 3;

/// A camera next to depth images, and the camera of their colours if it is another one.
///
/// # Errors
/// A file with the name of a camera that contains none.
pub(super) fn camera(folder: &Folder, notes: &mut Vec<String>) -> Result<Option<Calibration>, RgbdError> {
    let mut files = folder.files(is_camera);
    if let Some(cameras) = folder.sub(CAMERA_FOLDERS) {
        let cameras = Folder::read(&cameras)?.files(|name| has_extension(name, CAMERA_FILES));
        files.extend(cameras.into_iter().filter(|path| !is_extrinsic(name_of(path))));
    }
    files.sort_by_key(|path| rank(name_of(path)));
    let around = folder.path.join("..");
    let shared = SHARED.iter().map(|name| around.join(name)).find(|path| path.is_file());
    let chosen = match (first_camera(&files, notes)?, shared) {
        (None, Some(shared)) => {
            notes.push(format!(
                "the camera is read from the folder around: {}",
                name_of(&shared)
            ));
            let calibration = Calibration::read(&shared)?;
            Some((shared, calibration))
        }
        (chosen, _) => chosen,
    };
    if let Some((chosen, mut calibration)) = chosen {
        let of_colors = files
            .iter()
            .find(|path| is_of_colors(name_of(path)) && **path != chosen);
        if let Some(colors) = of_colors {
            calibration.color = Some((Calibration::read(colors)?.depth, glam::DAffine3::IDENTITY));
            notes.push(format!(
                "no file says where the camera of {} is: colours are taken as registered, from the place of the depth \
                 camera",
                name_of(colors)
            ));
        }
        return Ok(Some(calibration));
    }
    let other =
        folder.files(|name| has_extension(name, &["json", "yaml", "yml", "ini", "cfg"]) && !is_trajectory(name));
    let told = other
        .iter()
        .find_map(|path| Some((path, Calibration::read(path).ok()?)));
    if let Some((path, calibration)) = told {
        if other.len() > 1 {
            notes.push(format!(
                "of {} files that may tell it, {} is read for the camera",
                other.len(),
                path.display()
            ));
        }
        return Ok(Some(calibration));
    }
    Ok(None)
}

/// The first of `files` that contains a camera. One that has to and does not is an error, others are noted.
fn first_camera(files: &[PathBuf], notes: &mut Vec<String>) -> Result<Option<(PathBuf, Calibration)>, RgbdError> {
    for path in files {
        let name = name_of(path).to_ascii_lowercase();
        let has_to = name.contains("intrinsic") || (has_extension(&name, &["json"]) && name.starts_with("cam"));
        match Calibration::read(path) {
            Ok(calibration) => {
                let others = files
                    .iter()
                    .filter(|other| *other != path && !is_of_colors(name_of(other)))
                    .count();
                if others > 0 {
                    let name = path.display();
                    notes.push(format!(
                        "of {} files with the name of a camera, {name} is read",
                        others + 1
                    ));
                }
                return Ok(Some((path.clone(), calibration)));
            }
            Err(error) if has_to => return Err(error),
            Err(error) => notes.push(format!("{error}; it is skipped")),
        }
    }
    Ok(None)
}

/// Returns true if a file next to depth images holds a camera or poses, by its name.
pub(super) fn is_known(name: &str) -> bool {
    is_camera(name) || is_trajectory(name)
}

/// Gives frames the poses of a file or a folder next to them. Unused files that look like poses are named.
pub(super) fn take_poses(folder: &Folder, found: &mut FoundRecording) -> Result<(), RgbdError> {
    let mut unused = Vec::new();
    for path in trajectories(folder) {
        if found.pose_count() > 0 {
            unused.push(name_of(&path).to_owned());
        } else {
            found.take_trajectory(&path);
        }
    }
    let is_of_poses = |name: &&String| {
        let name = name.to_lowercase();
        POSE_FOLDERS.iter().any(|word| name.contains(word))
    };
    for name in folder.folders().iter().filter(is_of_poses) {
        let files = Folder::read(&folder.path.join(name))?.files(|name| has_extension(name, &["txt", "npy"]));
        // A name alone means little.
        if files.is_empty() {
            continue;
        }
        if found.pose_count() > 0 {
            unused.push(name.clone());
        } else {
            found.take_pose_files(name, &files);
        }
    }
    if !unused.is_empty() && found.pose_count() > 0 {
        found.notes.push(format!(
            "{} {} like poses and {} not used: name one by --poses",
            listed(&unused, "and"),
            if unused.len() == 1 { "looks" } else { "look" },
            if unused.len() == 1 { "is" } else { "are" },
        ));
    }
    Ok(())
}

/// Cameras of frames, one for each that differs however many files say it.
#[derive(Default)]
pub(super) struct Distinct(Vec<Arc<Calibration>>);

impl Distinct {
    /// The known one of the same numbers, or `calibration`.
    pub(super) fn shared(&mut self, calibration: Calibration) -> Arc<Calibration> {
        let is_same = |known: &&Arc<Calibration>| {
            known.depth == calibration.depth
                && known.color == calibration.color
                && known.units_per_metre == calibration.units_per_metre
        };
        // A camera with autofocus has different parameters in each frame: only the last ones are compared.
        if let Some(known) = self.0.iter().rev().take(8).find(is_same) {
            return Arc::clone(known);
        }
        let calibration = Arc::new(calibration);
        self.0.push(Arc::clone(&calibration));
        calibration
    }
}

/// Reports the point clouds next to a recording that are not opened.
pub(super) fn note_of_clouds(folder: &Folder) -> Option<String> {
    let clouds: Vec<&str> = folder.clouds().into_iter().filter(|name| !is_known(name)).collect();
    let named: Vec<String> = clouds.iter().take(NAMED).map(|name| (*name).to_owned()).collect();
    let more = clouds.len().saturating_sub(NAMED);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    (!clouds.is_empty()).then(|| {
        format!(
            "the depth images are opened, and not {}{more} next to them: name the file to open it",
            listed(&named, "and")
        )
    })
}

/// Files with the poses of all frames, the better first.
pub(super) fn trajectories(folder: &Folder) -> Vec<PathBuf> {
    let named = |word: &'static str| {
        move |name: &str| {
            let name = name.to_ascii_lowercase();
            has_extension(&name, TRAJECTORY_FILES) && name.contains(word) && !name.contains("intrinsic")
        }
    };
    // ICL-NUIM stores the poses of its images under this extension.
    let freiburg = folder.files(|name| has_extension(name, &["freiburg"]));
    let transforms = folder.files(|name| name == TRANSFORMS);
    let mut found: Vec<PathBuf> = Vec::new();
    for path in TRAJECTORIES
        .iter()
        .flat_map(|word| folder.files(named(word)))
        .chain(freiburg)
        .chain(transforms)
    {
        if !found.contains(&path) {
            found.push(path);
        }
    }
    found
}

fn is_trajectory(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    [
        "trajectory",
        "traj",
        "pose",
        "odom",
        "fragment",
        "groundtruth",
        "c2w",
        "w2c",
    ]
    .iter()
    .any(|word| name.contains(word))
}

/// Returns true if `name` is a camera file's.
pub(super) fn is_camera(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    let stem = lower.rsplit_once('.').map_or(lower.as_str(), |(stem, _)| stem);
    let is_named = stem.contains("intrinsic") || stem.starts_with("cam") || stem.starts_with("calib") || stem == "k";
    has_extension(name, CAMERA_FILES) && is_named && !is_trajectory(name) && !is_extrinsic(name)
}

fn is_extrinsic(name: &str) -> bool {
    name.to_ascii_lowercase().contains("extrinsic")
}

fn is_of_colors(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ["color", "colour", "rgb"].iter().any(|word| name.contains(word))
}

/// Returns the rank of a camera file among several: the depth camera comes first, the colour camera last.
fn rank(name: &str) -> u8 {
    let lower = name.to_ascii_lowercase();
    match lower {
        _ if lower.contains("depth") => 0,
        _ if is_of_colors(&lower) => 3,
        _ if lower.contains("intrinsic") => 1,
        _ => 2,
    }
}

/// Returns true if the file at `path` has the given name, ignoring case.
pub(super) fn is_named(path: &Path, name: &str) -> bool {
    name_of(path).eq_ignore_ascii_case(name)
}
