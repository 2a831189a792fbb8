//! The list of the frames in a file.

use super::counted::Counted;
use super::dialect::{SAMPLE_BYTES, comment, is_title};
use super::frames::{Counter, Frame};
use super::head::{Head, strs};
use super::layout::plain;
use super::table::Table;
use crate::io::columns::column_names::markers;
use crate::io::contents::{Entry, Part};
use crate::io::error::IoError;
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use std::io::Read as _;
use std::path::Path;

/// Larger files are not read to find out whether they are a sequence, if their first lines do not say so.
const MAX_LISTED_BYTES: u64 = 512 << 20;

/// The frames of the file at `path`. An unintelligible file is one frame, which then reports the reason.
pub(in crate::io) fn list(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let size = file.metadata().map_err(failed)?.len();
    let mut bytes = Vec::new();
    file.by_ref()
        .take(SAMPLE_BYTES as u64)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    let may_be_sequence = has_counter(&bytes, options);
    // Reading it as one frame reports that it is too large.
    if size > options.max_memory_bytes || (!may_be_sequence && size > MAX_LISTED_BYTES) {
        return Ok(vec![Entry::whole()]);
    }
    file.read_to_end(&mut bytes).map_err(failed)?;
    if !may_be_sequence && !has_breaks(&plain(&bytes).text) {
        return Ok(vec![Entry::whole()]);
    }
    let options = &options.holding(bytes.len());
    let table = Table::open(path, &bytes, options, &Progress::default());
    let frames = table.map(|table| table.frames).unwrap_or_default();
    if frames.len() < 2 {
        return Ok(vec![Entry::whole()]);
    }
    let entry = |(index, frame): (usize, Frame)| Entry {
        name: frame.name,
        time: frame.time,
        part: Part::Layer(index),
    };
    Ok(frames.into_iter().enumerate().map(entry).collect())
}

/// Returns true if the first lines name a column of frames or times, or count the rows of the first block.
fn has_counter(bytes: &[u8], options: &ReadOptions) -> bool {
    if options.columns.is_some_and(|map| map.frame().is_some()) {
        return true;
    }
    let text = plain(bytes).text;
    let is_counted = Counted::of(&text).map_or(true, |counted| counted.is_some());
    let header = Head::read(&text).ok().and_then(|head| head.header);
    let counts = |name: &String| Counter::of(name).is_some();
    is_counted
        || header.is_some_and(|header| header.names.iter().any(counts) || !markers(&strs(&header.names)).is_empty())
}

/// Returns true if a block break, anything other than a row, is between two rows.
fn has_breaks(text: &[u8]) -> bool {
    let is_digit_or_sign = |line: &[u8]| {
        line.first()
            .is_some_and(|byte| byte.is_ascii_digit() || b"-+.".contains(byte))
    };
    let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut has_row = false;
    let mut has_break = false;
    lines.any(|line| {
        let is_break = line.is_empty()
            || comment(line).is_some()
            || is_title(line)
            || (has_row && !line.iter().any(|byte| b" \t,;".contains(byte)));
        has_break |= has_row && is_break;
        has_row |= !is_break && is_digit_or_sign(line);
        has_break && !is_break
    })
}
