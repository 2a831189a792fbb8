//! Where the cells of a level begin, read off the parting levels.
//!
//! How it works: a cell of a level begins with each point whose parting level is that or less. Parting levels are below
//! 32, so eight of them, in one word, are compared by one addition: what is added lifts just those above the level into
//! the highest bit of their byte, and no carry leaves a byte. Where a cell has many points its end is searched for
//! among the points themselves instead.

use super::NodeRange;
use super::sorted_points::SortedPoints;
use super::stop::Leaves;
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// Partings compared at a time.
const WORD: usize = 8;
const HIGHEST_BITS: u64 = 0x8080_8080_8080_8080;
const LOWEST_BITS: u64 = 0x0101_0101_0101_0101;

/// The highest bit of every byte of `partings` that is at most `level`.
#[inline(always)]
fn beginnings(partings: [u8; WORD], level: u32) -> u64 {
    let lift = LOWEST_BITS * u64::from(127 - level);
    !(u64::from_le_bytes(partings) + lift) & HIGHEST_BITS
}

/// Partings looked at in registers.
const ROW: usize = 64;

/// From so many points on, the end of a cell is searched for by bisection. Each of its steps waits for memory, while
/// bytes that are read in order come by the thousand in the same time.
const SEARCHED: usize = 1 << 14;

impl SortedPoints {
    /// The end of the cell of `level` that begins with the point `first`; `end` is that of the cell above it.
    #[inline]
    pub(super) fn cell_end(&self, level: u32, first: usize, end: usize) -> usize {
        if end - first > SEARCHED {
            let cells = &self.cells[first..end];
            return first + cells.partition_point(|cell| cell.share_cell(cells[0], level));
        }
        self.next_beginning(level, first + 1, end)
    }

    /// The first of the points `first..end` with which a cell of `level` begins, or `end`.
    #[inline]
    pub(super) fn next_beginning(&self, level: u32, first: usize, end: usize) -> usize {
        let byte = level as u8;
        let mut next = first;
        // In most places nothing begins, which one look at a row tells.
        let rows = self.partings[first..end].as_chunks::<ROW>().0;
        let least = |row: &[u8; ROW]| {
            row.iter()
                .fold(u8::MAX, |least, &parting| least.min(parting))
        };
        next += ROW * rows.iter().take_while(|row| least(row) > byte).count();
        let (words, rest) = self.partings[next..end].as_chunks::<WORD>();
        for &partings in words {
            let found = beginnings(partings, level);
            if found != 0 {
                return next + found.trailing_zeros() as usize / 8;
            }
            next += WORD;
        }
        rest.iter()
            .position(|&parting| u32::from(parting) <= level)
            .map_or(end, |beyond| next + beyond)
    }

    /// The octants of a node that hold points, and the nodes they are, in Morton order. Precondition: the node is above
    /// level 21.
    #[inline]
    pub(super) fn children(&self, node: &NodeRange) -> impl Iterator<Item = (u32, NodeRange)> {
        let level = node.level + 1;
        let Range { start, end } = node.points;
        let mut next = start;
        std::iter::from_fn(move || {
            let first = next;
            if first >= end {
                return None;
            }
            next = self.cell_end(level, first, end);
            let octant = self.cells[first].octant(level);
            let points = first..next;
            Some((octant, NodeRange { level, points }))
        })
    }

    /// The occupied octants of every cell of a level above 21, in Morton order: in one pass, as a cell of the level
    /// below begins wherever one of this level does.
    pub(super) fn masks_of_level(&self, level: u32) -> Vec<u8> {
        let mut masks = Vec::with_capacity(self.occupied[level as usize]);
        let mut mask = 0;
        for (cell, &parting) in self.cells.iter().zip(&self.partings) {
            if u32::from(parting) <= level + 1 {
                if u32::from(parting) <= level && mask != 0 {
                    masks.push(mask);
                    mask = 0;
                }
                mask |= 1 << cell.octant(level + 1);
            }
        }
        if mask != 0 {
            masks.push(mask);
        }
        masks
    }

    /// Whether the node of `level` with these points is not divided.
    #[inline]
    pub(super) fn is_leaf(&self, leaves: &Leaves, level: u32, points: &Range<usize>) -> bool {
        match leaves {
            Leaves::OnLevel(_) | Leaves::InRuns(_) => leaves.only_level(points) == Some(level),
            // What one finest cell holds cannot be parted.
            Leaves::OfPoints(most) => {
                points.len() <= *most.max(&1)
                    || self.cells[points.start] == self.cells[points.end - 1]
            }
        }
    }

    /// How many cells of `level` begin among some points.
    #[inline]
    pub(super) fn count_beginnings(&self, level: u32, points: Range<usize>) -> usize {
        count_at_most(&self.partings[points], level)
    }

