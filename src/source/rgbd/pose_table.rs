//! Tables of poses: lines of numbers, with a header that names the columns, with the name or the number of a frame in
//! front, or as graphs of SLAM programs have them (g2o).
//!
//! *Order of quaternions.* Most programs write `qx qy qz qw`, `EuRoC` and many scripts `qw qx qy qz`: nothing in the
//! numbers distinguishes them. A header that names the columns is believed; one that names positions and anything other
//! than a quaternion is refused.

use super::error::RgbdError;
use super::text::number_lines;
use super::trajectory::{Trajectory, key_of, matrix, pose_of, rigid};
use crate::io::files::timestamps::time_of_number;
use glam::{DAffine3, DQuat, DVec3};
use std::path::Path;
use std::time::Duration;

/// Lines at the beginning that may name the columns.
const HEADER_LINES: usize = 8;

/// Role of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Time,
    /// Whole seconds, next to nanoseconds.
    Seconds,
    Nanos,
    Number,
    /// x, y, z.
    Place(usize),
    /// x, y, z, w.
    Turn(usize),
    /// Roll, pitch, yaw.
    Angle,
    Other,
}

/// Column indices of poses.
#[derive(Debug)]
struct Columns {
    roles: Vec<Role>,
    /// Times are nanoseconds.
    has_nanos: bool,
    by_commas: bool,
    /// The line of the header, from 0.
    line: usize,
}

/// The poses in `text` by the columns that its header names, by names in front of its rows, or of a graph of g2o;
/// `None` of plain lines of numbers.
pub(super) fn of_text(path: &Path, text: &str) -> Result<Option<Trajectory>, RgbdError> {
    let wrong = |reason: String| RgbdError::Trajectory {
        path: path.to_owned(),
        reason,
    };
    if let Some(columns) = header(text).map_err(wrong)? {
        return of_columns(path, text, &columns).map(Some);
    }
    if text.lines().any(|line| line.starts_with("VERTEX_SE3:QUAT")) {
        return Ok(Some(of_graph(text)));
    }
    if let Some(named) = of_names(text) {
        return Ok(Some(named));
    }
    of_numbered(path, text)
}

/// Rows of a matrix behind a time or the number of a frame.
fn of_numbered(path: &Path, text: &str) -> Result<Option<Trajectory>, RgbdError> {
    let lines = number_lines(path, text)?;
    let is_numbered = lines.iter().all(|(_, row)| matches!(row.len(), 13 | 17));
    if lines.is_empty() || !is_numbered {
        return Ok(None);
    }
    let pose = |row: &[f64]| rigid(matrix(&row[1..]));
    let is_count = |number: f64| number >= 0.0 && number.fract() == 0.0 && number < 1e9;
    if lines.iter().all(|(_, row)| is_count(row[0])) {
        let poses = lines.iter().map(|(_, row)| (row[0] as usize, pose(row)));
        return Ok(Some(Trajectory::Numbered(poses.collect())));
    }
    let texts: Vec<&str> = text.lines().collect();
    let mut poses = Vec::with_capacity(lines.len());
    for (line, row) in &lines {
        let time = words(texts[line - 1]).first().and_then(|word| time_of_number(word));
        let time = time.ok_or_else(|| RgbdError::Line {
            path: path.to_owned(),
            line: *line,
            reason: "the time is not a number of seconds from 0 up".to_owned(),
        })?;
        poses.push((time, pose(row)));
    }
    poses.sort_by_key(|(time, _)| *time);
    Ok(Some(Trajectory::Stamped(poses)))
}

fn words(line: &str) -> Vec<&str> {
    let is_between = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '[' | ']' | '(' | ')');
    line.split(is_between).filter(|word| !word.is_empty()).collect()
}

