//! Poses of a camera, from the files that programs write: from the frame of the camera to that of the world.

use super::error::RgbdError;
use super::folder::{has_extension, name_of};
use super::pairs::nearest;
use super::text::{array, number_lines, read};
use crate::io::timestamps::times_of_lines;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use serde_json::Value;
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
        }
    }

    /// Those in the file at `path`, of any of the formats of [`RgbdError::Trajectory`].
    pub(in crate::source) fn read(path: &Path) -> Result<Self, RgbdError> {
        let wrong = |reason: String| RgbdError::Trajectory {
            path: path.to_owned(),
            reason,
        };
        if has_extension(name_of(path), &["npy"]) {
            return of_array(path);
        }
        let text = read(path)?;
        if text.trim_start().starts_with('{') {
            return of_json(&text).map_err(wrong);
        }
        let lines = number_lines(path, &text)?;
        let Some((_, first)) = lines.first() else {
            return Err(wrong("it has no numbers".to_owned()));
        };
        match first.len() {
            7 => of_places(path, &lines),
            8 => of_tum(path, &text, &lines),
            3 => of_log(path, &lines),
            12 | 16 => {
                let matrices = lines.iter().map(|(_, numbers)| matrix(numbers));
                Ok(Self::listed(matrices.map(rigid)))
            }
            4 => of_rows(&lines).map_err(wrong),
            count => Err(wrong(format!("its first line has {count} numbers"))),
        }
    }

    /// The poses of frames with these times and numbers in their names.
    ///
    /// By times, where there are some; by their order, where there are as many poses as frames; else by the numbers in
    /// the names, where each has a pose, as of every tenth image of a longer trajectory; else by their order from 0.
    pub(super) fn poses_of(&self, times: &[Option<Duration>], numbers: &[Option<usize>]) -> Vec<Option<DAffine3>> {
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
        }
    }

    fn listed(poses: impl Iterator<Item = Option<DAffine3>>) -> Self {
        Self::Numbered(poses.enumerate().collect())
    }
}

