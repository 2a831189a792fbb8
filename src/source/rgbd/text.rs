//! Small files of text: lists, poses, cameras.

use super::error::RgbdError;
use crate::binary::{Header, Layout};
use crate::raster;
use std::io::Read as _;
use std::path::Path;

/// A trajectory of a day has fewer bytes.
const MAX_BYTES: u64 = 256 << 20;

/// The text of the file at `path`; bytes that are not UTF-8 are replaced.
pub(in crate::source) fn read(path: &Path) -> Result<String, RgbdError> {
    Ok(String::from_utf8_lossy(&read_bytes(path, MAX_BYTES)?).into_owned())
}

/// The bytes of the file at `path`, no more than `max_bytes`.
pub(super) fn read_bytes(path: &Path, max_bytes: u64) -> Result<Vec<u8>, RgbdError> {
    let unreadable = |reason| RgbdError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let file = crate::regular_file::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(unreadable(std::io::Error::other("it is not a regular file")));
    }
    let bytes = metadata.len();
    let max_bytes = max_bytes.min(isize::MAX as u64);
    if bytes > max_bytes {
        return Err(RgbdError::TooLarge {
            path: path.to_owned(),
            bytes,
            max_bytes,
        });
    }
    let mut read = Vec::new();
    crate::memory::try_reserve(&mut read, bytes as usize)
        .map_err(|reason| unreadable(std::io::Error::other(reason)))?;
    file.take(max_bytes).read_to_end(&mut read).map_err(unreadable)?;
    Ok(read)
}

/// The shape and the numbers of an array of numpy, in the order of C.
pub(super) fn array(path: &Path) -> Result<Array, RgbdError> {
    array_of(path, &read_bytes(path, MAX_BYTES)?)
}

/// The shape of the array at `path`, read from its head only.
pub(super) fn array_shape(path: &Path) -> Option<Vec<usize>> {
    const HEAD_BYTES: u64 = 1 << 16;
    let mut head = Vec::new();
    crate::regular_file::open(path)
        .ok()?
        .take(HEAD_BYTES)
        .read_to_end(&mut head)
        .ok()?;
    Some(Header::parse(&head).ok()?.shape)
}

/// A shape and numbers.
type Array = (Vec<usize>, Vec<f64>);

/// Reads the numeric arrays in a `NumPy` archive, with their names; others are skipped.
pub(super) fn arrays(path: &Path) -> Result<Vec<(String, Array)>, RgbdError> {
    let bytes = read_bytes(path, MAX_BYTES)?;
    let members = raster::members_of_npz(&bytes, MAX_BYTES).map_err(|reason| RgbdError::Image {
        path: path.to_owned(),
        reason,
    })?;
    let arrays = members
        .into_iter()
        .filter_map(|(name, bytes)| Some((name, array_of(path, &bytes).ok()?)));
    Ok(arrays.collect())
}

fn array_of(path: &Path, bytes: &[u8]) -> Result<Array, RgbdError> {
    let wrong = |reason: String| RgbdError::Image {
        path: path.to_owned(),
        reason,
    };
    let header = Header::parse(bytes).map_err(|error| wrong(error.to_string()))?;
    let Layout::Table(number) = header.layout else {
        return Err(wrong("it is an array of records, expected numbers".to_owned()));
    };
    if header.is_fortran && header.shape.len() > 1 {
        return Err(wrong(
            "it is in the order of Fortran: save it by numpy.ascontiguousarray".to_owned(),
        ));
    }
    let payload = bytes.get(header.payload_at..).unwrap_or_default();
    let numbers: Vec<f64> = payload
        .chunks_exact(number.bytes())
        .map(|entry| number.read(entry))
        .collect();
    Ok((header.shape, numbers))
}

/// The numbers of each line that has any, with the number of the line from 1. Commas and semicolons are spaces; text
/// after a `#` is a comment. Brackets are spaces as well.
///
/// # Errors
/// The first line with something else.
pub(in crate::source) fn number_lines(path: &Path, text: &str) -> Result<Vec<(usize, Vec<f64>)>, RgbdError> {
    let mut lines = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default();
        let words = content.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '[' | ']' | '(' | ')'));
        let numbers: Result<Vec<f64>, &str> = words
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().map_err(|_| word))
            .collect();
        match numbers {
            Ok(numbers) if numbers.is_empty() => {}
            Ok(numbers) => lines.push((index + 1, numbers)),
            Err(word) => {
                return Err(RgbdError::Line {
                    path: path.to_owned(),
                    line: index + 1,
                    reason: format!("`{}` is not a number", word.escape_default()),
                });
            }
        }
    }
    Ok(lines)
}
