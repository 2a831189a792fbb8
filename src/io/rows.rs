//! Lines of numbers in columns, parsed by all cores.
//!
//! The text is cut into blocks at line ends, each block is parsed by itself, and the blocks are put together in order:
//! the result, and the line that an error names, are the same for any number of threads.

use super::error::{Fault, Place};
use super::numbers::{parse_number, quoted};
use crate::progress::Progress;
use rayon::prelude::*;

/// Large enough to be worth a task, small enough that the cores share a file evenly.
const BLOCK_BYTES: usize = 1 << 20;

/// How numbers are written and parted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dialect {
    /// `1,5` is one and a half, not two numbers.
    pub(super) decimal_comma: bool,
}

impl Dialect {
    /// What the first lines of `text` tell: a comma is a decimal one if every line has three or more words between
    /// spaces and semicolons, and within a word at most one comma, between digits.
    pub(super) fn of(text: &[u8]) -> Self {
        const LOOKED_AT_BYTES: usize = 64 << 10;
        let head = &text[..text.len().min(LOOKED_AT_BYTES)];
        // The last line may be cut in the middle of a number.
        let head = match head.iter().rposition(|&byte| byte == b'\n') {
            Some(end) if head.len() < text.len() => &head[..end],
            _ => head,
        };
        let mut has_comma = false;
        for line in head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii) {
            let is_numbers = line.iter().all(|byte| b"0123456789+-.,;eE \t\"".contains(byte));
            if !is_numbers || !line.contains(&b',') {
                continue;
            }
            has_comma = true;
            let mut words = 0;
            for word in line
                .split(|byte| b" \t;".contains(byte))
                .filter(|word| !word.is_empty())
            {
                words += 1;
                let commas = word.split(|&byte| byte == b',').count() - 1;
                let is_between_digits = word
                    .windows(3)
                    .any(|three| three[1] == b',' && three[0].is_ascii_digit() && three[2].is_ascii_digit());
                if commas > 1 || (commas == 1 && (!is_between_digits || word.contains(&b'.'))) {
                    return Self { decimal_comma: false };
                }
            }
            if words < 3 {
                return Self { decimal_comma: false };
            }
        }
        Self {
            decimal_comma: has_comma,
        }
    }

    /// True for what stands between two columns even if one of them is empty.
    fn is_mark(self, byte: u8) -> bool {
        byte == b';' || (byte == b',' && !self.decimal_comma)
    }

    fn parts(self, byte: u8) -> bool {
        is_space(byte) || self.is_mark(byte)
    }

    /// Appends the numbers of `line` to `values`, NaN for an empty column; fails with what is no number.
    pub(super) fn parse_line<'a>(self, line: &'a [u8], values: &mut Vec<f64>) -> Result<usize, &'a [u8]> {
        let before = values.len();
        let mut has_number = false;
        let mut at = 0;
        loop {
            while at < line.len() && is_space(line[at]) {
                at += 1;
            }
            if at == line.len() {
                break;
            }
            if self.is_mark(line[at]) {
                values.push(f64::NAN);
                at += 1;
                continue;
            }
            let rest = &line[at..];
            let (value, length) = match fast_float2::parse_partial::<f64, _>(rest) {
                Ok((value, length)) if rest.get(length).is_none_or(|&byte| self.parts(byte)) => (value, length),
                _ => {
                    let length = rest.iter().position(|&byte| self.parts(byte)).unwrap_or(rest.len());
                    let token = &rest[..length];
                    (self.parse_odd(token).ok_or(token)?, length)
                }
            };
            values.push(value);
            has_number = true;
            at += length;
            while at < line.len() && is_space(line[at]) {
                at += 1;
            }
            if at < line.len() && self.is_mark(line[at]) {
                at += 1;
            }
        }
        if !has_number {
            // Separators alone are an empty line of a spreadsheet.
            values.truncate(before);
        }
        Ok(values.len() - before)
    }

    /// A number with a decimal comma, in quotes, or that is none by its own account.
    fn parse_odd(self, token: &[u8]) -> Option<f64> {
        /// Longer ones are no numbers that anybody wrote.
        const MOST_DIGITS: usize = 64;
        let token = token
            .strip_prefix(b"\"")
            .and_then(|rest| rest.strip_suffix(b"\""))
            .unwrap_or(token);
        if self.decimal_comma && token.len() <= MOST_DIGITS {
            let mut point = [0; MOST_DIGITS];
            let point = &mut point[..token.len()];
            point.copy_from_slice(token);
            if let Some(comma) = point.iter().position(|&byte| byte == b',') {
                point[comma] = b'.';
            }
            return parse_number(point);
        }
        parse_number(token)
    }
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// The text behind the mark of a comment.
pub(super) fn comment(line: &[u8]) -> Option<&[u8]> {
    line.strip_prefix(b"//").or_else(|| line.strip_prefix(b"#"))
}

/// A line with one number, where rows have more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lone {
    pub(super) line: usize,
    /// Rows before it.
    pub(super) row: usize,
    pub(super) value: f64,
}

/// Parsed lines.
#[derive(Debug, Default)]
pub(super) struct ParsedRows {
    /// Column by column, all of the same length.
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) lones: Vec<Lone>,
}

impl ParsedRows {
    pub(super) fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }
}

/// What a block of lines holds; lines and rows are counted from its start.
#[derive(Default)]
struct LineBlock {
    /// Row after row.
    values: Vec<f64>,
    lones: Vec<Lone>,
    lines: usize,
    fault: Option<(usize, String)>,
}

