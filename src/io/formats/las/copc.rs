//! Cloud-optimised files (COPC): LAZ whose chunks are the voxels of an octree, coarse ones for the whole and fine ones
//! for parts of it.
//!
//! The voxels are found by pages that refer to further pages. All of it is a claim: a page is read once, a file has no
//! more entries than bytes for them, and the points of all voxels must be those that the header counts. Where that is
//! not so, the file is read like any other LAZ file.

use super::header::{LasHeader, Record, take};
use super::laz::LazChunk;
use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

/// Bytes of an entry: level, three indices, where its chunk or page is, how long that is, and how many points.
const ENTRY_BYTES: usize = 32;

/// Finer voxels than this would have sides of nothing.
const MAX_LEVEL: i32 = 63;

/// The voxels by level, coarse ones first; `None` if the file of `file_bytes` has none or they do not fit together.
/// `page` gives the bytes of a part of the file.
pub(super) fn levels<'a>(
    header: &LasHeader,
    mut records: impl Iterator<Item = Record<'a>>,
    file_bytes: usize,
    page: impl FnMut(Range<usize>) -> Option<Cow<'a, [u8]>>,
) -> Option<Vec<Vec<LazChunk>>> {
    let info = records.find(|record| record.is(b"copc", 1))?.data;
    let number = |at: usize| {
        let raw = info.get(at..at + 8)?;
        usize::try_from(u64::from_le_bytes(take(raw, 0))).ok()
    };
    let levels = walk(number(40)?, number(48)?, file_bytes, page)?;
    let points: u64 = levels.iter().flatten().map(|chunk| chunk.points as u64).sum();
    (points == header.count).then_some(levels)
}

/// Follows the pages from the one of this start and length.
fn walk<'a>(
    start: usize,
    length: usize,
    file_bytes: usize,
    mut page: impl FnMut(Range<usize>) -> Option<Cow<'a, [u8]>>,
) -> Option<Vec<Vec<LazChunk>>> {
    /// Page marker instead of a point count: the entry is a further page.
    const PAGE: i32 = -1;
    let mut levels: Vec<Vec<LazChunk>> = Vec::new();
    let mut pages = vec![(start, length)];
    let mut seen = HashSet::from([start]);
    let mut entries = 0;
    while let Some((start, length)) = pages.pop() {
        let page = page(start..start.checked_add(length)?)?;
        let (page, []) = page.as_chunks::<ENTRY_BYTES>() else {
            return None;
        };
        entries += page.len();
        if entries > file_bytes / ENTRY_BYTES {
            return None;
        }
        for entry in page {
            let number = |at| i32::from_le_bytes(take(entry, at));
            let start = usize::try_from(u64::from_le_bytes(take(entry, 16))).ok()?;
            let length = usize::try_from(number(24)).ok()?;
            let (level, points) = (number(0), number(28));
            if points == PAGE {
                if !seen.insert(start) {
                    return None;
                }
                pages.push((start, length));
                continue;
            }
            let points = usize::try_from(points).ok()?;
            if points == 0 {
                continue;
            }
            let end = start.checked_add(length).filter(|&end| end <= file_bytes)?;
            if !(0..=MAX_LEVEL).contains(&level) || !seen.insert(start) {
                return None;
            }
            let level = level as usize;
            if levels.len() <= level {
                levels.resize(level + 1, Vec::new());
            }
            levels[level].push(LazChunk {
                bytes: start..end,
                points,
            });
        }
    }
    // In the order of the file within a level, regardless of the order of the pages.
    for level in &mut levels {
        level.sort_by_key(|chunk| chunk.bytes.start);
    }
    Some(levels)
}
