//! Lines of cells in columns, parsed on all cores.
//!
//! The text is cut into blocks at line ends, each block is parsed separately, and the blocks are joined in order: the
//! result, and the line that an error names, are the same for any number of threads.

use super::dialect::{Cell, Dialect, comment, hex_color, is_title, seconds_of};
use crate::io::columns::numbers::quoted;
use crate::io::error::{Fault, Place};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// Large enough to be worth a task, small enough that the cores share a file evenly.
const BLOCK_BYTES: usize = 1 << 20;

/// Maximum number of distinct words of a column; beyond that only their number is known.
pub(super) const MAX_WORDS: usize = 256;

/// Content of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Kind {
    /// Numbers. Other words are missing values.
    Number,
    /// Numbers without which a line is not a row.
    Required,
    /// Dates and times of day, in seconds.
    Time,
    /// Words, which become numbers of a [`ParsedRows::words`].
    Text,
    /// Colours in hexadecimal digits, which become one number: red, green, blue and alpha, a byte each.
    Hex,
}

/// The cells of a line, one after the other.
pub(super) struct Cells<'a> {
    dialect: Dialect,
    line: &'a [u8],
    at: usize,
    is_done: bool,
}

impl<'a> Cells<'a> {
    pub(super) fn new(dialect: Dialect, line: &'a [u8]) -> Self {
        Self {
            dialect,
            line,
            at: 0,
            is_done: false,
        }
    }

    fn skip_spaces(&mut self) {
        while self.line.get(self.at).is_some_and(|&byte| self.dialect.is_space(byte)) {
            self.at += 1;
        }
    }

    /// Goes to the start of the next cell; `None` behind the last one.
    fn start(&mut self) -> Option<()> {
        if self.is_done {
            return None;
        }
        self.skip_spaces();
        // After a last whitespace there is no cell, after a separator there is an empty one.
        let is_at_end = self.at >= self.line.len();
        (!is_at_end || (self.dialect.mark.is_some() && !self.line.is_empty())).then_some(())
    }

    /// Goes behind the sign that ends a cell.
    fn finish(&mut self) {
        self.skip_spaces();
        match self.line.get(self.at) {
            Some(&byte) if self.dialect.is_mark(byte) => self.at += 1,
            Some(_) => {}
            None => self.is_done = true,
        }
    }

    /// The next cell; `None` behind the last one.
    #[inline]
    fn next(&mut self) -> Option<Cell<'a>> {
        self.start()?;
        let rest = &self.line[self.at..];
        if let Ok((value, length)) = fast_float2::parse_partial::<f64, _>(rest)
            && self.ends_at(self.at + length)
        {
            self.at += length;
            self.finish();
            return Some(Cell::Number(value));
        }
        let word = self.word()?;
        Some(self.dialect.meaning(word))
    }

    /// Returns true if a number that ends at `end` is the whole cell.
    fn ends_at(&self, end: usize) -> bool {
        match self.line.get(end) {
            None => true,
            Some(&byte) if self.dialect.is_mark(byte) => true,
            Some(&byte) if !self.dialect.is_space(byte) => false,
            Some(_) if self.dialect.mark.is_none() => true,
            // Several words may form one cell.
            Some(_) => {
                let rest = self.line[end..].iter();
                let mut behind = rest.skip_while(|&&byte| self.dialect.is_space(byte));
                behind.next().is_none_or(|&byte| self.dialect.is_mark(byte))
            }
        }
    }

    /// The word in the next cell, without quotes; empty for an empty cell.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        self.start()?;
        let rest = &self.line[self.at..];
        if let Some(inside) = rest.strip_prefix(b"\"")
            && let Some(length) = inside.iter().position(|&byte| byte == b'"')
        {
            self.at += length + 2;
            self.finish();
            return Some(inside[..length].trim_ascii());
        }
        let ends =
            |&byte: &u8| self.dialect.is_mark(byte) || (self.dialect.mark.is_none() && self.dialect.is_space(byte));
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.at += length;
        self.finish();
        Some(rest[..length].trim_ascii())
    }

    /// All cells.
    pub(super) fn all(mut self) -> Vec<Cell<'a>> {
        std::iter::from_fn(|| self.next()).collect()
    }

    /// All words.
    pub(super) fn words(mut self) -> Vec<&'a [u8]> {
        std::iter::from_fn(|| self.word()).collect()
    }
}