/// An array of numpy: a pose per entry of its first dimension, as a matrix or as `x y z qx qy qz qw`.
fn of_array(path: &Path) -> Result<Trajectory, RgbdError> {
    let (shape, numbers) = array(path)?;
    let width = shape.iter().skip(1).product::<usize>();
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
        Trajectory::Stamped(_) => Err(RgbdError::Trajectory {
            path: path.to_owned(),
            reason: "it has times, and one pose was expected".to_owned(),
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
        let time = stamp.and_then(times_of_lines).and_then(|times| times.first().copied());
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
    let are_whole = rows.len().is_multiple_of(4) && rows.iter().skip(3).step_by(4).all(is_last);
    let height = if are_whole { 4 } else { 3 };
    if !rows.len().is_multiple_of(height) {
        return Err(format!("{} rows are no matrices of 4 or 3 rows", rows.len()));
    }
    let matrices = rows.chunks(height).map(|rows| matrix(&rows.concat()));
    Ok(Trajectory::listed(matrices.map(rigid)))
}

/// The trajectories and graphs of Open3D, whose matrices are column by column. A trajectory has *extrinsics*, which
/// lead from the world to the camera; a graph has poses.
fn of_json(text: &str) -> Result<Trajectory, String> {
    let json: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let of_columns = |value: &Value| {
        let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
        let numbers: [f64; 16] = numbers?.try_into().ok()?;
        rigid(Some(DMat4::from_cols_array(&numbers)))
    };
    if let Some(parameters) = json.get("parameters").and_then(Value::as_array) {
        let poses = parameters.iter().map(|camera| {
            let camera_from_world = of_columns(camera.get("extrinsic")?)?;
            Some(camera_from_world.inverse())
        });
        return Ok(Trajectory::listed(poses));
    }
    if let Some(nodes) = json.get("nodes").and_then(Value::as_array) {
        return Ok(Trajectory::listed(
            nodes.iter().map(|node| of_columns(node.get("pose")?)),
        ));
    }
    Err("its JSON has neither `parameters` nor `nodes`".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn written(name: &str, text: &str) -> Result<Trajectory, RgbdError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        Trajectory::read(&path)
    }

    /// A quarter turn around z and a way.
    fn pose() -> DAffine3 {
        DAffine3::from_rotation_translation(
            DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
            DVec3::new(1.0, 2.0, 3.0),
        )
    }

    #[test]
    fn every_format_says_the_same_pose() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let rows = "0 -1 0 1\n1 0 0 2\n0 0 1 3\n";
        let open3d = "[0,-1,0,0, 1,0,0,0, 0,0,1,0, -2,1,-3,1]";
        for (name, text) in [
            ("a.log", format!("0 0 1\n{rows}0 0 0 1\n")),
            ("rows.txt", format!("{rows}0 0 0 1\n{rows}0 0 0 1\n")),
            ("short.txt", rows.to_owned()),
            ("line.txt", format!("{}\n", rows.replace('\n', " "))),
            ("columns.txt", "0 1 0 0 -1 0 0 0 0 0 1 0 1 2 3 1\n".to_owned()),
            ("places.txt", format!("1 2 3 0 0 {half} {half}\n")),
            ("line16.txt", format!("{} 0 0 0 1", rows.replace('\n', ","))),
            (
                "a.json",
                format!(r#"{{"class_name":"PinholeCameraTrajectory","parameters":[{{"extrinsic":{open3d}}}]}}"#),
            ),
            (
                "graph.json",
                r#"{"nodes":[{"pose":[0,1,0,0, -1,0,0,0, 0,0,1,0, 1,2,3,1]}]}"#.to_owned(),
            ),
        ] {
            let found = written(name, &text).unwrap().pose(0, None).unwrap();
            assert!(found.abs_diff_eq(pose(), 1e-12), "{name}: {found}");
        }
        let tum = format!("# a comment\n5.0 9 9 9 0 0 0 1\n1305031102.16 1 2 3 0 0 {half} {half}\n");
        let tum = written("groundtruth.txt", &tum).unwrap();
        let at = |millis: u64| tum.pose(7, Some(Duration::from_millis(1_305_031_102_000 + millis)));
        assert!(at(171).unwrap().abs_diff_eq(pose(), 1e-12));
        assert_eq!((at(181), tum.pose(0, None)), (None, None));
    }

    #[test]
    fn poses_find_their_frames_by_time_order_or_number() {
        let places = |count: usize| {
            let lines: Vec<String> = (0..count).map(|at| format!("{at} 0 0 0 0 0 1\n")).collect();
            let text = lines.concat();
            written("places.txt", &text).unwrap()
        };
        let found = |trajectory: &Trajectory, times: &[Option<Duration>], numbers: &[usize]| {
            let numbers: Vec<Option<usize>> = numbers.iter().copied().map(Some).collect();
            let poses = trajectory.poses_of(times, &numbers).into_iter();
            poses
                .map(|pose| pose.map(|pose| pose.translation.x))
                .collect::<Vec<_>>()
        };
        let untimed = [None; 2];
        // As many: images that are counted from 1.
        assert_eq!(found(&places(2), &untimed, &[1, 2]), [Some(0.0), Some(1.0)]);
        // Every tenth image.
        assert_eq!(found(&places(20), &untimed, &[0, 10]), [Some(0.0), Some(10.0)]);
        // Numbers of something else.
        assert_eq!(found(&places(3), &untimed, &[100, 200]), [Some(0.0), Some(1.0)]);
        let stamped = written("tum.txt", "0 5 0 0 0 0 0 1\n1 6 0 0 0 0 0 1\n4 7 0 0 0 0 0 1\n").unwrap();
        assert_eq!(found(&stamped, &untimed, &[1, 3]), [Some(6.0), None]);
        let times = [Some(Duration::from_secs(4)), None];
        assert_eq!(found(&stamped, &times, &[0, 1]), [Some(7.0), None]);
    }

    #[test]
    fn a_camera_that_is_lost_has_no_pose() {
        for lost in [
            "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n0 0 0 1\n",
            "1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n",
            "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n",
            "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n",
            "nan nan nan nan\nnan nan nan nan\nnan nan nan nan\nnan nan nan nan\n",
            "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n",
        ] {
            assert_eq!(written("pose.txt", lost).unwrap().pose(0, None), None, "{lost}");
        }
    }

    #[test]
    fn what_is_no_trajectory_is_refused() {
        for (text, expected) in [
            ("", "no numbers"),
            ("1 2\n", "2 numbers"),
            ("1 0 0 0\n0 1 0\n", "3 numbers"),
            ("0 0 1\n1 0 0 0\n", "line 1"),
            ("1 0 0 x\n", "`x` is no number"),
            ("1 2 3 4 5 6 7 8\n1 2\n", "line 2"),
            ("1 0 0 0 3 4 5\n", "line 1: its rotation comes first"),
            ("-1 2 3 4 5 6 7 8\n", "the time"),
            ("{\"a\": 1}", "neither"),
            ("{", "EOF"),
        ] {
            let error = written("bad.txt", text).unwrap_err().to_string();
            assert!(error.contains("bad.txt") && error.contains(expected), "{text}: {error}");
        }
    }
}