    /// The number of nodes that some ranges are.
    pub(super) fn count_nodes(&self, ranges: &[NodeRange]) -> usize {
        dispatch!(Level::new(), _simd => {
            let count = |range: &NodeRange| {
                count_in_lanes(&self.partings[range.points.clone()], range.level as u8)
            };
            ranges.iter().map(count).sum()
        })
    }
}

/// How many of `partings` are at most `level`.
fn count_at_most(partings: &[u8], level: u32) -> usize {
    dispatch!(Level::new(), _simd => count_in_lanes(partings, level as u8))
}

#[inline(always)]
fn count_in_lanes(partings: &[u8], level: u8) -> usize {
    // As many as a byte can count.
    let (rows, rest) = partings.as_chunks::<128>();
    let count_in_row =
        |row: &[u8]| -> u8 { row.iter().map(|&parting| u8::from(parting <= level)).sum() };
    let in_rows: usize = rows.iter().map(|row| usize::from(count_in_row(row))).sum();
    in_rows + usize::from(count_in_row(rest))
}

/// Writes the first points of the cells of `level` among the points from `first` on, whose partings are given, to the
/// beginning of `out`, and says how many there are. Precondition: room for a word more than there are partings.
#[inline(always)]
pub(super) fn write_beginnings(partings: &[u8], level: u32, first: u32, out: &mut [u32]) -> usize {
    let mut count = 0;
    let mut point = first;
    let (words, rest) = partings.as_chunks::<WORD>();
    for &word in words {
        count += write_beginnings_of_word(word, level, point, &mut out[count..]);
        point += WORD as u32;
    }
    if !rest.is_empty() {
        let mut word = [u8::MAX >> 1; WORD];
        word[..rest.len()].copy_from_slice(rest);
        count += write_beginnings_of_word(word, level, point, &mut out[count..]);
    }
    count
}

/// Not a closure, which is called twice and so would not be inlined.
#[inline(always)]
fn write_beginnings_of_word(word: [u8; WORD], level: u32, first: u32, out: &mut [u32]) -> usize {
    let set = beginning_set(word, level) as usize;
    let out: &mut [u32; WORD] = out.first_chunk_mut().expect("room for a word");
    // All are written, and those behind the ones that begin a cell are written over.
    for (out, place) in out.iter_mut().zip(PLACES_IN_WORD[set]) {
        *out = first + u32::from(place);
    }
    set.count_ones() as usize
}

/// One bit for every byte of `partings` that is at most `level`.
#[inline(always)]
fn beginning_set(partings: [u8; WORD], level: u32) -> u8 {
    // Every bit is moved to the highest byte, and no two to the same place.
    const TO_HIGHEST_BYTE: u64 = 0x0102_0408_1020_4080;
    ((beginnings(partings, level) >> 7).wrapping_mul(TO_HIGHEST_BYTE) >> 56) as u8
}

/// The places of the bits of every byte, ascending; what follows them is of no importance.
static PLACES_IN_WORD: [[u8; WORD]; 256] = {
    let mut places = [[0; WORD]; 256];
    let mut set = 0;
    while set < 256 {
        let (mut count, mut place) = (0, 0);
        while place < WORD {
            if set >> place & 1 == 1 {
                places[set][count] = place as u8;
                count += 1;
            }
            place += 1;
        }
        set += 1;
    }
    places
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::morton::LEVELS;

    #[test]
    fn words_are_compared_as_bytes_are() {
        for level in 0..=LEVELS {
            for parting in 0..=LEVELS as u8 + 1 {
                let partings = [parting, 0, 22, 1, parting, 21, 7, parting];
                let expected = (0..8)
                    .filter(|&i| u32::from(partings[i as usize]) <= level)
                    .fold(0, |bits, i| bits | 0x80u64 << (8 * i));
                assert_eq!(beginnings(partings, level), expected);
            }
        }
    }

    #[test]
    fn beginnings_and_their_number() {
        for count in [0, 1, 7, 8, 31, 32, 33, 100, 32 * 255, 32 * 255 + 9] {
            let partings: Vec<u8> = (0..count as u64)
                .map(|i| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as u8 % 23)
                .collect();
            for level in [0, 3, 12, LEVELS] {
                let expected: Vec<u32> = (0..count)
                    .filter(|&i| u32::from(partings[i as usize]) <= level)
                    .map(|i| i + 1000)
                    .collect();
                assert_eq!(count_at_most(&partings, level), expected.len());
                let mut out = vec![0; count as usize + WORD];
                let written = write_beginnings(&partings, level, 1000, &mut out);
                assert_eq!(out[..written], expected);
            }
        }
    }
}