/// The numbers of a line; `None` where something else is in it.
pub(in crate::io) fn numbers_in(line: &[u8], dialect: Dialect) -> Option<Vec<f64>> {
    let cells = Cells::new(dialect, line.trim_ascii()).all();
    let number = |cell: &Cell<'_>| match cell {
        Cell::Number(number) => Some(*number),
        Cell::Text(_) => None,
    };
    cells.iter().map(number).collect()
}

/// A line with one number, where rows have more.
#[derive(Debug, Clone, Copy)]
pub(in crate::io) struct Lone {
    pub(in crate::io) line: usize,
    /// Rows before it.
    pub(in crate::io) row: usize,
    pub(in crate::io) value: f64,
}

/// The first fault, and the number of faults.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::io) struct Odd {
    pub(in crate::io) count: usize,
    /// Its line and its fault.
    pub(in crate::io) first: Option<(usize, String)>,
}

impl Odd {
    fn add(&mut self, line: usize, problem: impl FnOnce() -> String) {
        self.count += 1;
        self.first.get_or_insert_with(|| (line, problem()));
    }

    fn append(&mut self, other: &Self, lines_before: usize) {
        self.count += other.count;
        if self.first.is_none() {
            let first = other.first.clone();
            self.first = first.map(|(line, problem)| (lines_before + line, problem));
        }
    }

    /// The first, as an error.
    pub(in crate::io) fn fault(&self) -> Option<Fault> {
        let (line, problem) = self.first.as_ref()?;
        Some(Fault::new(Place::Line(*line), problem.clone()))
    }
}

/// An empty line or a comment between two rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Break {
    /// Rows before it.
    pub(super) row: usize,
    /// The text of the comment.
    pub(super) label: String,
}

/// Parsed lines.
#[derive(Debug, Default)]
pub(in crate::io) struct ParsedRows {
    /// Column by column, all of the same length.
    pub(in crate::io) columns: Vec<Vec<f64>>,
    pub(in crate::io) lones: Vec<Lone>,
    /// Lines that are not rows: they are skipped.
    pub(in crate::io) odd_lines: Odd,
    /// Words where numbers are expected: they are missing.
    pub(super) odd_cells: Odd,
    pub(super) breaks: Vec<Break>,
    /// Sorted words of the columns of text, up to [`MAX_WORDS`] and one more; their cells hold indices.
    pub(super) words: Vec<Vec<String>>,
}

impl ParsedRows {
    pub(in crate::io) fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }
}

/// Words of a column in the order in which they came.
#[derive(Default)]
struct Words<'a> {
    places: HashMap<&'a [u8], usize>,
    list: Vec<&'a [u8]>,
}

impl<'a> Words<'a> {
    fn place_of(&mut self, word: &'a [u8]) -> f64 {
        if word.is_empty() {
            return f64::NAN;
        }
        if let Some(place) = self.places.get(word) {
            return *place as f64;
        }
        let place = self.list.len().min(MAX_WORDS);
        if place < MAX_WORDS {
            self.places.insert(word, place);
        }
        if self.list.len() <= MAX_WORDS {
            self.list.push(word);
        }
        place as f64
    }
}

/// Content of a block of lines; lines and rows are counted from its start.
#[derive(Default)]
struct LineBlock<'a> {
    /// Row after row.
    values: Vec<f64>,
    lones: Vec<Lone>,
    odd_lines: Odd,
    odd_cells: Odd,
    breaks: Vec<Break>,
    words: Vec<Words<'a>>,
    /// Column and word of the cells of text in a line.
    new_words: Vec<(usize, &'a [u8])>,
    lines: usize,
}

