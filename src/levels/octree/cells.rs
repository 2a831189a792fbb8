//! Cell boundaries of a level, read off the parting levels (`partings.rs`). If a cell has many points, its end is
//! searched for among the points themselves instead.

use super::partings::{WORD, beginnings, count_at_most, count_in_lanes};
use super::sorted_points::SortedPoints;
use super::stop::Leaves;
use crate::levels::cut::NodeRange;
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// Partings tested in registers.
const ROW: usize = 64;

/// From this many points on, the end of a cell is searched for by bisection. Each of its steps waits for memory, while
/// bytes that are read in order come by the thousand in the same time.
// Bisection alone took 40 % of a cut; rows first, and bisection from here on, took a cut from 3.3 to 2.1 ms.
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
        // In most rows no cell begins, which a single pass over a row shows.
        let rows = self.partings[first..end].as_chunks::<ROW>().0;
        let min = |row: &[u8; ROW]| row.iter().fold(u8::MAX, |min, &parting| min.min(parting));
        next += ROW * rows.iter().take_while(|row| min(row) > byte).count();
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

    /// Returns true if the node of `level` with these points is a leaf, i.e. not divided.
    #[inline]
    pub(super) fn is_leaf(&self, leaves: &Leaves, level: u32, points: &Range<usize>) -> bool {
        match leaves {
            Leaves::OnLevel(_) | Leaves::InRuns(_) => leaves.only_level(points) == Some(level),
            // The contents of one finest cell cannot be separated.
            Leaves::OfPoints(max) => {
                points.len() <= *max.max(&1) || self.cells[points.start] == self.cells[points.end - 1]
            }
        }
    }

    /// Counts the cells of `level` that begin among the given points.
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
