//! Frames as sections of streams, and streams as parts.

use super::grid::Grid;
use super::schema::{Schema, StreamKind};
use crate::reel::error::Fault;
use crate::reel::file::{ByteReader, ByteWriter};
use std::ops::Range;

/// Levels of at most this many nodes are one section.
const NODES_OF_FIRST_SECTION: usize = 1 << 10;

/// A part of a frame that is read as a whole.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct CodedSection {
    /// Levels that it adds; none if it adds the points.
    pub(in crate::reel) levels: Range<usize>,
    pub(in crate::reel) streams: Vec<(StreamKind, Vec<u8>)>,
}

impl CodedSection {
    /// The bytes of a kind; none without such a stream.
    pub(super) fn stream(&self, kind: StreamKind) -> &[u8] {
        let stream = self.streams.iter().find(|(other, _)| *other == kind);
        stream.map_or(&[], |(_, bytes)| bytes.as_slice())
    }
}

/// Levels that belong to one section each, by the number of nodes of every level.
pub(super) fn sections_of(counts: &[usize]) -> Vec<Range<usize>> {
    let first = counts
        .iter()
        .position(|&count| count > NODES_OF_FIRST_SECTION)
        .unwrap_or(counts.len())
        .max(1);
    std::iter::once(0..first)
        .chain((first..counts.len()).map(|level| level..level + 1))
        .collect()
}

/// Sections without streams: of these levels, and then of the points, if there are any.
pub(super) fn blank_sections(ranges: &[Range<usize>], has_points: bool) -> Vec<CodedSection> {
    let end = ranges.last().map_or(0, |range| range.end);
    ranges
        .iter()
        .cloned()
        .chain(has_points.then_some(end..end))
        .map(|levels| CodedSection {
            levels,
            streams: Vec::new(),
        })
        .collect()
}

/// Extent to which a frame is to be decoded, and its known properties.
#[derive(Debug, Clone)]
pub(in crate::reel) struct Wanted<'a> {
    pub(in crate::reel) schema: &'a Schema,
    pub(in crate::reel) grid: &'a Grid,
    /// Nodes of each level that there is.
    pub(in crate::reel) counts: &'a [usize],
    /// Points stored individually, in cells and outside.
    pub(in crate::reel) points: [usize; 2],
    /// True if the values of all levels are wanted, and not those of the last one alone.
    pub(in crate::reel) keeps_levels: bool,
}

/// Number of nodes of each level, and the levels that each section adds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes<'a> {
    pub(super) counts: &'a [usize],
    pub(super) ranges: &'a [Range<usize>],
}

impl Sizes<'_> {
    /// The section of a level.
    pub(super) fn section_of(self, level: usize) -> usize {
        section_of(self.ranges, level)
    }
}

/// The section of each of the first levels, and of the points.
pub(super) fn places_of(ranges: &[Range<usize>], levels: usize, has_points: bool) -> Vec<usize> {
    let of_levels = (0..levels).map(|level| section_of(ranges, level));
    of_levels.chain(has_points.then_some(ranges.len())).collect()
}

/// Returns the levels that sections add, excluding sections of points.
pub(super) fn ranges_of(sections: &[CodedSection]) -> Vec<Range<usize>> {
    let levels = sections.iter().map(|section| section.levels.clone());
    levels.filter(|levels| !levels.is_empty()).collect()
}

/// The section of a level, by the levels of each.
fn section_of(ranges: &[Range<usize>], level: usize) -> usize {
    ranges.iter().position(|range| range.contains(&level)).unwrap_or(0)
}

/// Streams by their kind, each with its bytes in each section.
pub(super) type CodedStreams = Vec<(StreamKind, Vec<Vec<u8>>)>;

/// One stream of parts: how long each but the last is, and their bytes.
pub(super) fn joined(parts: &[Vec<u8>]) -> Vec<u8> {
    let mut writer = ByteWriter::default();
    for part in &parts[..parts.len().saturating_sub(1)] {
        writer.number(part.len() as u64);
    }
    writer.bytes.extend(parts.concat());
    writer.bytes
}

/// The parts that a stream is joined of.
pub(super) fn parted(stream: &[u8], parts: usize) -> Result<Vec<&[u8]>, Fault> {
    let mut reader = ByteReader::new(stream);
    let lengths: Vec<u64> = (1..parts).map(|_| reader.number()).collect::<Result<_, _>>()?;
    let mut parts = Vec::with_capacity(parts);
    for length in lengths {
        parts.push(reader.take(length as usize)?);
    }
    parts.push(reader.take(reader.left())?);
    Ok(parts)
}
