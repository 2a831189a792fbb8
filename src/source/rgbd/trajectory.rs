//! Poses of a camera, from the files that programs write: from the frame of the camera to that of the world.

use super::error::RgbdError;
use super::folder::{has_extension, name_of};
use super::pairs::nearest;
use super::pose_json::of_json;
use super::pose_table::{self, key_of};
use super::text::{self, array, number_lines, read};
use crate::io::timestamps::time_of_number;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

/// The poses of a recording.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::source) enum Trajectory {
    /// At moments, which ascend.
    Stamped(Vec<(Duration, Option<DAffine3>)>),
    /// Of frames by their numbers, from 0.
    Numbered(HashMap<usize, Option<DAffine3>>),
    /// Of frames by their names, as [`key_of`] has them.
    Named(HashMap<String, Option<DAffine3>>),
}

impl Trajectory {
    /// The pose of frame `index`, which was taken at `time`.
    pub(in crate::source) fn pose(&self, index: usize, time: Option<Duration>) -> Option<DAffine3> {
        match self {
            Self::Stamped(poses) => {
                let at = nearest(poses.len(), |index| poses[index].0, time?)?;
                poses[at].1
            }
            Self::Numbered(poses) => poses.get(&index).copied().flatten(),
            Self::Named(_) => None,
        }
    }

    /// Those in the file at `path`, of any of the formats of [`RgbdError::Trajectory`].
    pub(in crate::source) fn read(path: &Path) -> Result<Self, RgbdError> {
        Ok(Self::read_and_tell(path)?.0)
    }

    /// The same, and whether an order of quaternions was taken that no header says: `qx qy qz qw`.
    pub(super) fn read_and_tell(path: &Path) -> Result<(Self, bool), RgbdError> {
        let wrong = |reason: String| RgbdError::Trajectory {
            path: path.to_owned(),
            reason,
        };
        if has_extension(name_of(path), &["npy"]) {
            let (shape, numbers) = array(path)?;
            let is_of_places = shape.len() == 2 && shape[1] == 7;
            return Ok((of_array(path, (shape, numbers))?, is_of_places));
        }
        if has_extension(name_of(path), &["npz"]) {
            return Ok((of_arrays(path)?, false));
        }
        let text = read(path)?;
        if text.trim_start().starts_with(['{', '[']) && (has_extension(name_of(path), &["json"]) || is_json(&text)) {
            return Ok((of_json(&text).map_err(wrong)?, false));
        }
        if let Some(poses) = pose_table::of_text(path, &text)? {
            return Ok((poses, false));
        }
        let lines = number_lines(path, &text)?;
        let Some((_, first)) = lines.first() else {
            return Err(wrong("it has no numbers".to_owned()));
        };
        let has_quaternions = matches!(first.len(), 7 | 8);
        let poses = match first.len() {
            7 => of_places(path, &lines),
            8 => of_tum(path, &text, &lines),
            3 => of_log(path, &lines),
            12 | 16 => {
                let matrices = lines.iter().map(|(_, numbers)| matrix(numbers));
                Ok(Self::listed(matrices.map(rigid)))
            }
            4 => of_rows(&lines).map_err(wrong),
            count => Err(wrong(format!("its first line has {count} numbers"))),
        };
        Ok((poses?, has_quaternions))
    }

