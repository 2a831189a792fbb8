//! Files of poses as programs write them: TUM, Redwood, Open3D, matrices, arrays of numpy, tables with a header.

use super::error::RgbdError;
use super::folder::{has_extension, name_of};
use super::pose_json::of_json;
use super::pose_table;
use super::text::{self, array, number_lines, read};
use super::trajectory::{Trajectory, matrix, pose_of, rigid};
use crate::io::files::timestamps::time_of_number;
use glam::{DAffine3, DQuat, DVec3};
use std::collections::HashMap;
use std::path::Path;

impl Trajectory {
    /// The poses in the file at `path`, of any of the formats of [`RgbdError::Trajectory`].
    pub(in crate::source) fn read(path: &Path) -> Result<Self, RgbdError> {
        Ok(Self::read_and_tell(path)?.0)
    }

    /// Reads the trajectory as [`Trajectory::read`] does, and also returns true if a quaternion order was assumed that
    /// no header states: `qx qy qz qw`.
    pub(super) fn read_and_tell(path: &Path) -> Result<(Self, bool), RgbdError> {
        let wrong = |reason: String| RgbdError::Trajectory {
            path: path.to_owned(),
            reason,
        };
        if has_extension(name_of(path), &["npy"]) {
            let (shape, numbers) = array(path)?;
            let is_of_places = shape.len() == 2 && shape[1] == 7;
            return Ok((of_array(path, &shape, &numbers)?, is_of_places));
        }
        if has_extension(name_of(path), &["npz"]) {
            return Ok((of_arrays(path)?, false));
        }
        let text = read(path)?;
        let begin = text.trim_start().chars().next();
        // Rows of numbers may be in brackets as well.
        let is_list = || begin == Some('[') && (has_extension(name_of(path), &["json"]) || is_json(&text));
        if begin == Some('{') || is_list() {
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
}

/// Returns true if a text of any extension is JSON rather than rows in brackets.
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
    let (shape, numbers) = found;
    let poses = of_array(path, shape, numbers)?;
    let name = name.to_lowercase();
    let is_inverse = ["w2c", "world2cam", "extrinsic"].iter().any(|key| name.contains(key));
    Ok(if is_inverse { poses.inverse() } else { poses })
}

/// An array of numpy: a pose per entry of its first dimension, as a matrix or as `x y z qx qy qz qw`.
fn of_array(path: &Path, shape: &[usize], numbers: &[f64]) -> Result<Trajectory, RgbdError> {
    // A single matrix is one pose.
    let is_one = matches!(*shape, [3 | 4, 4]);
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
        let time = time.ok_or_else(|| wrong(*line, "the time is not a number of seconds from 0 up"))?;
        poses.push((time, pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw))));
    }
    poses.sort_by_key(|(time, _)| *time);
    Ok(Trajectory::Stamped(poses))
}

/// Blocks of a line of three whole numbers, the first of which is the frame's, and four lines of a matrix.
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

/// Parses matrices of 4 × 4 or 3 × 4 numbers, one row per line.
fn of_rows(lines: &[(usize, Vec<f64>)]) -> Result<Trajectory, String> {
    let rows: Vec<&[f64]> = lines.iter().map(|(_, row)| row.as_slice()).collect();
    if let Some(row) = rows.iter().find(|row| row.len() != 4) {
        return Err(format!("a row has {} numbers, and 4 were expected", row.len()));
    }
    // When tracking is lost, some programs write NaN into the last row too.
    let is_last = |row: &&[f64]| row[..3] == [0.0; 3] || row.iter().all(|number| !number.is_finite());
    let is_by_columns = |rows: &[&[f64]]| rows.iter().map(|row| row[3]).eq([0.0, 0.0, 0.0, 1.0]);
    let are_whole = rows.len().is_multiple_of(4)
        && (rows.iter().skip(3).step_by(4).all(is_last) || rows.chunks(4).all(is_by_columns));
    let height = if are_whole { 4 } else { 3 };
    if !rows.len().is_multiple_of(height) {
        return Err(format!("{} rows are not matrices of 4 or 3 rows", rows.len()));
    }
    let matrices = rows.chunks(height).map(|rows| matrix(&rows.concat()));
    Ok(Trajectory::listed(matrices.map(rigid)))
}

#[cfg(test)]
#[path = "pose_file_tests.rs"]
mod tests;
