//! Poses of a camera, from the files that programs write: from the frame of the camera to that of the world.

use super::error::RgbdError;
use super::pairs::nearest;
use super::text::{number_lines, read};
use crate::io::timestamps::times_of_lines;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
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
        let text = read(path)?;
        let wrong = |reason: String| RgbdError::Trajectory {
            path: path.to_owned(),
            reason,
        };
        if text.trim_start().starts_with('{') {
            return of_json(&text).map_err(wrong);
        }
        let lines = number_lines(path, &text)?;
        let Some((_, first)) = lines.first() else {
            return Err(wrong("it has no numbers".to_owned()));
        };
        match first.len() {
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

    fn listed(poses: impl Iterator<Item = Option<DAffine3>>) -> Self {
        Self::Numbered(poses.enumerate().collect())
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
    Some(DMat4::from_cols_array(&numbers).transpose())
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
        let rotation = DQuat::from_xyzw(qx, qy, qz, qw);
        let place = DVec3::new(x, y, z);
        let is_pose = place.is_finite() && rotation.is_finite() && rotation.length() > 1e-6;
        poses.push((
            time,
            is_pose.then(|| DAffine3::from_rotation_translation(rotation.normalize(), place)),
        ));
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
            ("-1 2 3 4 5 6 7 8\n", "the time"),
            ("{\"a\": 1}", "neither"),
            ("{", "EOF"),
        ] {
            let error = written("bad.txt", text).unwrap_err().to_string();
            assert!(error.contains("bad.txt") && error.contains(expected), "{text}: {error}");
        }
    }
}