    /// The poses of frames with these times and numbers in their names.
    ///
    /// By times, where there are some; by their order, where there are as many poses as frames; else by the numbers in
    /// the names, where each has a pose, as of every tenth image of a longer trajectory; else by their order from 0.
    pub(in crate::source) fn poses_of(
        &self,
        times: &[Option<Duration>],
        numbers: &[Option<usize>],
        names: &[String],
    ) -> Vec<Option<DAffine3>> {
        let all = |pose: &dyn Fn(usize) -> Option<DAffine3>| (0..times.len()).map(pose).collect();
        let has_times = times.iter().any(Option::is_some);
        let by_number = |count: usize| numbers.iter().all(|number| number.is_some_and(|number| number < count));
        match self {
            Self::Stamped(_) if has_times => all(&|index| self.pose(index, times[index])),
            Self::Stamped(poses) if poses.len() == times.len() => all(&|index| poses[index].1),
            // Stamps that are numbers of images.
            Self::Stamped(poses) => {
                let of_number = |number: usize| {
                    let stamp = Duration::from_secs(number as u64);
                    let at = poses.binary_search_by_key(&stamp, |(time, _)| *time).ok()?;
                    poses[at].1
                };
                all(&|index| of_number(numbers[index]?))
            }
            Self::Numbered(poses) => {
                let count = poses.keys().max().map_or(0, |last| last + 1);
                if count != times.len() && by_number(count) {
                    all(&|index| poses.get(&numbers[index]?).copied().flatten())
                } else {
                    all(&|index| poses.get(&index).copied().flatten())
                }
            }
            Self::Named(poses) => {
                let named = |index: usize| poses.get(&key_of(&names[index])).copied().flatten();
                if (0..names.len()).any(|index| named(index).is_some()) {
                    return all(&named);
                }
                // Names of the colour images of other names: their numbers.
                let by_number: HashMap<usize, Option<DAffine3>> = poses
                    .iter()
                    .filter_map(|(name, pose)| Some((last_number(name)?, *pose)))
                    .collect();
                if by_number.len() < poses.len() {
                    return all(&|_| None);
                }
                all(&|index| by_number.get(&numbers[index]?).copied().flatten())
            }
        }
    }

    /// The times of the poses, unless those are the numbers of frames from 0 or 1.
    pub(in crate::source) fn stamps(&self) -> Option<Vec<Duration>> {
        let Self::Stamped(poses) = self else { return None };
        let times: Vec<Duration> = poses.iter().map(|(time, _)| *time).collect();
        let count = |from: u64| {
            (from..)
                .zip(&times)
                .all(|(number, time)| *time == Duration::from_secs(number))
        };
        let grow = times.windows(2).all(|pair| pair[0] < pair[1]);
        (grow && !count(0) && !count(1)).then_some(times)
    }

    /// How many there are, those of a lost camera among them.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Stamped(poses) => poses.len(),
            Self::Numbered(poses) => poses.len(),
            Self::Named(poses) => poses.len(),
        }
    }

    /// The same poses the other way round: from the world to the camera.
    #[must_use]
    pub(in crate::source) fn inverse(self) -> Self {
        let turned = |pose: Option<DAffine3>| pose.map(|pose| pose.inverse());
        match self {
            Self::Stamped(poses) => Self::Stamped(poses.into_iter().map(|(time, pose)| (time, turned(pose))).collect()),
            Self::Numbered(poses) => Self::Numbered(poses.into_iter().map(|(at, pose)| (at, turned(pose))).collect()),
            Self::Named(poses) => Self::Named(poses.into_iter().map(|(name, pose)| (name, turned(pose))).collect()),
        }
    }

    pub(super) fn listed(poses: impl Iterator<Item = Option<DAffine3>>) -> Self {
        Self::Numbered(poses.enumerate().collect())
    }
}

/// The last number in a name without its extension.
pub(in crate::source) fn last_number(stem: &str) -> Option<usize> {
    let digits = stem.rsplit(|c: char| !c.is_ascii_digit()).find(|run| !run.is_empty());
    digits?.parse().ok()
}

/// Whether a text of any extension is JSON and no rows in brackets.
fn is_json(text: &str) -> bool {
    serde_json::from_str::<serde::de::IgnoredAny>(text).is_ok()
}

/// The one array of an archive that can be poses, by its name.
fn of_arrays(path: &Path) -> Result<Trajectory, RgbdError> {
    const KEYS: [&str; 7] = [
        "pose",
        "c2w",
        "cam2world",
        "camera_to_world",
        "w2c",
        "world2cam",
        "extrinsic",
    ];
    let arrays = text::arrays(path)?;
    let named = KEYS
        .iter()
        .find_map(|key| arrays.iter().find(|(name, _)| name.to_lowercase().contains(key)));
    let Some((name, found)) = named else {
        let names: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
        return Err(RgbdError::Trajectory {
            path: path.to_owned(),
            reason: format!("none of its arrays ({}) is named after poses", names.join(", ")),
        });
    };
    let poses = of_array(path, found.clone())?;
    let name = name.to_lowercase();
    let is_inverse = ["w2c", "world2cam", "extrinsic"].iter().any(|key| name.contains(key));
    Ok(if is_inverse { poses.inverse() } else { poses })
}

