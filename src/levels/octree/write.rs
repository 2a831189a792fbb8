//! From ranges of nodes to their records, of any kind.
//!
//! How it works: the nodes of a range begin where parting levels indicate it. Sixty-four nodes of any levels are handed
//! to a [`NodeWriter`] at a time, so that taking codes apart and dividing are SIMD instructions. Long lists of ranges
//! are shared out among threads by their points; each part knows from a count of its nodes where its records go.
//! Records of cached levels are copied.

use super::cached_levels::Cached;
use super::partings::write_beginnings;
use super::sorted_points::SortedPoints;
use crate::levels::cut::NodeRange;
use bytemuck::Zeroable;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Nodes that are computed together.
// 32 instead of 64 made no difference, 16 took 30 % longer.
pub(super) const BATCH: usize = 64;

/// Up to [`BATCH`] nodes, each property in an array of its own. Entries beyond their number are left from an earlier
/// batch, or are of no points.
pub(super) struct Nodes<'a> {
    /// Their first points.
    pub(super) firsts: &'a [u32; BATCH],
    /// The points after their last.
    pub(super) ends: &'a [u32; BATCH],
    pub(super) levels: &'a [u32; BATCH],
}

/// Computes the records of nodes.
pub(super) trait NodeWriter: Sync {
    /// Record that represents one node.
    type Record: Copy + Send + Sync + Zeroable;

    /// Writes the records of the first `out.len()` of `nodes`. To be inlined, so that it is compiled for each level of
    /// SIMD.
    fn write(&self, nodes: &Nodes<'_>, out: &mut [Self::Record]);
}

impl SortedPoints {
    /// Replaces the contents of `out` by the records of the nodes of `ranges`, in their order.
    pub(super) fn write_nodes<W: NodeWriter>(
        &self,
        ranges: &[NodeRange],
        writer: &W,
        cached: &Cached<'_, W::Record>,
        out: &mut Vec<W::Record>,
    ) {
        let pieces = self.pieces(ranges);
        if let [piece] = pieces.as_slice() {
            out.resize(self.count_nodes(piece), W::Record::zeroed());
            self.write_piece(piece, writer, cached, out);
            return;
        }
        let count = |piece: &Vec<NodeRange>| self.count_nodes(piece);
        let counts: Vec<usize> = pieces.par_iter().map(count).collect();
        out.resize(counts.iter().sum(), W::Record::zeroed());
        let mut left = out.as_mut_slice();
        let places: Vec<&mut [W::Record]> = counts.iter().filter_map(|&count| left.split_off_mut(..count)).collect();
        pieces
            .par_iter()
            .zip(places)
            .for_each(|(piece, out)| self.write_piece(piece, writer, cached, out));
    }

    /// Writes one record per node.
    fn write_piece<W: NodeWriter>(
        &self,
        piece: &[NodeRange],
        writer: &W,
        cached: &Cached<'_, W::Record>,
        out: &mut [W::Record],
    ) {
        dispatch!(Level::new(), _simd => Batch::new().write_ranges(self, piece, writer, cached, out));
    }

    /// Splits the nodes into pieces of about [`PIECE_POINTS`] points.
    fn pieces(&self, ranges: &[NodeRange]) -> Vec<Vec<NodeRange>> {
        let mut pieces = Vec::new();
        let mut piece = Vec::new();
        let mut space = PIECE_POINTS;
        for NodeRange { level, points } in ranges {
            let mut next = points.start;
            while next < points.end {
                let full = next.saturating_add(space).min(points.end);
                let end = self.next_beginning(*level, full, points.end);
                piece.push(NodeRange {
                    level: *level,
                    points: next..end,
                });
                space = space.saturating_sub(end - next);
                next = end;
                if space == 0 {
                    pieces.push(std::mem::take(&mut piece));
                    space = PIECE_POINTS;
                }
            }
        }
        if !piece.is_empty() || pieces.is_empty() {
            pieces.push(piece);
        }
        pieces
    }
}

/// Points that are worth handing to another thread.
const PIECE_POINTS: usize = 1 << 14;

/// Points whose parting levels are tested together.
const BLOCK: usize = 64;

/// Buffer capacity: the possible remainder of a batch, a block of new entries, and the slack that [`write_beginnings`]
/// needs beyond.
const CAPACITY: usize = BATCH + BLOCK + 8;

/// Nodes that wait for a batch to become full.
struct Batch {
    count: usize,
    firsts: [u32; CAPACITY],
    ends: [u32; CAPACITY],
    levels: [u32; CAPACITY],
}

impl Batch {
    #[inline(always)]
    fn new() -> Self {
        Self {
            count: 0,
            firsts: [0; CAPACITY],
            ends: [0; CAPACITY],
            levels: [0; CAPACITY],
        }
    }

