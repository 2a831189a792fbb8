//! Blocks of a count, a comment and that number of rows: the layout of XYZ files in chemistry, and of tracks of points.
//!
//! Only the counts are read to find the blocks. The rows are copied without the lines between them, so that they are
//! parsed as one table.

use super::dialect::{Cell, Dialect};
use super::head::count_of_points;
use super::rows::Cells;
use crate::io::error::Fault;

/// A block of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) rows: usize,
    /// The line before its rows.
    pub(super) comment: String,
    /// The line of its first row, counted from 1.
    line: usize,
}

/// All blocks of a file.
#[derive(Debug)]
pub(super) struct Counted {
    /// The rows of all blocks.
    pub(super) text: Vec<u8>,
    pub(super) blocks: Vec<Block>,
}

/// Lines, one after the other.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&byte| byte == b'\n');
        let (line, rest) = self.rest.split_at(end.map_or(self.rest.len(), |end| end + 1));
        self.rest = rest;
        self.number += 1;
        Some(line)
    }

    fn next_count(&mut self) -> Option<usize> {
        loop {
            let line = self.next()?.trim_ascii();
            if !line.is_empty() {
                return count_in(line);
            }
        }
    }
}

fn count_in(line: &[u8]) -> Option<usize> {
    let is_digits = line.iter().all(u8::is_ascii_digit);
    let number = std::str::from_utf8(line).ok()?.parse().ok()?;
    count_of_points(number).filter(|&count| is_digits && count > 0)
}

impl Counted {
    /// The blocks of `bytes`; `None` where it has another layout.
    pub(super) fn of(bytes: &[u8]) -> Result<Option<Self>, Fault> {
        let mut lines = Lines { rest: bytes, number: 0 };
        if lines.next_count().is_none() || lines.next().is_none_or(is_row) {
            return Ok(None);
        }
        // A line of names after the count, which some files have, belongs to a table.
        let mut counted = Self {
            text: Vec::new(),
            blocks: Vec::new(),
        };
        let mut lines = Lines { rest: bytes, number: 0 };
        while !lines.rest.trim_ascii().is_empty() {
            let Some(count) = lines.next_count() else {
                // Something else follows the first rows: they are read as a table.
                return Ok(None);
            };
            let comment = lines.next().unwrap_or_default();
            let line = lines.number + 1;
            let start = lines.rest;
            for row in 0..count {
                let is_there = lines.next().is_some_and(|line| !line.trim_ascii().is_empty());
                if !is_there {
                    let frame = counted.blocks.len();
                    return Err(Fault::entry(
                        "point",
                        row,
                        format!(
                            "the file ends here, but line {} counts {count} points of frame {frame}: it is truncated",
                            line - 2
                        ),
                    ));
                }
            }
            counted.text.extend(&start[..start.len() - lines.rest.len()]);
            if !counted.text.ends_with(b"\n") {
                counted.text.push(b'\n');
            }
            counted.blocks.push(Block {
                rows: count,
                comment: String::from_utf8_lossy(comment).trim().to_owned(),
                line,
            });
        }
        Ok(Some(counted))
    }

    /// The line of the file that line `line` of the text is.
    pub(super) fn line_of(&self, line: usize) -> usize {
        let mut before = 0;
        for block in &self.blocks {
            if line <= before + block.rows {
                return block.line + line - before - 1;
            }
            before += block.rows;
        }
        line
    }
}

fn is_row(line: &[u8]) -> bool {
    // Extended XYZ: `Lattice="5 0 0 0 5 0 0 0 5"`.
    if line.contains(&b'=') {
        return false;
    }
    let cells = Cells::new(Dialect::of(line), line.trim_ascii()).all();
    let numbers = cells
        .iter()
        .filter(|cell| matches!(cell, Cell::Number(number) if !number.is_nan()));
    numbers.count() >= 3
}

/// Names of columns in the comment of an extended XYZ file, `Properties=species:S:1:pos:R:3`.
pub(super) fn properties(comment: &str) -> Option<Vec<String>> {
    const KEY: &str = "properties=";
    // Converting ASCII to lower case does not change its length.
    let start = comment.to_ascii_lowercase().find(KEY)? + KEY.len();
    let list = comment.get(start..)?.trim_start_matches('"');
    let list = list.split([' ', '"', '\t']).next()?;
    let parts: Vec<&str> = list.split(':').collect();
    let mut names = Vec::new();
    for property in parts.chunks_exact(3) {
        let count: usize = property[2].parse().ok().filter(|count| (1..=16).contains(count))?;
        match (property[0], count) {
            ("pos" | "positions", 3) => names.extend(["x", "y", "z"].map(str::to_owned)),
            ("species", 1) => names.push("element".to_owned()),
            (name, 1) => names.push(name.to_owned()),
            (name, 3) => names.extend(["x", "y", "z"].map(|axis| format!("{name}_{axis}"))),
            (name, count) => names.extend((0..count).map(|index| format!("{name}_{index}"))),
        }
    }
    Some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_found_by_their_point_counts() {
        let text = "2\nfirst\nC 1 2 3\nO 4 5 6\n1\n\nC 7 8 9\n";
        let counted = Counted::of(text.as_bytes()).unwrap().unwrap();
        let blocks: Vec<(usize, &str)> = counted
            .blocks
            .iter()
            .map(|block| (block.rows, block.comment.as_str()))
            .collect();
        assert_eq!(blocks, [(2, "first"), (1, "")]);
        assert_eq!(counted.text, b"C 1 2 3\nO 4 5 6\nC 7 8 9\n");
        assert_eq!([1, 2, 3].map(|line| counted.line_of(line)), [3, 4, 7]);
        for other in [
            "2\n1 2 3\n4 5 6\n",
            "1 2 3\n",
            "x y z\n1 2 3\n",
            "1\nx y z\n1 2 3\n4 5 6\n",
            "5\n",
        ] {
            assert!(Counted::of(other.as_bytes()).unwrap().is_none(), "{other:?}");
        }
        let lattice = "1\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=species:S:1:pos:R:3\nC 1 2 3\n";
        assert!(Counted::of(lattice.as_bytes()).unwrap().is_some());
        let fault = Counted::of(b"2\nfirst\nC 1 2 3\n").unwrap_err();
        assert!(fault.problem.contains("truncated"), "{fault:?}");
    }

    #[test]
    fn extended_comments_name_the_columns() {
        let comment = "Lattice=\"1 0 0\" Properties=species:S:1:pos:R:3:forces:R:3:q:R:1 pbc=\"T T T\"";
        let names = properties(comment).unwrap().join(" ");
        assert_eq!(names, "element x y z forces_x forces_y forces_z q");
        assert_eq!(properties("step 3"), None);
    }
}