/// Parses `text`, whose first line is number `first_line` and whose lines have a cell of each of `kinds`, or one
/// number, or nothing. Its bytes are the steps reported to `progress`.
pub(in crate::io) fn parse(
    text: &[u8],
    first_line: usize,
    kinds: &[Kind],
    dialect: Dialect,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<ParsedRows, Fault> {
    let width = kinds.len();
    let taken = AtomicU64::new(0);
    let mut blocks: Vec<LineBlock<'_>> = blocks(text)
        .into_par_iter()
        .map(|block| {
            if progress.is_cancelled() {
                return Ok(LineBlock::default());
            }
            let mut parsed = parse_block(block, kinds, dialect);
            parsed.values.shrink_to_fit();
            // Parsed rows are assembled into columns, while the blocks are still in memory.
            let more = 2 * parsed.bytes();
            let bytes = taken.fetch_add(more, Ordering::Relaxed).saturating_add(more);
            options.claim("the numbers of its lines", bytes)?;
            progress.advance(block.len());
            Ok(parsed)
        })
        .collect::<Result<_, Fault>>()?;
    if progress.is_cancelled() {
        return Err(Fault::cancelled());
    }
    let mut parsed = ParsedRows {
        words: join_words(&mut blocks, kinds),
        ..ParsedRows::default()
    };
    let mut line = first_line;
    let mut row = 0;
    for block in &mut blocks {
        parsed.odd_lines.append(&block.odd_lines, line);
        parsed.odd_cells.append(&block.odd_cells, line);
        parsed.lones.extend(block.lones.iter().map(|lone| Lone {
            line: line + lone.line,
            row: row + lone.row,
            value: lone.value,
        }));
        parsed.breaks.extend(block.breaks.drain(..).map(|found| Break {
            row: row + found.row,
            ..found
        }));
        line += block.lines;
        row += block.values.len() / width;
    }
    parsed.columns = (0..width)
        .into_par_iter()
        .map(|column| {
            let mut values = Vec::with_capacity(row);
            for block in &blocks {
                values.extend(block.values.chunks_exact(width).map(|row| row[column]));
            }
            values
        })
        .collect();
    Ok(parsed)
}

/// The sorted words of each column, which become the numbers of its cells.
fn join_words(blocks: &mut [LineBlock<'_>], kinds: &[Kind]) -> Vec<Vec<String>> {
    let width = kinds.len();
    let mut all = vec![Vec::new(); width];
    for column in (0..width).filter(|&column| kinds[column] == Kind::Text) {
        let mut words: Vec<&[u8]> = Vec::new();
        for block in blocks.iter() {
            words.extend(block.words.get(column).into_iter().flat_map(|words| &words.list));
        }
        words.sort_unstable();
        words.dedup();
        for block in blocks.iter_mut() {
            let Some(of_block) = block.words.get(column) else {
                continue;
            };
            let places: Vec<usize> = of_block
                .list
                .iter()
                .map(|word| words.binary_search(word).unwrap_or(0))
                .collect();
            for cell in block.values.iter_mut().skip(column).step_by(width) {
                if let Some(place) = places.get(*cell as usize).filter(|_| !cell.is_nan()) {
                    *cell = *place as f64;
                }
            }
        }
        let name = |word: &&[u8]| String::from_utf8_lossy(word).into_owned();
        all[column] = words.iter().take(MAX_WORDS + 1).map(name).collect();
    }
    all
}

/// Pieces that end where a line does.
fn blocks(mut text: &[u8]) -> Vec<&[u8]> {
    let mut blocks = Vec::new();
    while !text.is_empty() {
        let min = text.len().min(BLOCK_BYTES);
        let end = text[min..]
            .iter()
            .position(|&byte| byte == b'\n')
            .map_or(text.len(), |end| min + end + 1);
        let (block, rest) = text.split_at(end);
        blocks.push(block);
        text = rest;
    }
    blocks
}

fn parse_block<'a>(text: &'a [u8], kinds: &[Kind], dialect: Dialect) -> LineBlock<'a> {
    let mut block = LineBlock::default();
    if kinds.contains(&Kind::Text) {
        block.words.resize_with(kinds.len(), Words::default);
    }
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        block.add_line(trimmed(line, dialect), kinds, dialect);
        block.lines += 1;
    }
    block
}

/// A line without the white space around it that separates nothing.
pub(super) fn trimmed(line: &[u8], dialect: Dialect) -> &[u8] {
    let is_space = |byte: &u8| *byte == b'\n' || dialect.is_space(*byte);
    let start = line.iter().position(|byte| !is_space(byte)).unwrap_or(line.len());
    let end = line
        .iter()
        .rposition(|byte| !is_space(byte))
        .map_or(start, |end| end + 1);
    &line[start..end]
}

