//! OFF of Geomview: a keyword with the attributes of vertices, three counts, vertices, then faces.
//!
//! `ST`, `C` and `N` before `OFF` announce texture coordinates, colours and normals; but many writers omit the `C`, so
//! the numbers after the coordinates in a line count more than the keyword. Files of `ModelNet40` have the counts right
//! after the keyword (`OFF8 12 0`). Text only: the binary variant is refused.

use crate::cloud::RawCloud;
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::growing;
use crate::io::columns::numbers::{parse_number, quoted};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Magic, Traits};
use crate::io::meshes::broken_faces::{BrokenFaces, no_vertex};
use crate::io::options::ReadOptions;

/// Geomview OFF.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "OFF",
    extensions: &["off"],
    magic: &[Magic::start(b"OFF\n")],
    is_for_meshes: true,
    ..Traits::PLAIN
});

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    /// Three digits, two spaces and the end of a line.
    const MIN_LINE_BYTES: usize = 6;
    let mut lines = Lines::new(bytes);
    let (keyword, counts) = header(&mut lines)?;
    let [vertices, faces] = counts;
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for index in 0..vertices {
        let numbers = lines.numbers("vertex", index, options)?;
        if index == 0 {
            let count = vertices.min(bytes.len() / MIN_LINE_BYTES);
            options.claim_entries("the vertices", count, numbers.len() * size_of::<f64>())?;
            columns = (0..numbers.len()).map(|_| Vec::with_capacity(count)).collect();
        }
        if numbers.len() != columns.len() || numbers.len() < 3 {
            return Err(Fault::new(
                Place::Line(lines.number),
                format!(
                    "vertex {index} has {} numbers, expected {}",
                    numbers.len(),
                    columns.len().max(3)
                ),
            ));
        }
        for (column, number) in columns.iter_mut().zip(numbers) {
            column.push(number);
        }
    }
    let names = names(&keyword, columns.len());
    let columns: Vec<Column<'_>> = names
        .iter()
        .zip(columns)
        .map(|(name, values)| Column {
            name: (*name).to_owned(),
            scalar: Scalar::F64,
            values: Values::Parsed(values),
        })
        .collect();
    let mut cloud = if vertices == 0 {
        RawCloud::from_positions(crate::cloud::Positions::F64(Vec::new()))
    } else {
        growing::cloud(&columns, vertices, options)?
    };
    drop(columns);
    let options = options.holding(cloud.byte_size());
    let mut triangles = Vec::new();
    let mut broken = BrokenFaces::default();
    for index in 0..faces {
        match lines.numbers("face", index, &options) {
            Ok(numbers) => broken.count({
                options.reserve(&mut triangles, numbers.len(), "the faces")?;
                face(&numbers, index, vertices, &mut triangles).err()
            }),
            Err(fault) => {
                broken.end(fault);
                break;
            }
        }
    }
    broken.put_into(triangles, &mut cloud);
    Ok(cloud)
}

/// The keyword, empty where there is none, and the numbers of vertices and faces.
fn header(lines: &mut Lines<'_>) -> Result<(String, [usize; 2]), Fault> {
    let fault = |line: usize, problem: String| Fault::new(Place::Line(line), problem);
    let Some(mut line) = lines.next() else {
        return Err(fault(1, "the file has no line but comments, expected `OFF`".to_owned()));
    };
    let word = line.split(u8::is_ascii_whitespace).next().unwrap_or(line);
    let word = without_count(word);
    let mut keyword = String::new();
    if word.to_ascii_uppercase().ends_with(b"OFF") {
        keyword = String::from_utf8_lossy(word).to_ascii_uppercase();
        line = line[word.len()..].trim_ascii();
        if line.to_ascii_lowercase().starts_with(b"binary") {
            return Err(fault(
                lines.number,
                "binary OFF files are not read: save it as text, or as PLY".to_owned(),
            ));
        }
        if keyword.trim_end_matches("OFF").contains(['4', 'n']) || keyword.starts_with('4') {
            return Err(fault(
                lines.number,
                format!("`{keyword}` has points of four coordinates, expected three"),
            ));
        }
        if line.is_empty() {
            line = lines.next().unwrap_or_default();
        }
    }
    let counts: Vec<Option<f64>> = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .map(parse_number)
        .collect();
    let count = |index: usize| {
        let value = counts.get(index).copied().flatten()?;
        (value >= 0.0 && value.fract() == 0.0 && value < u32::MAX as f64).then_some(value as usize)
    };
    let (Some(vertices), Some(faces)) = (count(0), count(1)) else {
        return Err(fault(
            lines.number,
            format!(
                "found {}, expected the numbers of vertices, faces and edges",
                quoted(line)
            ),
        ));
    };
    Ok((keyword, [vertices, faces]))
}