/// Parses `text`, whose first line is number `first_line` and whose lines have `width` numbers, or one, or none. Its
/// bytes are the steps that `progress` is told of.
pub(super) fn parse(
    text: &[u8],
    first_line: usize,
    width: usize,
    dialect: Dialect,
    progress: &Progress,
) -> Result<ParsedRows, Fault> {
    let blocks: Vec<LineBlock> = blocks(text)
        .into_par_iter()
        .map(|block| {
            if progress.is_cancelled() {
                return LineBlock::default();
            }
            let parsed = parse_block(block, width, dialect);
            progress.advance(block.len());
            parsed
        })
        .collect();
    if progress.is_cancelled() {
        return Err(Fault::cancelled());
    }
    let mut line = first_line;
    let mut row = 0;
    let mut lones = Vec::new();
    for block in &blocks {
        if let Some((at, problem)) = &block.fault {
            return Err(Fault::new(Place::Line(line + at), problem.clone()));
        }
        lones.extend(block.lones.iter().map(|lone| Lone {
            line: line + lone.line,
            row: row + lone.row,
            value: lone.value,
        }));
        line += block.lines;
        row += block.values.len() / width;
    }
    let columns = (0..width)
        .into_par_iter()
        .map(|column| {
            let mut values = Vec::with_capacity(row);
            for block in &blocks {
                values.extend(block.values.chunks_exact(width).map(|row| row[column]));
            }
            values
        })
        .collect();
    Ok(ParsedRows { columns, lones })
}

/// Pieces that end where a line does.
fn blocks(mut text: &[u8]) -> Vec<&[u8]> {
    let mut blocks = Vec::new();
    while !text.is_empty() {
        let least = text.len().min(BLOCK_BYTES);
        let end = text[least..]
            .iter()
            .position(|&byte| byte == b'\n')
            .map_or(text.len(), |end| least + end + 1);
        let (block, rest) = text.split_at(end);
        blocks.push(block);
        text = rest;
    }
    blocks
}

fn parse_block(text: &[u8], width: usize, dialect: Dialect) -> LineBlock {
    let mut block = LineBlock::default();
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        let number = block.lines;
        block.lines += 1;
        let line = line.trim_ascii();
        if comment(line).is_some() {
            continue;
        }
        let before = block.values.len();
        match dialect.parse_line(line, &mut block.values) {
            Ok(found) if found == width || found == 0 => {}
            Ok(1) => {
                block.lones.push(Lone {
                    line: number,
                    row: before / width,
                    value: block.values[before],
                });
                block.values.truncate(before);
            }
            Ok(found) => {
                block.fault = Some((number, format!("found {found} numbers, expected {width}")));
                return block;
            }
            Err(token) => {
                block.fault = Some((number, format!("found {}, expected a number", quoted(token))));
                return block;
            }
        }
    }
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_are_told_by_their_neighbours() {
        for (text, decimal_comma) in [
            ("1,5;2,5;3,5\n", true),
            ("1,5 2,5 3,5\n", true),
            ("1\t2\t3,25\n", true),
            ("x;y;z\n1,5;2,5;3,5\n", true),
            ("1,2,3\n", false),
            ("1, 2, 3\n", false),
            ("1.5 2.5 3.5\n", false),
            ("1,2,3 4,5,6 7,8,9\n", false),
            ("1.5,2;3;4\n", false),
            ("1,5;2,5;3,5\n1,2,3\n", false),
        ] {
            assert_eq!(Dialect::of(text.as_bytes()), Dialect { decimal_comma }, "{text:?}");
        }
    }

    #[test]
    fn empty_columns_are_no_numbers_and_empty_lines_no_rows() {
        let dialect = Dialect { decimal_comma: false };
        let parsed = |line: &str| {
            let mut values = Vec::new();
            let count = dialect.parse_line(line.as_bytes(), &mut values).unwrap();
            assert_eq!(count, values.len());
            format!("{values:?}")
        };
        assert_eq!(parsed("1,,3"), "[1.0, NaN, 3.0]");
        assert_eq!(parsed("1 , 2 ,3,"), "[1.0, 2.0, 3.0]");
        assert_eq!(parsed("1;2;\"3.5\""), "[1.0, 2.0, 3.5]");
        assert_eq!(parsed(",,,"), "[]");
        assert_eq!(parsed(" \t "), "[]");
    }

    #[test]
    fn many_blocks_are_parsed_as_one_and_name_the_line() {
        let mut text: Vec<String> = (0..200_000).map(|i| format!("{i} {} -{i}.5 7", i * 2)).collect();
        let dialect = Dialect { decimal_comma: false };
        let progress = Progress::default();
        let rows = parse(text.join("\n").as_bytes(), 1, 4, dialect, &progress).unwrap();
        assert_eq!(progress.done(), text.join("\n").len());
        assert_eq!(rows.len(), 200_000);
        assert!((0..200_000).all(|i| rows.columns[2][i] == -(i as f64) - 0.5));
        assert!(text.join("\n").len() > 2 * BLOCK_BYTES);
        "1 2 oops 4".clone_into(&mut text[150_000]);
        "1 2".clone_into(&mut text[170_000]);
        let fault = parse(text.join("\r\n").as_bytes(), 11, 4, dialect, &progress).unwrap_err();
        assert_eq!(fault.place, Place::Line(150_011));
    }
}
