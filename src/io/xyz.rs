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

use super::attributes;
use super::column::{Column, Scalar, Values};
use super::error::{Fault, Place};
use super::numbers::{parse_number, quoted};
use crate::cloud::{Positions, RawCloud};

/// Columns that are looked at.
const MAX_COLUMNS: usize = 64;

pub(super) fn decode(bytes: &[u8]) -> Result<RawCloud, Fault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut rows = Rows::default();
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        rows.read_line(line.trim_ascii(), index + 1)?;
    }
    let Some(column_count) = rows.column_count else {
        return match (rows.claimed, rows.names) {
            (Some(claimed), _) if claimed > 0 => Err(cut_short(claimed, 0)),
            // A header or a count of none alone is a cloud of no points.
            (Some(_), _) | (_, Some(_)) => Ok(RawCloud::from_positions(Positions::F64(Vec::new()))),
            (None, None) => Err(Fault::new(
                Place::Line(1),
                "there is no line with numbers: expected x y z in columns",
            )),
        };
    };
    let count = rows.values.len() / column_count;
    if let Some(claimed) = rows.claimed.filter(|&claimed| claimed > count) {
        return Err(cut_short(claimed, count));
    }
    let column = |index: usize| {
        (0..count)
            .map(|row| rows.values[row * column_count + index])
            .collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..column_count).map(column).collect();
    let names = match rows
        .names
        .filter(|names| names.len() == column_count && has_coordinates(names))
    {
        Some(names) => names,
        None => guessed_names(&columns),
    };
    let columns: Vec<Column<'_>> = names
        .into_iter()
        .zip(columns)
        .map(|(name, values)| Column {
            name,
            scalar: Scalar::F64,
            values: Values::Parsed(values),
        })
        .collect();
    attributes::cloud(&columns, count)
}

fn cut_short(claimed: usize, count: usize) -> Fault {
    Fault::entry(
        "point",
        count,
        format!("the file ends here, but its first line counts {claimed} points: it is truncated"),
    )
}

#[derive(Default)]
struct Rows {
    names: Option<Vec<String>>,
    column_count: Option<usize>,
    /// Row after row.
    values: Vec<f64>,
    /// Points of the scans so far by the lone number before each: `.pts` files count their points there.
    claimed: Option<usize>,
}

impl Rows {
    fn read_line(&mut self, line: &[u8], number: usize) -> Result<(), Fault> {
        let (line, is_comment) = match line.strip_prefix(b"//").or_else(|| line.strip_prefix(b"#"))
        {
            Some(comment) => (comment, true),
            None => (line, false),
        };
        if line.is_empty() {
            return Ok(());
        }
        let tokens = || {
            line.split(|byte| b" \t,;".contains(byte))
                .filter(|token| !token.is_empty())
        };
        if is_comment {
            // CloudCompare and others write the names of the columns as a comment.
            self.take_names(tokens());
            return Ok(());
        }
        let before = self.values.len();
        for token in tokens() {
            match parse_number(token) {
                Some(value) => self.values.push(value),
                // Before the first point, words are the names of columns.
                None if self.column_count.is_none() => {
                    self.values.truncate(before);
                    self.take_names(tokens());
                    return Ok(());
                }
                None => {
                    return Err(Fault::new(
                        Place::Line(number),
                        format!("found {}, expected a number", quoted(token)),
                    ));
                }
            }
        }
        let found = self.values.len() - before;
        match self.column_count {
            _ if found == 1 && self.is_scan_start(self.values[before]) => {
                self.claimed = Some(self.claimed.unwrap_or(0) + self.values[before] as usize);
                self.values.truncate(before);
                Ok(())
            }
            None if (3..=MAX_COLUMNS).contains(&found) => {
                self.column_count = Some(found);
                Ok(())
            }
            Some(expected) if expected == found => Ok(()),
            expected => Err(Fault::new(
                Place::Line(number),
                format!(
                    "found {found} numbers, expected {}",
                    expected.map_or_else(
                        || "x y z and what follows them".to_owned(),
                        |n| n.to_string()
                    )
                ),
            )),
        }
    }

    /// True for the count of points before the first one, and behind the last one of a scan.
    fn is_scan_start(&self, count: f64) -> bool {
        /// More would not fit into any memory.
        const MOST_POINTS: f64 = 1e12;
        let points = self
            .column_count
            .map_or(0, |columns| self.values.len() / columns);
        let is_due = match self.claimed {
            None => points == 0,
            Some(claimed) => points > 0 && points == claimed,
        };
        is_due && count.fract() == 0.0 && (0.0..=MOST_POINTS).contains(&count)
    }

    fn take_names<'a>(&mut self, tokens: impl Iterator<Item = &'a [u8]>) {
        let names: Vec<String> = tokens
            .take(MAX_COLUMNS)
            .map(|token| String::from_utf8_lossy(token).trim_matches('"').to_owned())
            .collect();
        if has_coordinates(&names) {
            self.names = Some(names);
        }
    }
}

fn has_coordinates(names: &[String]) -> bool {
    ["x", "y", "z"]
        .iter()
        .all(|axis| names.iter().any(|name| name.eq_ignore_ascii_case(axis)))
}

/// What the columns are by their number and the values behind the coordinates, of which the fourth to the seventh are looked at.
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
    names.resize(columns.len(), "unknown".to_owned());
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
            .map(|line| {
                line.split(' ')
                    .map(|token| token.parse().unwrap())
                    .collect()
            })
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
            ("1 2 3 4 5", "x y z unknown unknown"),
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
                decode(text.as_bytes()).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"));
            assert_eq!(cloud.positions.len(), points, "{text:?}");
        }
        for text in [
            "2\n1 2 3\n",
            "1\n",
            "1\n1 2 3\n5\n4 5 6\n",
            "1.5\n1 2 3\n",
            "2\n1 2 3\n1\n",
        ] {
            assert!(decode(text.as_bytes()).is_err(), "{text:?}");
        }
    }
}
