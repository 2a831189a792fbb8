//! Text with a point a line: `x y z`, and behind that a scalar, a colour or a normal.
//!
//! Nothing in such a file says what its columns are. A header line with names is believed; else the number of columns
//! and the values in them decide:
//!
//! | columns | meaning |
//! |---|---|
//! | 3 | x y z |
//! | 4 | x y z scalar |
//! | 6 | x y z, then red green blue or, if all are of unit length, a normal |
//! | 7 | x y z, then scalar red green blue (as `.pts`) or red green blue scalar |
//! | 9 and more | x y z red green blue nx ny nz |

use super::column::{Column, Scalar, Values};
use super::error::{Fault, Place};
use super::format::{Format, Traits};
use super::growing;
use super::rows::{self, Dialect, ParsedRows};
use crate::cloud::{Positions, RawCloud};
use crate::progress::Progress;

/// Text with coordinates in columns.
pub(super) const FORMAT: Format = Format::new(&Traits {
    name: "text",
    extensions: &["xyz", "txt", "csv", "asc", "pts"],
    ..Traits::PLAIN
});

/// Columns that are looked at.
const MAX_COLUMNS: usize = 64;

pub(super) fn decode(bytes: &[u8], progress: &Progress) -> Result<RawCloud, Fault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut head = Head::read(bytes)?;
    let Some(width) = head.width else {
        return match (head.claimed, head.names) {
            (Some(claimed), _) if claimed > 0 => Err(cut_short(claimed, 0)),
            // A header or a count of none alone is a cloud of no points.
            (Some(_), _) | (_, Some(_)) => Ok(RawCloud::from_positions(Positions::F64(Vec::new()))),
            (None, None) => Err(Fault::new(
                Place::Line(1),
                "there is no line with numbers: expected x y z in columns",
            )),
        };
    };
    progress.set(head.byte_count, bytes.len());
    let parsed = rows::parse(
        &bytes[head.byte_count..],
        head.line_count + 1,
        width,
        head.dialect,
        progress,
    )?;
    let count = parsed.len();
    if let Some(claimed) = claimed_points(head.claimed, &parsed, width)?.filter(|&claimed| claimed > count) {
        return Err(cut_short(claimed, count));
    }
    let names = match head.names.take().filter(|names| names.len() == width) {
        Some(names) => names,
        None => guessed_names(&parsed.columns),
    };
    let columns: Vec<Column<'_>> = names
        .into_iter()
        .zip(parsed.columns)
        .map(|(name, values)| Column {
            name,
            scalar: Scalar::F64,
            values: Values::Parsed(values),
        })
        .collect();
    growing::cloud(&columns, count)
}

fn cut_short(claimed: usize, count: usize) -> Fault {
    Fault::entry(
        "point",
        count,
        format!("the file ends here, but its first line counts {claimed} points: it is truncated"),
    )
}

/// Points of all scans by the lone number before each: `.pts` files count their points there.
fn claimed_points(first: Option<usize>, rows: &ParsedRows, width: usize) -> Result<Option<usize>, Fault> {
    let mut claimed = first;
    for lone in &rows.lones {
        // A further count comes when all points of those before it are there.
        match (claimed, count_of_points(lone.value)) {
            (Some(before), Some(count)) if lone.row > 0 && lone.row == before => {
                claimed = Some(before.saturating_add(count));
            }
            _ => {
                return Err(Fault::new(
                    Place::Line(lone.line),
                    format!("found 1 numbers, expected {width}"),
                ));
            }
        }
    }
    Ok(claimed)
}

fn count_of_points(value: f64) -> Option<usize> {
    /// More would not fit into any memory.
    const MOST_POINTS: f64 = 1e12;
    (value.fract() == 0.0 && (0.0..=MOST_POINTS).contains(&value)).then_some(value as usize)
}

/// What stands before the first point.
struct Head {
    dialect: Dialect,
    names: Option<Vec<String>>,
    /// Points by the lone number before the first one.
    claimed: Option<usize>,
    /// Numbers of the first point; `None` if there is none.
    width: Option<usize>,
    byte_count: usize,
    line_count: usize,
}

impl Head {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut head = Self {
            dialect: Dialect::of(bytes),
            names: None,
            claimed: None,
            width: None,
            byte_count: 0,
            line_count: 0,
        };
        let mut numbers = Vec::new();
        for line in bytes.split_inclusive(|&byte| byte == b'\n') {
            let content = line.trim_ascii();
            numbers.clear();
            if let Some(comment) = rows::comment(content) {
                // CloudCompare and others write the names of the columns as a comment.
                head.take_names(comment);
            } else if let Ok(found) = head.dialect.parse_line(content, &mut numbers) {
                let count = numbers.first().copied().and_then(count_of_points);
                match (found, count) {
                    (0, _) => {}
                    (1, Some(count)) if head.claimed.is_none_or(|claimed| claimed == 0) => {
                        head.claimed = Some(count);
                    }
                    (3..=MAX_COLUMNS, _) => {
                        head.width = Some(found);
                        return Ok(head);
                    }
                    _ => {
                        return Err(Fault::new(
                            Place::Line(head.line_count + 1),
                            format!("found {found} numbers, expected x y z and what follows them"),
                        ));
                    }
                }
            } else {
                // Before the first point, words are the names of columns.
                head.take_names(content);
            }
            head.byte_count += line.len();
            head.line_count += 1;
        }
        Ok(head)
    }

    fn take_names(&mut self, line: &[u8]) {
        // Where there are commas or semicolons, names may have spaces in them.
        let has_marks = line.iter().any(|byte| b",;".contains(byte));
        let separators: &[u8] = if has_marks { b",;" } else { b" \t" };
        let names: Vec<String> = line
            .split(|byte| separators.contains(byte))
            .map(<[u8]>::trim_ascii)
            .filter(|name| !name.is_empty())
            .take(MAX_COLUMNS)
            .map(|name| plain_name(&String::from_utf8_lossy(name)))
            .collect();
        if has_coordinates(&names) {
            self.names = Some(names);
            return;
        }
        let names: Vec<String> = names.into_iter().map(plain_coordinate).collect();
        if has_coordinates(&names) {
            self.names = Some(names);
        }
    }
}