/// The columns that one of the first lines names.
///
/// # Errors
/// A header of places and something else than a quaternion.
fn header(text: &str) -> Result<Option<Columns>, String> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let mut found = None;
    for (line, content) in lines.take(HEADER_LINES) {
        let content = content.trim().trim_start_matches(['#', '%']).trim();
        let by_commas = content.contains(',');
        let names: Vec<&str> = if by_commas {
            content.split(',').collect()
        } else {
            content
                .split_whitespace()
                .filter(|word| !word.starts_with('['))
                .collect()
        };
        let roles: Vec<Role> = names.iter().map(|name| role(name)).collect();
        let count = |role: Role| roles.iter().filter(|&&other| other == role).count();
        let has_place = (0..3).all(|axis| count(Role::Place(axis)) == 1);
        let has_turn = (0..4).all(|axis| count(Role::Turn(axis)) == 1);
        if has_place && has_turn {
            found = Some(Columns {
                has_nanos: names.iter().any(|name| name.contains("[ns]") || name.ends_with("_ns")),
                roles,
                by_commas,
                line,
            });
        } else if has_place && (count(Role::Angle) > 0 || roles.iter().any(|role| matches!(role, Role::Turn(_)))) {
            return Err(format!(
                "its header `{}` names no quaternion whose order is known: expected columns qx qy qz qw, in any order",
                content.chars().take(120).collect::<String>().escape_default()
            ));
        }
    }
    Ok(found)
}

/// Returns the role indicated by a column name.
fn role(name: &str) -> Role {
    let name = name.split('[').next().unwrap_or_default();
    let name = name.trim().trim_matches('"').to_ascii_lowercase();
    let parts: Vec<&str> = name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|part| !part.is_empty())
        .collect();
    let Some((&last, before)) = parts.split_last() else {
        return Role::Other;
    };
    let before = before.join("_");
    if ["roll", "pitch", "yaw"].contains(&last) {
        return Role::Angle;
    }
    if ["sec", "secs"].contains(&last) {
        return Role::Seconds;
    }
    if ["nsec", "nsecs", "nanosec"].contains(&last) {
        return Role::Nanos;
    }
    if parts
        .iter()
        .any(|part| part.starts_with("time") || part.starts_with("stamp"))
        || (name == "t")
    {
        return Role::Time;
    }
    if ["num", "number", "index", "idx", "id", "frame", "frameid", "seq"].contains(&last) && before.is_empty() {
        return Role::Number;
    }
    // A single word such as `qx`, `tx`, `px`, or a last part such as `x` after the quantity.
    let mut letters = last.chars();
    let (kind, axis) = match (letters.next(), letters.next(), letters.next()) {
        (Some(axis), None, None) => (before.as_str(), axis),
        (Some(kind @ ('q' | 't' | 'p')), Some(axis), None) if before.is_empty() => {
            (if kind == 'q' { "q" } else { "p" }, axis)
        }
        _ => return Role::Other,
    };
    let is_turn = kind.starts_with('q') || kind.contains("rot") || kind.contains("orient");
    let is_place = ["", "p", "t", "pos", "tr"].contains(&kind)
        || kind.starts_with("p_")
        || kind.contains("position")
        || kind.contains("trans");
    let is_pose = !kind.contains("twist") && !kind.contains("covariance");
    match axis {
        'x' | 'y' | 'z' if is_turn && is_pose => Role::Turn(axis as usize - 'x' as usize),
        'w' if (is_turn || kind.is_empty()) && is_pose => Role::Turn(3),
        'x' | 'y' | 'z' if is_place && is_pose => Role::Place(axis as usize - 'x' as usize),
        _ if is_turn => Role::Turn(4),
        _ => Role::Other,
    }
}

