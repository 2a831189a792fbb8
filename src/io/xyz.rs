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
use crate::cloud::RawCloud;

/// Columns that are looked at.
const MAX_COLUMNS: usize = 64;

pub(super) fn decode(bytes: &[u8]) -> Result<RawCloud, Fault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut rows = Rows::default();
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        rows.read_line(line.trim_ascii(), index + 1)?;
    }
    let Some(column_count) = rows.column_count else {
        return match rows.names {
            // A header alone is a cloud of no points.
            Some(_) => Ok(RawCloud::from_positions(crate::cloud::Positions::F64(
                Vec::new(),
            ))),
            None => Err(Fault::new(
                Place::Line(1),
                "there is no line with numbers: expected x y z in columns",
            )),
        };
    };
    let count = rows.values.len() / column_count;
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
        .map(|(name, values)| {
            // Whole numbers above 1 are 8-bit channels, fractions are channels from 0 to 1.
            let scalar = if is_color(&name) && looks_like_bytes(&values) {
                Scalar::U8
            } else {
                Scalar::F64
            };
            Column {
                name,
                scalar,
                values: Values::Parsed(values),
            }
        })
        .collect();
    attributes::cloud(&columns, count)
}

#[derive(Default)]
struct Rows {
    names: Option<Vec<String>>,
    column_count: Option<usize>,
    /// Row after row.
    values: Vec<f64>,
    /// The only number of the first line: `.pts` files count their points there.
    leading_count: bool,
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
            None if found == 1 && !self.leading_count => {
                self.leading_count = true;
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

    fn take_names<'a>(&mut self, tokens: impl Iterator<Item = &'a [u8]>) {
        let names: Vec<String> = tokens
            .take(MAX_COLUMNS)
            .map(|token| {
                String::from_utf8_lossy(token)
                    .trim_matches('"')
                    .to_ascii_lowercase()
            })
            .collect();
        if has_coordinates(&names) {
            self.names = Some(names);
        }
    }
}

fn has_coordinates(names: &[String]) -> bool {
    ["x", "y", "z"]
        .iter()
        .all(|axis| names.iter().any(|name| name == axis))
}

fn is_color(name: &str) -> bool {
    ["red", "green", "blue", "r", "g", "b"].contains(&name)
}

fn looks_like_bytes(values: &[f64]) -> bool {
    values
        .iter()
        .all(|value| value.fract() == 0.0 && (0.0..=255.0).contains(value))
        && values.iter().any(|&value| value > 1.0)
}

fn guessed_names(columns: &[Vec<f64>]) -> Vec<String> {
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
