//! Camera trajectories: poses from the frame of the camera to the world, at timestamps or of numbered or named frames.

use super::pairs::nearest;
use crate::natural::split_name;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

/// The poses of a recording.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::source) enum Trajectory {
    /// Poses at timestamps, in ascending order.
    Stamped(Vec<(Duration, Option<DAffine3>)>),
    /// Poses of frames by their numbers, from 0.
    Numbered(HashMap<usize, Option<DAffine3>>),
    /// Poses of frames by their names, as returned by [`key_of`].
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

    /// The poses of frames with these times and numbers in their names.
    ///
    /// Poses by times, if there are some; by their order, if there is one pose per frame; else by the numbers in the
    /// names, if each has a pose, as of every tenth image of a longer trajectory; else by their order from 0.
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
            // Stamps that are image numbers.
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
                // Names of the colour images, which are different: match by number.
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

    /// Returns the number of poses, including those of a lost camera.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Stamped(poses) => poses.len(),
            Self::Numbered(poses) => poses.len(),
            Self::Named(poses) => poses.len(),
        }
    }

    /// Returns the inverse poses: from the world to the camera.
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

/// 12 or 16 numbers, row by row; nothing for another number.
pub(in crate::source) fn matrix(rows: &[f64]) -> Option<DMat4> {
    let last_row = [0.0, 0.0, 0.0, 1.0];
    let all: Vec<f64> = match rows.len() {
        12 => rows.iter().copied().chain(last_row).collect(),
        _ => rows.to_vec(),
    };
    let numbers: [f64; 16] = all.try_into().ok()?;
    let columns = DMat4::from_cols_array(&numbers);
    // The last row shows whether the matrix is stored by rows or by columns.
    let is_by_columns = columns.row(3) == DVec4::W && columns.w_axis != DVec4::W;
    Some(if is_by_columns { columns } else { columns.transpose() })
}

/// A matrix that moves and turns, as the nearest that does so exactly; trackers write others where they are lost.
pub(in crate::source) fn rigid(matrix: Option<DMat4>) -> Option<DAffine3> {
    /// Rounding to four digits stays below it.
    const MAX_OFF: f64 = 0.05;
    let matrix = matrix.filter(DMat4::is_finite)?;
    let rotation = DMat3::from_mat4(matrix);
    let off = rotation.transpose() * rotation - DMat3::IDENTITY;
    let is_rotation = off.to_cols_array().iter().all(|off| off.abs() <= MAX_OFF) && rotation.determinant() > 0.0;
    let translation = matrix.w_axis.truncate();
    is_rotation.then(|| DAffine3::from_mat3_translation(rotation, translation))
}

/// A place and a rotation, if they are a pose; of a camera that was lost, some write zeros.
pub(super) fn pose_of(place: DVec3, rotation: DQuat) -> Option<DAffine3> {
    let is_pose = place.is_finite() && rotation.is_finite() && rotation.length() > 1e-6;
    is_pose.then(|| DAffine3::from_rotation_translation(rotation.normalize(), place))
}

/// The pose of a camera that was stated with y up and z backward (OpenGL, `ARKit`), in the common convention.
pub(super) fn of_backward(world_from_camera: DAffine3) -> DAffine3 {
    let turned = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    DAffine3 {
        matrix3: world_from_camera.matrix3 * turned,
        ..world_from_camera
    }
}

/// Returns the key shared by all names of one frame: without folders and extension, in lower case.
pub(in crate::source) fn key_of(name: &str) -> String {
    let name = name.replace('\\', "/");
    let is_extension = |extension: &str| extension.starts_with(|c: char| c.is_ascii_alphabetic());
    let stem = match split_name(Path::new(&name)) {
        (stem, extension) if is_extension(&extension) => stem.into_owned(),
        _ => name.rsplit('/').next().unwrap_or_default().to_owned(),
    };
    stem.to_lowercase()
}