impl<'a> LineBlock<'a> {
    /// Memory that it takes.
    fn bytes(&self) -> u64 {
        let labels: usize = self.breaks.iter().map(|found| found.label.len()).sum();
        let breaks = size_of_val(self.breaks.as_slice()) + labels;
        (size_of_val(self.values.as_slice()) + size_of_val(self.lones.as_slice()) + breaks) as u64
    }

    fn add_line(&mut self, line: &'a [u8], kinds: &[Kind], dialect: Dialect) {
        let width = kinds.len();
        let before = self.values.len();
        if line.is_empty() {
            self.add_break(before / width, b"");
            return;
        }
        if let Some(text) = comment(line) {
            self.add_break(before / width, text);
            return;
        }
        if is_title(line) {
            self.add_break(before / width, line);
            return;
        }
        self.new_words.clear();
        let mut cells = Cells::new(dialect, line);
        let mut found = 0;
        let mut wrong: Option<String> = None;
        let (mut has_value, mut is_last_missing) = (false, false);
        loop {
            let value = match kinds.get(found) {
                Some(Kind::Text) => cells.word().map(|word| {
                    // Words on lines that are skipped do not belong to the column.
                    self.new_words.push((found, word));
                    if word.is_empty() { f64::NAN } else { 0.0 }
                }),
                Some(Kind::Hex) => cells.word().map(|word| {
                    let color = hex_color(word).map(u32::from_be_bytes);
                    color.map_or(f64::NAN, f64::from)
                }),
                Some(Kind::Time) => cells.word().map(|word| seconds_of(word).unwrap_or(f64::NAN)),
                kind => cells.next().map(|cell| match cell {
                    Cell::Number(number) => number,
                    Cell::Text(word) if kind == Some(&Kind::Number) => {
                        let number = self.lines;
                        let problem = || format!("found {}, expected a number", quoted(word));
                        self.odd_cells.add(number, problem);
                        has_value = true;
                        f64::NAN
                    }
                    Cell::Text(word) => {
                        wrong.get_or_insert_with(|| format!("found {}, expected a number", quoted(word)));
                        f64::NAN
                    }
                }),
            };
            let Some(value) = value else { break };
            found += 1;
            is_last_missing = value.is_nan();
            has_value |= !is_last_missing;
            if found <= width {
                self.values.push(value);
            }
        }
        if !has_value && wrong.is_none() {
            // A line of separators only is an empty spreadsheet row, but one of words for missing values is a point.
            if line
                .iter()
                .all(|&byte| dialect.is_mark(byte) || dialect.is_space(byte) || byte == b'"')
            {
                self.values.truncate(before);
                return;
            }
        }
        match found {
            // A separator after the last cell.
            _ if wrong.is_none() && found == width + 1 && is_last_missing => {}
            // A separator after the last cell but one.
            _ if wrong.is_none() && found + 1 == width && line.last().is_some_and(|&byte| dialect.is_mark(byte)) => {
                self.values.push(f64::NAN);
            }
            _ if wrong.is_none() && found == width => {}
            _ => {
                self.values.truncate(before);
                match dialect.number_of(line) {
                    Some(value) if found == 1 => self.lones.push(Lone {
                        line: self.lines,
                        row: before / width,
                        value,
                    }),
                    _ => {
                        let problem = || wrong.unwrap_or_else(|| format!("found {found} numbers, expected {width}"));
                        self.odd_lines.add(self.lines, problem);
                    }
                }
                return;
            }
        }
        for (column, word) in self.new_words.drain(..) {
            self.values[before + column] = self.words[column].place_of(word);
        }
    }

    /// Several empty lines and comments between two rows are one break.
    fn add_break(&mut self, row: usize, text: &[u8]) {
        let label = || String::from_utf8_lossy(text).trim().to_owned();
        match self.breaks.last_mut() {
            Some(last) if last.row == row => {
                if last.label.is_empty() {
                    last.label = label();
                }
            }
            _ => self.breaks.push(Break { row, label: label() }),
        }
    }
}

#[cfg(test)]
mod tests;