/// An array of numpy: a pose per entry of its first dimension, as a matrix or as `x y z qx qy qz qw`.
fn of_array(path: &Path, (shape, numbers): (Vec<usize>, Vec<f64>)) -> Result<Trajectory, RgbdError> {
    // One matrix alone is one pose.
    let is_one = matches!(*shape.as_slice(), [3 | 4, 4]);
    let width = if is_one {
        numbers.len()
    } else {
        shape.iter().skip(1).product::<usize>()
    };
    match width {
        7 => {
            let lines: Vec<(usize, Vec<f64>)> = numbers
                .chunks_exact(7)
                .map(<[f64]>::to_vec)
                .zip(1..)
                .map(|(row, at)| (at, row))
                .collect();
            of_places(path, &lines)
        }
        12 | 16 => Ok(Trajectory::listed(
            numbers.chunks_exact(width).map(|rows| rigid(matrix(rows))),
        )),
        _ => Err(RgbdError::Trajectory {
            path: path.to_owned(),
            reason: format!("its array has {width} numbers per entry"),
        }),
    }
}

/// The one pose in a file of 4 × 4 numbers; `None` where the camera was lost.
pub(in crate::source) fn read_pose(path: &Path) -> Result<Option<DAffine3>, RgbdError> {
    match Trajectory::read(path)? {
        trajectory @ Trajectory::Numbered(_) => Ok(trajectory.pose(0, None)),
        Trajectory::Stamped(_) | Trajectory::Named(_) => Err(RgbdError::Trajectory {
            path: path.to_owned(),
            reason: "it has times or names, and one pose was expected".to_owned(),
        }),
    }
}

/// 12 or 16 numbers, row by row; nothing for another number.
pub(in crate::source) fn matrix(rows: &[f64]) -> Option<DMat4> {
    let last_row = [0.0, 0.0, 0.0, 1.0];
    let all: Vec<f64> = match rows.len() {
        12 => rows.iter().copied().chain(last_row).collect(),
        _ => rows.to_vec(),
    };
    let numbers: [f64; 16] = all.try_into().ok()?;
    let columns = DMat4::from_cols_array(&numbers);
    // The last row says which way round they are.
    let is_by_columns = columns.row(3) == DVec4::W && columns.w_axis != DVec4::W;
    Some(if is_by_columns { columns } else { columns.transpose() })
}

/// A matrix that moves and turns, as the nearest that does so exactly; trackers write others where they are lost.
pub(in crate::source) fn rigid(matrix: Option<DMat4>) -> Option<DAffine3> {
    /// Rounding to four digits stays below it.
    const MOST_OFF: f64 = 0.05;
    let matrix = matrix.filter(DMat4::is_finite)?;
    let rotation = DMat3::from_mat4(matrix);
    let off = rotation.transpose() * rotation - DMat3::IDENTITY;
    let is_rotation = off.to_cols_array().iter().all(|off| off.abs() <= MOST_OFF) && rotation.determinant() > 0.0;
    let translation = matrix.w_axis.truncate();
    is_rotation.then(|| DAffine3::from_mat3_translation(rotation, translation))
}

/// `x y z qx qy qz qw`, a line per frame.
fn of_places(path: &Path, lines: &[(usize, Vec<f64>)]) -> Result<Trajectory, RgbdError> {
    let wrong = |line: usize, reason: &str| RgbdError::Line {
        path: path.to_owned(),
        line,
        reason: reason.to_owned(),
    };
    let mut poses = Vec::with_capacity(lines.len());
    for (line, numbers) in lines {
        let Ok(numbers) = <[f64; 7]>::try_from(numbers.as_slice()) else {
            return Err(wrong(*line, "expected a place x y z and a rotation qx qy qz qw"));
        };
        let [x, y, z, qx, qy, qz, qw] = numbers;
        poses.push(pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw)));
        let is_unit = |at: usize| {
            let quaternion = &numbers[at..at + 4];
            (quaternion.iter().map(|part| part * part).sum::<f64>().sqrt() - 1.0).abs() < 0.01
        };
        if is_unit(0) && !is_unit(3) {
            return Err(wrong(*line, "its rotation comes first: expected x y z qx qy qz qw"));
        }
    }
    Ok(Trajectory::listed(poses.into_iter()))
}

