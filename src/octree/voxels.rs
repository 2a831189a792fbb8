//! What is drawn for a node, worked out from its points when it is asked for.
//!
//! How it works: the points of a node are a range in Morton order. Its cell is the upper part of the first one's code; its
//! colour the difference of two running sums over all points, divided by their number.
//!
//! When it wins: of all nodes, one view shows a third (leaves only) or less, so a frame that is played and gone never pays
//! for the others, and they need no memory. Sixty-four nodes of any levels are worked out at a time, a few nanoseconds each:
//! taking codes apart and dividing are SIMD instructions then.

use super::Octree;
use crate::cloud::VoxelRecord;
use crate::math::morton::{self, LEVELS};
use bytemuck::Zeroable;
use fearless_simd::{Level, dispatch};
use glam::Vec4;
use std::ops::Range;

/// Consecutive nodes of one level.
#[derive(Debug, Clone)]
pub(super) struct NodeRange {
    pub(super) level: u32,
    pub(super) nodes: Range<usize>,
}

/// Red, green and blue in one number, a field of 21 bits each (blue has one more).
///
/// Sums of it are taken modulo 2⁶⁴, where carries from field to field, and out of the last, do no harm: the difference of two
/// sums is right in every field as long as it has no more than [`MOST_SUMMED`] colours.
pub(super) type ColorSum = u64;

const FIELD_BITS: u32 = 21;

/// So many colours have sums that fit a field.
const MOST_SUMMED: usize = 1 << 13;

/// Colours summed before each of the points and after the last. One more than there are points.
pub(super) fn running_sums(colors: impl ExactSizeIterator<Item = [u8; 4]>) -> Vec<ColorSum> {
    let mut sums = Vec::with_capacity(colors.len() + 1);
    let mut sum: ColorSum = 0;
    sums.push(sum);
    sums.extend(colors.map(|[red, green, blue, _]| {
        let [red, green, blue] = [red, green, blue].map(ColorSum::from);
        sum = sum.wrapping_add(red | green << FIELD_BITS | blue << (2 * FIELD_BITS));
        sum
    }));
    sums
}

/// The one colour that a sum is of.
pub(super) fn color_of_sum(sum: ColorSum) -> [u8; 3] {
    [0, 1, 2].map(|field| (sum >> (field * FIELD_BITS)) as u8)
}

/// The three sums of at most [`MOST_SUMMED`] colours.
#[inline(always)]
fn fields(sum: ColorSum) -> Vec4 {
    let field = |index: u32| {
        let field = (sum >> (index * FIELD_BITS)) as u32 & ((1 << FIELD_BITS) - 1);
        // A signed conversion is one instruction.
        field as i32 as f32
    };
    Vec4::new(field(0), field(1), field(2), 0.0)
}

impl Octree {
    /// What stands for the cloud at `level`: its nodes, and the leaves above it, each level in Morton order. Empty below the
    /// deepest.
    pub fn level_voxels(&self, level: u32) -> Vec<VoxelRecord> {
        let mut voxels = Vec::new();
        if self.levels.len() > level as usize {
            let leaves_above = (0..level).flat_map(|above| self.leaves(above));
            let nodes = 0..self.levels[level as usize].node_count();
            let ranges: Vec<NodeRange> = leaves_above.chain([NodeRange { level, nodes }]).collect();
            self.write_voxels(&ranges, &mut voxels);
        }
        voxels
    }

    /// The leaves on a level that is not the deepest, one by one.
    fn leaves(&self, level: u32) -> impl Iterator<Item = NodeRange> {
        let nodes = &self.levels[level as usize];
        // Only where leaves are on several levels is there one above the deepest.
        let count = nodes.point_end.as_ref().map_or(0, |ends| ends.len());
        (0..count)
            .filter(|&node| nodes.mask(node) == 0)
            .map(move |node| NodeRange {
                level,
                nodes: node..node + 1,
            })
    }