/// A keyword without the count that some writers leave no space before.
fn without_count(word: &[u8]) -> &[u8] {
    let letters = word
        .iter()
        .rposition(|byte| !byte.is_ascii_digit())
        .map_or(0, |last| last + 1);
    let keyword = &word[..letters];
    if keyword.to_ascii_uppercase().ends_with(b"OFF") {
        keyword
    } else {
        word
    }
}

/// Returns the names of the `count` numbers of a vertex.
fn names(keyword: &str, count: usize) -> Vec<&'static str> {
    const COLOR: [&str; 4] = ["red", "green", "blue", "alpha"];
    let prefix = keyword.trim_end_matches("OFF");
    let mut names = vec!["x", "y", "z"];
    if prefix.contains('N') {
        names.extend(["nx", "ny", "nz"]);
    }
    let texture = if prefix.contains("ST") { 2 } else { 0 };
    let left = count.saturating_sub(names.len() + texture);
    if prefix.contains('C') || !prefix.contains('N') {
        names.extend(match left {
            3 => &COLOR[..3],
            4 => &COLOR[..],
            _ => &[],
        });
    }
    names.resize(count, "unknown");
    names
}

fn face(numbers: &[f64], index: usize, vertices: usize, faces: &mut Vec<[u32; 3]>) -> Result<(), Fault> {
    let corners = numbers.first().copied().unwrap_or(0.0);
    // After its corners a face may have a colour.
    let Some(corners) = numbers
        .get(1..)
        .filter(|rest| corners >= 0.0 && corners.fract() == 0.0 && corners <= rest.len() as f64)
        .map(|rest| &rest[..corners as usize])
    else {
        return Err(Fault::entry(
            "face",
            index,
            format!(
                "it claims {corners} corners, but {} numbers follow",
                numbers.len().saturating_sub(1)
            ),
        ));
    };
    let mut polygon = Vec::with_capacity(corners.len());
    for &corner in corners {
        if !(corner >= 0.0 && corner < vertices as f64 && corner.fract() == 0.0) {
            return Err(no_vertex("face", index, corner, vertices));
        }
        polygon.push(corner as u32);
    }
    crate::io::meshes::mesh::fan(&polygon, faces);
    Ok(())
}

/// The lines with something in them, without comments.
struct Lines<'a> {
    rest: Option<&'a [u8]>,
    /// Line number of the last line, counted from 1.
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: Some(bytes),
            number: 0,
        }
    }

    /// The numbers of the next line, which is entry `index` of `list`.
    fn numbers(&mut self, list: &str, index: usize, options: &ReadOptions) -> Result<Vec<f64>, Fault> {
        let Some(line) = self.next() else {
            return Err(Fault::entry(
                list,
                index,
                "the file ends here, but its counts say that there are more: it is truncated, or its header is wrong",
            ));
        };
        // Each number takes at least a digit and a space, in a list that grows by doubling.
        options.claim_entries("the numbers of a line", line.len() / 2, 2 * size_of::<f64>())?;
        line.split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .map(|word| {
                parse_number(word).ok_or_else(|| {
                    Fault::new(
                        Place::Line(self.number),
                        format!("found {} in {list} {index}, expected a number", quoted(word)),
                    )
                })
            })
            .collect()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let rest = self.rest?;
            let end = rest.iter().position(|&byte| byte == b'\n');
            self.rest = end.map(|end| &rest[end + 1..]);
            self.number += 1;
            let line = &rest[..end.unwrap_or(rest.len())];
            let line = line.split(|&byte| byte == b'#').next().unwrap_or(line).trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }
}
