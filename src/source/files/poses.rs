//! Poses of frames: lists next to them, which move the points of each file into one coordinate system.
//!
//! **How it works.** Lists are found by name in the folder of the frames and those above it, as KITTI (`poses.txt`,
//! `../../poses/00.txt`), `SemanticKITTI`, SLAM programs (`optimized_poses.txt`, `pose.json`, TUM trajectories) and
//! `hdl_graph_slam` (`data` in each folder) write them. A list is used if it has poses for at least half of the frames.
//! Poses of KITTI's odometry belong to the left camera: with `Tr` of `calib.txt`, from LiDAR to camera, they become the
//! LiDAR's, and its axes stay (Geiger et al. 2012). KITTI's raw recordings have positions of a GPS with an inertial
//! unit instead ([`super::oxts`]).

use super::registered::are_registered;
use super::{nuscenes, oxts};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::messages::grouped;
use crate::natural::{natural_order, split_name};
use crate::source::FrameEntry;
use crate::source::rgbd::{INVERT_POSES, Trajectory, last_number, matrix, number_lines, read_pose, read_text, rigid};
use crate::source::{NO_POSES, SequenceError};
use glam::{DAffine3, DQuat, DVec3};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Names of lists, the ones to prefer first.
const LISTS: [&str; 22] = [
    "poses.txt",
    "pose.txt",
    "optimized_poses.txt",
    "poses_kitti.txt",
    "poses_tum.txt",
    "optimized_poses_tum.txt",
    "pose.json",
    "poses.json",
    "trajectory.txt",
    "trajectory.json",
    "trajectory.log",
    "traj.txt",
    "traj.log",
    "trajectory_tum.txt",
    "traj_tum.txt",
    "trajectory.tum",
    "groundtruth.txt",
    "gt_poses.txt",
    "gt.txt",
    "odom_poses.txt",
    "odometry.txt",
    "poses.csv",
];

/// Folders with a file of a pose per frame.
const FOLDERS: [&str; 6] = ["poses", "pose", "Poses", "Pose", "odom", "trajectory"];

/// Poses of frames, and the findings about lists of them.
#[derive(Debug, Default)]
pub(super) struct FoundPoses {
    pub(super) assumption: Option<Assumption>,
    /// Lists and calibrations that were used.
    pub(super) used: Vec<PathBuf>,
    /// Times of the frames, if only the list has times.
    pub(super) times: Option<(Vec<Duration>, PathBuf)>,
    /// Sentences about lists that were not, and frames without a pose.
    pub(super) notes: Vec<String>,
}

/// Poses of all frames, in their order.
type Poses = Vec<Option<DAffine3>>;

/// Gives `entries` their poses: from the file `given`, none for [`NO_POSES`], or from a list in `folders` if nothing is
/// given.
///
/// # Errors
/// If the file that is given cannot be read, or has poses for less than half of the frames.
pub(super) fn place(
    entries: &mut [FrameEntry],
    folders: &[PathBuf],
    given: Option<&Path>,
    inverted: bool,
) -> Result<FoundPoses, SequenceError> {
    let mut found = FoundPoses::default();
    if given == Some(Path::new(NO_POSES)) || entries.is_empty() {
        return Ok(found);
    }
    let refused = |path: &Path, reason: String| SequenceError::Poses {
        path: path.to_owned(),
        reason,
    };
    let poses = match given {
        Some(list) => {
            let (poses, times) = read_list(list, entries).map_err(|reason| refused(list, reason))?;
            found.times = times.map(|times| (times, list.to_owned()));
            Some(in_sensor_axes(poses, list, folders, &mut found.used))
        }
        None => find(entries, folders, &mut found),
    };
    let Some((poses, why)) = poses else {
        return Ok(found);
    };
    // Explicitly given poses are not questioned.
    if given.is_none() && are_registered(entries, &poses) {
        let used = std::mem::take(&mut found.used);
        let list = used.first().map_or(why, |list| list.display().to_string());
        found.notes.push(format!(
            "{list} is not used for poses: the frames are in one coordinate system already, as they meet better \
             without it (--poses FILE uses it all the same)"
        ));
        return Ok(found);
    }
    let lost = poses.iter().filter(|pose| pose.is_none()).count();
    if lost > 0 {
        found.notes.push(format!(
            "{} of {} frames have no pose in {}: they stay in the coordinates of their sensor",
            grouped(lost),
            grouped(entries.len()),
            why
        ));
    }
    for (entry, pose) in entries.iter_mut().zip(&poses) {
        entry.pose = if inverted {
            pose.map(|pose| pose.inverse())
        } else {
            *pose
        };
    }
    // A user's statement is not an assumption.
    if given.is_some() {
        return Ok(found);
    }
    let value = format!("{} of {} frames", grouped(poses.len() - lost), grouped(entries.len()));
    let why = format!("{why}; sensor to world, {INVERT_POSES} says the opposite");
    found.assumption = Some(Assumption::new(Subject::Poses, value, why, Evidence::File));
    Ok(found)
}