/// Rows below a header.
fn of_columns(path: &Path, text: &str, columns: &Columns) -> Result<Trajectory, RgbdError> {
    let at = |role: Role| columns.roles.iter().position(|&other| other == role);
    let (time, seconds, nanos) = (at(Role::Time), at(Role::Seconds), at(Role::Nanos));
    let number = at(Role::Number);
    let mut stamped = Vec::new();
    let mut counted = Vec::new();
    for (index, line) in text.lines().enumerate().skip(columns.line + 1) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = if columns.by_commas && line.contains(',') {
            line.split(',').map(str::trim).collect()
        } else {
            words(line)
        };
        let wrong = |reason: &str| RgbdError::Line {
            path: path.to_owned(),
            line: index + 1,
            reason: reason.to_owned(),
        };
        let value = |role: Role| -> Option<f64> { words.get(at(role)?)?.parse().ok() };
        let place = [0, 1, 2].map(|axis| value(Role::Place(axis)));
        let turn = [0, 1, 2, 3].map(|axis| value(Role::Turn(axis)));
        let ([Some(x), Some(y), Some(z)], [Some(qx), Some(qy), Some(qz), Some(qw)]) = (place, turn) else {
            return Err(wrong("expected numbers in the columns that its header names"));
        };
        let pose = pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw));
        let stamp = match (time, seconds, nanos) {
            (_, Some(seconds), Some(nanos)) => whole(&words, seconds)
                .zip(whole(&words, nanos))
                .map(|(seconds, nanos)| Duration::from_secs(seconds) + Duration::from_nanos(nanos)),
            (Some(time), ..) => words.get(time).and_then(|word| time_of(word, columns.has_nanos)),
            (None, Some(seconds), None) => words.get(seconds).and_then(|word| time_of(word, false)),
            _ => None,
        };
        if let Some(number) = number.and_then(|number| whole(&words, number)) {
            counted.push((number as usize, pose));
        }
        let has_time = time.is_some() || seconds.is_some();
        if has_time && stamp.is_none() {
            return Err(wrong("the time is not a number of seconds from 0 up"));
        }
        stamped.push((stamp.unwrap_or_default(), pose));
    }
    if counted.len() == stamped.len() && !counted.is_empty() {
        return Ok(Trajectory::Numbered(counted.into_iter().collect()));
    }
    if time.is_none() && seconds.is_none() {
        let poses = stamped.into_iter().map(|(_, pose)| pose).enumerate();
        return Ok(Trajectory::Numbered(poses.collect()));
    }
    stamped.sort_by_key(|(time, _)| *time);
    Ok(Trajectory::Stamped(stamped))
}

fn whole(words: &[&str], at: usize) -> Option<u64> {
    words.get(at)?.parse().ok()
}

/// A time; short numbers are seconds, although their header says nanoseconds.
fn time_of(word: &str, has_nanos: bool) -> Option<Duration> {
    match word.parse::<u64>() {
        Ok(nanos) if has_nanos => Some(Duration::from_nanos(nanos)),
        _ => time_of_number(word),
    }
}

/// Vertices of a graph: a number, a place and a quaternion `x y z w`.
fn of_graph(text: &str) -> Trajectory {
    let vertex = |line: &str| -> Option<(usize, Option<DAffine3>)> {
        let mut words = line.strip_prefix("VERTEX_SE3:QUAT")?.split_whitespace();
        let number = words.next()?.parse().ok()?;
        let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
        let [x, y, z, qx, qy, qz, qw] = <[f64; 7]>::try_from(numbers?).ok()?;
        Some((number, pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw))))
    };
    let mut poses: Vec<(usize, Option<DAffine3>)> = text.lines().filter_map(vertex).collect();
    // GTSAM keys hold a letter in their highest byte.
    let max = usize::MAX >> 8;
    for (number, _) in &mut poses {
        *number &= max;
    }
    Trajectory::Numbered(poses.into_iter().collect())
}

/// Rows with the name of a file in front of a pose.
fn of_names(text: &str) -> Option<Trajectory> {
    let mut poses = Vec::new();
    for line in text.lines() {
        let words = words(line.split('#').next().unwrap_or_default());
        let Some((name, rest)) = words.split_first() else {
            continue;
        };
        let numbers: Option<Vec<f64>> = rest.iter().map(|word| word.parse().ok()).collect();
        let numbers = numbers?;
        let is_name = name.parse::<f64>().is_err() && name.contains(|c: char| c.is_alphanumeric());
        let pose = match *numbers.as_slice() {
            _ if !is_name => return None,
            [x, y, z, qx, qy, qz, qw] => pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw)),
            _ if matches!(numbers.len(), 12 | 16) => rigid(matrix(&numbers)),
            _ => return None,
        };
        poses.push((key_of(name), pose));
    }
    (!poses.is_empty()).then(|| Trajectory::Named(poses.into_iter().collect()))
}

#[cfg(test)]
#[path = "pose_table_tests.rs"]
mod tests;