/// A place and a rotation, if they are a pose; of a camera that was lost, some write zeros.
pub(super) fn pose_of(place: DVec3, rotation: DQuat) -> Option<DAffine3> {
    let is_pose = place.is_finite() && rotation.is_finite() && rotation.length() > 1e-6;
    is_pose.then(|| DAffine3::from_rotation_translation(rotation.normalize(), place))
}

/// The pose of a camera that was told with y up and z backward (OpenGL, `ARKit`), as others have it.
pub(super) fn of_backward(world_from_camera: DAffine3) -> DAffine3 {
    let turned = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    DAffine3 {
        matrix3: world_from_camera.matrix3 * turned,
        ..world_from_camera
    }
}

/// `time x y z qx qy qz qw`.
fn of_tum(path: &Path, text: &str, lines: &[(usize, Vec<f64>)]) -> Result<Trajectory, RgbdError> {
    let wrong = |line: usize, reason: &str| RgbdError::Line {
        path: path.to_owned(),
        line,
        reason: reason.to_owned(),
    };
    let texts: Vec<&str> = text.lines().collect();
    let mut poses = Vec::with_capacity(lines.len());
    for (line, numbers) in lines {
        let &[_, x, y, z, qx, qy, qz, qw] = numbers.as_slice() else {
            return Err(wrong(
                *line,
                "expected a time, a place x y z and a rotation qx qy qz qw",
            ));
        };
        let stamp = texts[line - 1].split([' ', '\t', ',']).find(|word| !word.is_empty());
        let time = stamp.and_then(time_of_number);
        let time = time.ok_or_else(|| wrong(*line, "the time is no number of seconds from 0 up"))?;
        poses.push((time, pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw))));
    }
    poses.sort_by_key(|(time, _)| *time);
    Ok(Trajectory::Stamped(poses))
}

/// Blocks of a line of three whole numbers, of which the first is that of the frame, and four of a matrix.
fn of_log(path: &Path, lines: &[(usize, Vec<f64>)]) -> Result<Trajectory, RgbdError> {
    let mut poses = HashMap::with_capacity(lines.len() / 5);
    for block in lines.chunks(5) {
        let (line, head) = &block[0];
        let number = head.first().filter(|&&number| number >= 0.0 && number.fract() == 0.0);
        let rows: Vec<f64> = block[1..].iter().flat_map(|(_, row)| row.iter().copied()).collect();
        let (Some(&number), 16, 3) = (number, rows.len(), head.len()) else {
            return Err(RgbdError::Line {
                path: path.to_owned(),
                line: *line,
                reason: "expected the number of a frame and two more, then four lines of a matrix".to_owned(),
            });
        };
        poses.insert(number as usize, rigid(matrix(&rows)));
    }
    Ok(Trajectory::Numbered(poses))
}

/// Matrices of 4 × 4 or 3 × 4 numbers, a row a line.
fn of_rows(lines: &[(usize, Vec<f64>)]) -> Result<Trajectory, String> {
    let rows: Vec<&[f64]> = lines.iter().map(|(_, row)| row.as_slice()).collect();
    if let Some(row) = rows.iter().find(|row| row.len() != 4) {
        return Err(format!("a row has {} numbers, and 4 were expected", row.len()));
    }
    // Of a camera that was lost, some write what is no number into the last row too.
    let is_last = |row: &&[f64]| row[..3] == [0.0; 3] || row.iter().all(|number| !number.is_finite());
    let is_by_columns = |rows: &[&[f64]]| rows.iter().map(|row| row[3]).eq([0.0, 0.0, 0.0, 1.0]);
    let are_whole = rows.len().is_multiple_of(4)
        && (rows.iter().skip(3).step_by(4).all(is_last) || rows.chunks(4).all(is_by_columns));
    let height = if are_whole { 4 } else { 3 };
    if !rows.len().is_multiple_of(height) {
        return Err(format!("{} rows are no matrices of 4 or 3 rows", rows.len()));
    }
    let matrices = rows.chunks(height).map(|rows| matrix(&rows.concat()));
    Ok(Trajectory::listed(matrices.map(rigid)))
}

#[cfg(test)]
#[path = "trajectory_tests.rs"]
mod tests;