/// The poses of the first list in `folders` that fits.
fn find(entries: &[FrameEntry], folders: &[PathBuf], found: &mut FoundPoses) -> Option<(Poses, String)> {
    if let Some(poses) = of_folders_of_frames(entries) {
        return Some((poses, "files `data` of hdl_graph_slam".to_owned()));
    }
    let lists = LISTS
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let above = folders.iter().filter_map(|folder| {
        let name = folder.file_name()?.to_str()?;
        Some(folder.parent()?.parent()?.join("poses").join(format!("{name}.txt")))
    });
    let known: Vec<PathBuf> = lists.chain(above).filter(|list| list.is_file()).collect();
    let others = folders.iter().flat_map(|folder| lists_in(folder));
    let others: Vec<PathBuf> = others
        .filter(|list| !known.contains(list) && entries.iter().all(|entry| entry.path != *list))
        .collect();
    for list in known.into_iter().chain(others) {
        match read_list(&list, entries) {
            Ok((poses, times)) => {
                found.times = times.map(|times| (times, list.clone()));
                return Some(in_sensor_axes(poses, &list, folders, &mut found.used));
            }
            Err(reason) => found
                .notes
                .push(format!("{} is not used for poses: {reason}", list.display())),
        }
    }
    for folder in folders.iter().flat_map(|folder| FOLDERS.map(|name| folder.join(name))) {
        if let Some(poses) = of_folder(&folder, entries, false) {
            return Some((poses, folder.display().to_string()));
        }
    }
    // `000000.txt` next to `000000.pcd`.
    if let Some(folder) = folders.first()
        && let Some(poses) = of_folder(folder, entries, true)
    {
        let own = entries.iter().map(|entry| entry.path.with_extension("txt"));
        found.used.extend(own);
        return Some((
            poses,
            format!(
                "the text file of the same name next to each file in {}",
                folder.display()
            ),
        ));
    }
    for folder in folders {
        if let Some((poses, tables)) = nuscenes::poses(folder, entries) {
            return Some((poses, tables.display().to_string()));
        }
    }
    let oxts = folders.iter().map(|folder| folder.join("oxts"));
    oxts.into_iter().find_map(|folder| {
        let poses = oxts::poses(&folder, entries)?;
        Some((poses, format!("{} (GPS and inertial unit)", folder.display())))
    })
}

/// Poses of the LiDAR if `poses` belong to KITTI's camera and a calibration is in one of `folders`.
fn in_sensor_axes(poses: Poses, list: &Path, folders: &[PathBuf], used: &mut Vec<PathBuf>) -> (Poses, String) {
    used.push(list.to_owned());
    let has_rows_of_kitti = || {
        let text = read_text(list).ok()?;
        let lines = number_lines(list, &text).ok()?;
        (lines.first()?.1.len() == 12).then_some(())
    };
    let calibrations = folders.iter().map(|folder| folder.join("calib.txt"));
    let found = has_rows_of_kitti().and_then(|()| {
        calibrations
            .into_iter()
            .find_map(|path| Some((camera_from_lidar(&path)?, path)))
    });
    let Some((camera_from_lidar, calibration)) = found else {
        return (poses, list.display().to_string());
    };
    let lidar_from_camera = camera_from_lidar.inverse();
    let of_lidar = |pose: Option<DAffine3>| pose.map(|pose| lidar_from_camera * pose * camera_from_lidar);
    let why = format!("{} with Tr of {}", list.display(), calibration.display());
    used.push(calibration);
    (poses.into_iter().map(of_lidar).collect(), why)
}