    /// Replaces the contents of `out` by what stands for some nodes.
    pub(super) fn write_voxels(&self, ranges: &[NodeRange], out: &mut Vec<VoxelRecord>) {
        out.resize(count_nodes(ranges), VoxelRecord::zeroed());
        self.fill(ranges, out);
    }

    /// [`Octree::write_voxels`] to as many places as there are nodes.
    fn fill(&self, ranges: &[NodeRange], out: &mut [VoxelRecord]) {
        if out.len() < 2 * PARALLEL_NODES {
            dispatch!(Level::new(), _simd => Batch::new(self).write_ranges(ranges, out));
            return;
        }
        let (low_out, high_out) = out.split_at_mut(out.len() / 2);
        let (low, high) = split(ranges, low_out.len());
        rayon::join(|| self.fill(&low, low_out), || self.fill(&high, high_out));
    }

    /// Mean red, green and blue of some points. Precondition: there are some.
    #[inline(always)]
    fn mean_color(&self, first: usize, end: usize) -> Vec4 {
        let count = end - first;
        let sum = if count <= MOST_SUMMED {
            self.small_sum(first, end)
        } else {
            self.large_sum(first, end)
        };
        sum / count as i32 as f32
    }

    /// Sum over at most [`MOST_SUMMED`] points.
    #[inline(always)]
    fn small_sum(&self, first: usize, end: usize) -> Vec4 {
        let sums = &self.points.colors_before;
        fields(sums[end].wrapping_sub(sums[first]))
    }

    /// Sum over more points.
    #[cold]
    fn large_sum(&self, first: usize, end: usize) -> Vec4 {
        let mut sum = glam::DVec4::ZERO;
        for first in (first..end).step_by(MOST_SUMMED) {
            let part = self.small_sum(first, end.min(first + MOST_SUMMED));
            sum += part.as_dvec4();
        }
        sum.as_vec4()
    }
}

/// Below this, nodes are not shared out among threads.
const PARALLEL_NODES: usize = 1 << 13;

pub(super) fn count_nodes(ranges: &[NodeRange]) -> usize {
    ranges.iter().map(|range| range.nodes.len()).sum()
}

/// The first `count` nodes, and the others. Precondition: there are as many.
fn split(ranges: &[NodeRange], count: usize) -> (Vec<NodeRange>, Vec<NodeRange>) {
    let mut low = ranges.to_vec();
    let mut high = Vec::new();
    let mut beyond = count_nodes(ranges) - count;
    while let Some(last) = low.last_mut().filter(|_| beyond > 0) {
        let moved = beyond.min(last.nodes.len());
        let middle = last.nodes.end - moved;
        high.push(NodeRange {
            level: last.level,
            nodes: middle..last.nodes.end,
        });
        last.nodes.end = middle;
        if last.nodes.is_empty() {
            low.pop();
        }
        beyond -= moved;
    }
    high.reverse();
    (low, high)
}

/// Nodes that are worked out together.
const BATCH: usize = 64;

/// Some nodes, each property in an array of its own.
struct Batch<'a> {
    tree: &'a Octree,
    count: usize,
    /// Codes of the cells on the levels of the nodes.
    codes: [u64; BATCH],
    levels: [u32; BATCH],
    /// Mean colours in the lower three bytes, levels in the highest.
    colors_and_levels: [u32; BATCH],
    edges: [f32; LEVELS as usize + 1],
}

impl<'a> Batch<'a> {
    #[inline(always)]
    fn new(tree: &'a Octree) -> Self {
        Self {
            tree,
            count: 0,
            codes: [0; BATCH],
            levels: [0; BATCH],
            colors_and_levels: [0; BATCH],
            edges: std::array::from_fn(|level| tree.cube.cell_edge(level as u32)),
        }
    }