/// A name as [`attributes::cloud`] knows it: without quotes and unit.
fn plain_name(name: &str) -> String {
    let name = name.trim_matches(['"', '\'', ' ']);
    let name = name.split(['(', '[']).next().unwrap_or("");
    name.trim().to_owned()
}

/// A coordinate by another name: that of `ParaView`, of surveyors.
fn plain_coordinate(name: String) -> String {
    const COORDINATES: [(&str, &str); 9] = [
        ("points:0", "x"),
        ("points:1", "y"),
        ("points:2", "z"),
        ("easting", "x"),
        ("northing", "y"),
        ("elevation", "z"),
        ("rechtswert", "x"),
        ("hochwert", "y"),
        ("height", "z"),
    ];
    let known = COORDINATES.iter().find(|(other, _)| name.eq_ignore_ascii_case(other));
    known.map_or(name, |(_, plain)| (*plain).to_owned())
}

fn has_coordinates(names: &[String]) -> bool {
    ["x", "y", "z"]
        .iter()
        .all(|axis| names.iter().any(|name| name.eq_ignore_ascii_case(axis)))
}

/// What the columns are by their number and the values behind the coordinates, of which the fourth to the seventh are
/// looked at.
pub(super) fn guessed_names(columns: &[Vec<f64>]) -> Vec<String> {
    const COLOR: [&str; 3] = ["red", "green", "blue"];
    const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
    let bytes_at = |first: usize| {
        columns[first..first + 3].iter().all(|column| {
            column
                .iter()
                .all(|value| value.fract() == 0.0 && (0.0..=255.0).contains(value))
        })
    };
    let mut names = vec!["x", "y", "z"];
    match columns.len() {
        4 => names.push("scalar"),
        6 if is_unit_length(&columns[3..6]) && !bytes_at(3) => names.extend(NORMAL),
        6 => names.extend(COLOR),
        7 if bytes_at(4) || !bytes_at(3) => {
            names.push("scalar");
            names.extend(COLOR);
        }
        7 => {
            names.extend(COLOR);
            names.push("scalar");
        }
        9.. if bytes_at(3) || !is_unit_length(&columns[3..6]) => {
            names.extend(COLOR);
            names.extend(NORMAL);
        }
        9.. => {
            names.extend(NORMAL);
            names.extend(COLOR);
        }
        _ => {}
    }
    let mut names: Vec<String> = names.into_iter().map(str::to_owned).collect();
    let unknown = names.len()..columns.len();
    names.extend(unknown.map(|index| format!("column_{}", index + 1)));
    names
}

fn is_unit_length(columns: &[Vec<f64>]) -> bool {
    /// Normals are often written with three digits.
    const TOLERANCE: f64 = 0.02;
    (0..columns[0].len()).all(|row| {
        let length = columns
            .iter()
            .map(|column| column[row] * column[row])
            .sum::<f64>()
            .sqrt();
        (length - 1.0).abs() < TOLERANCE
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of the columns of `text`, a line of which is a point.
    fn names(text: &str) -> Vec<String> {
        let rows: Vec<Vec<f64>> = text
            .lines()
            .map(|line| line.split(' ').map(|token| token.parse().unwrap()).collect())
            .collect();
        let columns: Vec<Vec<f64>> = (0..rows[0].len())
            .map(|column| rows.iter().map(|row| row[column]).collect())
            .collect();
        guessed_names(&columns)
    }

    #[test]
    fn columns_without_names_are_told_by_their_values() {
        for (text, expected) in [
            ("1 2 3", "x y z"),
            ("1 2 3 4", "x y z scalar"),
            ("1 2 3 4 5", "x y z column_4 column_5"),
            ("1 2 3 255 0 1", "x y z red green blue"),
            ("1 2 3 0.5 0.25 0.5", "x y z red green blue"),
            ("1 2 3 0.6 0 -0.8", "x y z nx ny nz"),
            // One point that is red, and one normal along x: eight bits are the better guess.
            ("1 2 3 1 0 0", "x y z red green blue"),
            ("1 2 3 -900 255 0 1", "x y z scalar red green blue"),
            ("1 2 3 255 0 1 0.5", "x y z red green blue scalar"),
            ("1 2 3 255 0 1 0 0 1", "x y z red green blue nx ny nz"),
            ("1 2 3 0 0.6 0.8 255 0 1", "x y z nx ny nz red green blue"),
        ] {
            assert_eq!(names(text).join(" "), expected, "{text}");
        }
    }

    #[test]
    fn a_leading_count_is_held_against_the_points() {
        for (text, points) in [
            ("0\n", 0),
            ("2\n1 2 3\n4 5 6\n", 2),
            ("1\n1 2 3\n4 5 6\n", 2),
            ("1\n1 2 3\n2\n4 5 6\n7 8 9\n", 3),
        ] {
            let cloud =
                decode(text.as_bytes(), &Progress::default()).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"));
            assert_eq!(cloud.positions.len(), points, "{text:?}");
        }
        for text in [
            "2\n1 2 3\n",
            "1\n",
            "1\n1 2 3\n5\n4 5 6\n",
            "1.5\n1 2 3\n",
            "2\n1 2 3\n1\n",
        ] {
            assert!(decode(text.as_bytes(), &Progress::default()).is_err(), "{text:?}");
        }
    }
}