/// `Tr` of KITTI's calibration, from the LiDAR to the camera.
fn camera_from_lidar(calibration: &Path) -> Option<DAffine3> {
    let text = crate::regular_file::read_to_string(calibration).ok()?;
    text.lines().find_map(|line| {
        let (name, numbers) = line.split_once(':')?;
        if !["Tr", "Tr_velo_to_cam", "Tr_velo_cam"].contains(&name.trim()) {
            return None;
        }
        let numbers: Option<Vec<f64>> = numbers.split_whitespace().map(|word| word.parse().ok()).collect();
        rigid(matrix(&numbers?))
    })
}

/// Files in `folder` whose names mark them as poses.
fn lists_in(folder: &Path) -> Vec<PathBuf> {
    const WORDS: [&str; 5] = ["pose", "traj", "odom", "groundtruth", "ground_truth"];
    const EXTENSIONS: [&str; 8] = ["txt", "csv", "tum", "json", "npy", "npz", "log", "g2o"];
    let is_list = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
        let is_named = extension == "g2o" || WORDS.iter().any(|word| name.contains(word));
        is_named && EXTENSIONS.contains(&extension) && path.is_file()
    };
    let mut lists: Vec<PathBuf> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(is_list)
        .collect();
    lists.sort_by(|left, right| natural_order(left, right));
    lists
}

/// The poses in the file `list` for each of `entries`, and their times where the frames have none.
fn read_list(list: &Path, entries: &[FrameEntry]) -> Result<(Poses, Option<Vec<Duration>>), String> {
    let rows = || {
        let text = read_text(list).ok()?;
        let rows = number_lines(list, &text).ok()?;
        Some(rows.into_iter().map(|(_, row)| row).collect::<Vec<_>>())
    };
    let is_text = list
        .extension()
        .is_some_and(|extension| extension != "npy" && extension != "npz");
    let has_names = || read_text(list).is_ok_and(|text| text.contains(['q', 'Q', '{']));
    let plain = if is_text && !has_names() {
        rows().and_then(|rows| of_rows(&rows))
    } else {
        None
    };
    let poses = match plain {
        Some(rows) => rows?,
        None => Trajectory::read(list).map_err(|error| error.to_string())?,
    };
    let times = poses
        .stamps()
        .filter(|_| entries.iter().all(|entry| entry.time.is_none()));
    let times = times.filter(|times| times.len() == entries.len());
    let poses = for_entries(&poses, entries).ok_or_else(|| {
        format!(
            "it does not have poses for the {} frames: one per frame, by number from 0, by name, or within 20 ms of \
             their times",
            entries.len()
        )
    })?;
    Ok((poses, times))
}

/// Rows of `x y z` with a quaternion whose order no header states.
fn of_rows(rows: &[Vec<f64>]) -> Option<Result<Trajectory, String>> {
    let width = rows.first()?.len();
    if !rows.iter().all(|row| row.len() == width) {
        return None;
    }
    match width {
        7 => Some(of_quaternions(rows)),
        _ => None,
    }
}

/// `x y z` and a quaternion whose first pose determines if `w` is first (HBA, BALM) or last: it is hardly turned.
fn of_quaternions(rows: &[Vec<f64>]) -> Result<Trajectory, String> {
    const MIN_W: f64 = 0.9;
    let first = &rows[0];
    let w_is_first = match (first[3].abs() > MIN_W, first[6].abs() > MIN_W) {
        (true, false) => true,
        (false, true) => false,
        _ => {
            return Err(
                "its rows are x y z and a quaternion, and nothing says whether w is its first number \
                        or its last: write rows of a time, x y z, qx qy qz qw"
                    .to_owned(),
            );
        }
    };
    let pose = |row: &Vec<f64>| {
        let rotation = if w_is_first {
            DQuat::from_xyzw(row[4], row[5], row[6], row[3])
        } else {
            DQuat::from_xyzw(row[3], row[4], row[5], row[6])
        };
        let is_pose = rotation.is_finite() && rotation.length() > 1e-6;
        is_pose.then(|| DAffine3::from_rotation_translation(rotation.normalize(), DVec3::new(row[0], row[1], row[2])))
    };
    let poses: HashMap<usize, Option<DAffine3>> = rows.iter().map(pose).enumerate().collect();
    Ok(Trajectory::Numbered(poses))
}