    #[inline(always)]
    fn write_ranges(&mut self, ranges: &[NodeRange], mut out: &mut [VoxelRecord]) {
        for range in ranges {
            let level = &self.tree.levels[range.level as usize];
            let first_points = &level.first_point[range.nodes.start..=range.nodes.end];
            let ends = match &level.point_end {
                Some(ends) => &ends[range.nodes.clone()],
                None => &first_points[1..],
            };
            for (&first, &end) in first_points.iter().zip(ends) {
                if self.count == BATCH {
                    out = self.write(out);
                }
                self.add(range.level, first as usize, end as usize);
            }
        }
        self.write(out);
    }

    /// Adds a node by its first point and the one after its last. Precondition: there is room.
    #[inline(always)]
    fn add(&mut self, level: u32, first: usize, end: usize) {
        self.codes[self.count] = self.tree.points.codes[first] >> (3 * (LEVELS - level));
        self.levels[self.count] = level;
        let mean = self.tree.mean_color(first, end);
        self.colors_and_levels[self.count] = rounded_bytes(mean) | level << 24;
        self.count += 1;
    }

    /// Writes what is drawn and becomes empty; the places left.
    #[inline(always)]
    fn write<'o>(&mut self, out: &'o mut [VoxelRecord]) -> &'o mut [VoxelRecord] {
        let min = self.tree.cube.min;
        // Below 2²¹; a signed conversion is one instruction.
        let mut centers = [[0.0; BATCH]; 3];
        for (axis, centers) in centers.iter_mut().enumerate() {
            for (center, &code) in centers.iter_mut().zip(&self.codes) {
                *center = morton::gather(code >> axis) as i32 as f32 + 0.5;
            }
            for (center, &level) in centers.iter_mut().zip(&self.levels) {
                *center = min[axis] + *center * self.edges[level as usize];
            }
        }
        let [x, y, z] = centers;
        let voxels: [VoxelRecord; BATCH] = std::array::from_fn(|node| {
            let [x, y, z] = [x[node], y[node], z[node]].map(f32::to_bits);
            bytemuck::cast([x, y, z, self.colors_and_levels[node]])
        });
        let (now, left) = out.split_at_mut(self.count);
        now.copy_from_slice(&voxels[..self.count]);
        self.count = 0;
        left
    }
}

/// The first three of four numbers in 0..=255, rounded, from the lowest byte up.
#[inline(always)]
fn rounded_bytes(values: Vec4) -> u32 {
    // At 2²³ the last bit of an f32 is worth 1: the sum is rounded there, and its low byte is the number.
    let [red, green, blue, _] = (values + 8_388_608.0).to_array();
    let [red, green, blue] = [red, green, blue].map(|value| value.to_bits() & 255);
    red | green << 8 | blue << 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::StopCriterion;
    use glam::Vec3;

    #[test]
    fn sums_beyond_32_bits_are_exact() {
        // One node of 17 million points: its sum of red needs 33 bits, and half of it 32.
        let count = (1 << 24) + 12_345;
        let colors: Vec<[u8; 4]> = (0..count).map(|i| [255, (i % 3) as u8, 7, 0]).collect();
        let positions = vec![Vec3::ONE; count];
        let tree = Octree::build(&positions, &colors, StopCriterion::Loss(0.0));
        assert_eq!(tree.level_voxels(0)[0].color, [255, 1, 7]);
    }

    #[test]
    fn any_split_keeps_every_node_in_order() {
        let ranges =
            [(1, 3..9), (2, 20..21), (4, 50..57)].map(|(level, nodes)| NodeRange { level, nodes });
        let nodes = |ranges: &[NodeRange]| -> Vec<(u32, usize)> {
            let nodes = ranges
                .iter()
                .flat_map(|range| range.nodes.clone().map(|node| (range.level, node)));
            nodes.collect()
        };
        for count in 0..=14 {
            let (low, high) = split(&ranges, count);
            assert_eq!(count_nodes(&low), count);
            assert_eq!([nodes(&low), nodes(&high)].concat(), nodes(&ranges));
        }
    }
}