    #[inline(always)]
    fn write_ranges<W: NodeWriter>(
        &mut self,
        points: &SortedPoints,
        ranges: &[NodeRange],
        writer: &W,
        cached: &Cached<'_, W::Record>,
        mut out: &mut [W::Record],
    ) {
        for nodes in ranges {
            let NodeRange { level, points: range } = nodes;
            if let Some(cached) = cached[*level as usize] {
                out = self.write(self.count, writer, out);
                let records = cached.of_nodes(nodes, points);
                let (now, left) = out.split_at_mut(records.len());
                now.copy_from_slice(records);
                out = left;
                continue;
            }
            let mut first_of_range = self.count;
            for first in range.clone().step_by(BLOCK) {
                let partings = &points.partings[first..range.end.min(first + BLOCK)];
                self.add(partings, *level, first, first_of_range);
                if self.count > BATCH {
                    out = self.write(BATCH, writer, out);
                    first_of_range = first_of_range.saturating_sub(BATCH);
                }
            }
            self.ends[self.count - 1] = range.end as u32;
        }
        self.write(self.count, writer, out);
    }

    /// Adds the nodes that begin among the points from `first` on. Where the last one ends is not known yet.
    #[inline(always)]
    fn add(&mut self, partings: &[u8], level: u32, first: usize, first_of_range: usize) {
        let before = self.count;
        let added = write_beginnings(partings, level, first as u32, &mut self.firsts[before..]);
        self.count += added;
        self.levels[before..self.count].fill(level);
        // A node ends where the next one of its range begins.
        let linked = before.max(first_of_range + 1);
        if linked < self.count + 1 {
            self.ends[linked - 1..self.count - 1].copy_from_slice(&self.firsts[linked..self.count]);
        }
    }

    /// Writes the first `count` nodes, at most a batch, and drops them; returns the remaining space.
    #[inline(always)]
    fn write<'o, W: NodeWriter>(&mut self, count: usize, writer: &W, out: &'o mut [W::Record]) -> &'o mut [W::Record] {
        let (now, left) = out.split_at_mut(count);
        if count == 0 {
            return left;
        }
        let nodes = Nodes {
            firsts: batch_of(&self.firsts),
            ends: batch_of(&self.ends),
            levels: batch_of(&self.levels),
        };
        writer.write(&nodes, now);
        for property in [&mut self.firsts, &mut self.ends, &mut self.levels] {
            // A full batch: a constant length is compiled to a few registers.
            let (written, left) = property.split_at_mut(BATCH);
            written.copy_from_slice(&left[..BATCH]);
        }
        self.count -= count;
        left
    }
}

#[inline(always)]
fn batch_of(property: &[u32; CAPACITY]) -> &[u32; BATCH] {
    property.first_chunk().expect("more than a batch")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Cube;
    use glam::Vec3;

    /// First point, end and level of every node.
    struct Names;

    impl NodeWriter for Names {
        type Record = [u32; 3];

        fn write(&self, nodes: &Nodes<'_>, out: &mut [[u32; 3]]) {
            for (node, record) in out.iter_mut().enumerate() {
                *record = [nodes.firsts[node], nodes.ends[node], nodes.levels[node]];
            }
        }
    }

    #[test]
    fn nodes_are_written_in_order_for_any_ranges_and_thread_count() {
        // A ramp of 40,000 points along a diagonal that gets sparser: cells of all sizes.
        let positions: Vec<Vec3> = (0..40_000).map(|i| Vec3::splat(i as f32 * (4e4 + i as f32))).collect();
        let cube = Cube::around(&positions).unwrap();
        let points = SortedPoints::new(&cube, &positions, &vec![[0; 4]; positions.len()]);
        let level_6: Vec<usize> = (0..40_000)
            .filter(|&point| points.partings[point] <= 6)
            .chain([40_000])
            .collect();
        // Cells of level 6, on levels 6 to 21 in turn.
        let ranges: Vec<NodeRange> = level_6
            .windows(2)
            .zip(0..)
            .map(|(ends, i)| NodeRange {
                level: 6 + i * 5 % 16,
                points: ends[0]..ends[1],
            })
            .collect();
        let whole = [NodeRange {
            level: 16,
            points: 0..40_000,
        }];
        for ranges in [&ranges[..], &whole, &[]] {
            let mut expected = Vec::new();
            for range in ranges {
                let mut first = range.points.start;
                for point in range.points.start + 1..=range.points.end {
                    let is_end = point == range.points.end || u32::from(points.partings[point]) <= range.level;
                    if is_end {
                        expected.push([first as u32, point as u32, range.level]);
                        first = point;
                    }
                }
            }
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let mut found = Vec::new();
                pool.unwrap()
                    .install(|| points.write_nodes(ranges, &Names, &Cached::default(), &mut found));
                assert!(found == expected, "{} nodes", expected.len());
            }
            assert!(ranges.len() != 1 || expected.len() > PIECE_POINTS);
        }
    }
}