/// The pose of each of `entries`; `None` if less than half have one.
fn for_entries(trajectory: &Trajectory, entries: &[FrameEntry]) -> Option<Poses> {
    let is_enough = |poses: &Poses| 2 * poses.iter().flatten().count() >= poses.len();
    match trajectory {
        Trajectory::Numbered(listed) => {
            // Frames of a part of a recording use the lines of their numbers.
            let by_number = |entry: &FrameEntry| trajectory.pose(usize::try_from(entry.number?).ok()?, None);
            let has_number = |entry: &FrameEntry| {
                let number = entry.number.and_then(|number| usize::try_from(number).ok());
                number.is_some_and(|number| listed.contains_key(&number))
            };
            let numbered = entries.iter().filter(|entry| has_number(entry)).count();
            // A list that ends before the frames do has no pose for the last ones.
            let is_short = listed.len() < entries.len() && entries.first().and_then(|entry| entry.number) == Some(0);
            if numbered == entries.len() || (is_short && 2 * numbered >= entries.len()) {
                return Some(entries.iter().map(by_number).collect()).filter(is_enough);
            }
            let in_order = || (0..entries.len()).map(|index| trajectory.pose(index, None)).collect();
            (listed.len() == entries.len()).then(in_order).filter(is_enough)
        }
        Trajectory::Named(_) => {
            let times = vec![None; entries.len()];
            let numbers = entries.iter().map(|entry| usize::try_from(entry.number?).ok());
            let names = entries.iter().map(|entry| entry.path.display().to_string());
            let numbers: Vec<Option<usize>> = numbers.collect();
            let names: Vec<String> = names.collect();
            Some(trajectory.poses_of(&times, &numbers, &names)).filter(is_enough)
        }
        Trajectory::Stamped(listed) => {
            let by_time: Poses = entries.iter().map(|entry| trajectory.pose(0, entry.time)).collect();
            if is_enough(&by_time) {
                return Some(by_time);
            }
            (listed.len() == entries.len())
                .then(|| listed.iter().map(|(_, pose)| *pose).collect())
                .filter(is_enough)
        }
    }
}

/// Files of one pose in `folder`, named as the frames are, or by the same numbers unless the names have to be the same.
fn of_folder(folder: &Path, entries: &[FrameEntry], by_name_alone: bool) -> Option<Poses> {
    let stem_of = |path: &Path| split_name(path).0.into_owned();
    let mut by_stem: HashMap<String, PathBuf> = HashMap::new();
    for file in fs::read_dir(folder).ok()?.flatten() {
        let path = file.path();
        let is_pose = path.extension().is_some_and(|extension| {
            extension == "txt" || (!by_name_alone && (extension == "npy" || extension == "odom"))
        });
        if is_pose {
            by_stem.insert(stem_of(&path), path);
        }
    }
    let numbered = by_stem
        .iter()
        .filter_map(|(stem, path)| Some((last_number(stem)?, path)));
    let by_number: HashMap<usize, &PathBuf> = numbered.collect();
    let is_numbered = !by_name_alone && by_number.len() == by_stem.len();
    let file_of = |entry: &FrameEntry| {
        let stem = stem_of(&entry.path);
        let numbered = || by_number.get(&last_number(&stem)?).copied();
        by_stem
            .get(&stem)
            .or_else(|| if is_numbered { numbered() } else { None })
    };
    // If the text file next to the first cloud is not a pose, none of them are.
    let first = file_of(entries.first()?)?;
    // A text file that is a frame itself is not a pose.
    if *first == entries.first()?.path {
        return None;
    }
    read_pose(first).ok()?;
    let poses: Poses = entries
        .iter()
        .map(|entry| read_pose(file_of(entry)?).ok().flatten())
        .collect();
    (2 * poses.iter().flatten().count() >= poses.len()).then_some(poses)
}

/// Poses in files `data` next to `cloud.pcd`, as `hdl_graph_slam` dumps its key frames: `estimate` and a matrix.
fn of_folders_of_frames(entries: &[FrameEntry]) -> Option<Poses> {
    let pose = |entry: &FrameEntry| -> Option<Option<DAffine3>> {
        let text = fs::read_to_string(entry.path.parent()?.join("data")).ok()?;
        let mut lines = text.lines().skip_while(|line| line.trim() != "estimate").skip(1);
        let rows: Vec<f64> = lines
            .by_ref()
            .take(4)
            .flat_map(str::split_whitespace)
            .filter_map(|word| word.parse().ok())
            .collect();
        (rows.len() == 16).then(|| rigid(matrix(&rows)))
    };
    entries.iter().map(pose).collect()
}
