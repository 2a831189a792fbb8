//! The voxel of a node, worked out from its points when it is asked for.
//!
//! How it works: the points of a node are a range in Morton order. Its cell is the upper part of the first one's; its
//! colour the difference of two running sums over all points, divided by their number.
//!
//! When it wins: of all nodes, one view shows a third (leaves only) or less, so a frame that is played and gone never pays
//! for the others, and they need no memory.

use super::sorted_points::SortedPoints;
use super::write::{BATCH, NodeWriter, Nodes};
use super::{NodeRange, Octree, stop::Leaves};
use crate::cloud::VoxelRecord;
use crate::math::morton::{LEVELS, PackedCell};
use bytemuck::Zeroable;
use glam::Vec3;

/// Red, green and blue in one number, a field of 21 bits each (blue has one more).
///
/// Sums of it are taken modulo 2⁶⁴, where carries from field to field, and out of the last, do no harm: the difference of two
/// sums is right in every field as long as it has no more than [`MOST_SUMMED`] colours.
pub(super) type ColorSum = u64;

const FIELD_BITS: u32 = 21;

/// So many colours have sums that fit a field.
const MOST_SUMMED: u32 = 1 << 13;

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

/// One channel of the sum of at most [`MOST_SUMMED`] colours.
#[inline(always)]
fn channel_of(sum: ColorSum, channel: u32) -> f32 {
    let field = (sum >> (channel * FIELD_BITS)) as u32 & ((1 << FIELD_BITS) - 1);
    // A signed conversion is one instruction.
    field as i32 as f32
}

impl Octree {
    /// What stands for the cloud at `level`, in Morton order: its nodes, and the leaves above it. Empty below the deepest.
    pub fn level_voxels(&self, level: u32) -> Vec<VoxelRecord> {
        let mut ranges = Vec::new();
        if self.level_counts.len() > level as usize {
            let root = NodeRange {
                level: 0,
                points: self.all_points(),
            };
            self.cut_at(level, root, &mut ranges);
        }
        let mut voxels = Vec::new();
        self.write_voxels(&ranges, &mut voxels);
        voxels
    }

    /// Adds what stands for `node` at `level`. Recursion is bounded by the 21 levels.
    fn cut_at(&self, level: u32, node: NodeRange, ranges: &mut Vec<NodeRange>) {
        if node.level == level || self.is_leaf(node.level, &node.points) {
            ranges.push(node);
            return;
        }
        if let Leaves::OnLevel(_) = self.leaves {
            let points = node.points;
            ranges.push(NodeRange { level, points });
            return;
        }
        for (_, child) in self.points.children(&node) {
            self.cut_at(level, child, ranges);
        }
    }

    /// Replaces the contents of `out` by the voxels of some nodes.
    pub(super) fn write_voxels(&self, ranges: &[NodeRange], out: &mut Vec<VoxelRecord>) {
        let writer = VoxelWriter {
            points: &self.points,
            min: self.cube.min,
            edges: std::array::from_fn(|level| self.cube.cell_edge(level as u32)),
        };
        self.points.write_nodes(ranges, &writer, out);
    }
}

struct VoxelWriter<'a> {
    points: &'a SortedPoints,
    min: Vec3,
    edges: [f32; LEVELS as usize + 1],
}

impl NodeWriter for VoxelWriter<'_> {
    type Record = VoxelRecord;

    #[inline(always)]
    fn write(&self, nodes: &Nodes<'_>, out: &mut [VoxelRecord]) {
        let [x, y, z] = self.centers(nodes);
        let colors_and_levels = self.colors_and_levels(nodes);
        let centers = x.iter().zip(&y).zip(&z);
        for ((voxel, ((x, y), z)), &color_and_level) in
            out.iter_mut().zip(centers).zip(&colors_and_levels)
        {
            *voxel = bytemuck::cast([x.to_bits(), y.to_bits(), z.to_bits(), color_and_level]);
        }
    }
}

impl VoxelWriter<'_> {
    /// The middles of the cells, an axis each.
    #[inline(always)]
    fn centers(&self, nodes: &Nodes<'_>) -> [[f32; BATCH]; 3] {
        let mut cells = [PackedCell::zeroed(); BATCH];
        let mut edges = [0.0; BATCH];
        for node in 0..BATCH {
            cells[node] = self.points.cells[nodes.firsts[node] as usize];
            edges[node] = self.edges[nodes.levels[node] as usize];
        }
        let mut centers = [[0.0; BATCH]; 3];
        for (axis, centers) in centers.iter_mut().enumerate() {
            for node in 0..BATCH {
                // Below 2²¹; a signed conversion is one instruction.
                let coordinate = cells[node].coordinate(axis, nodes.levels[node]) as i32 as f32;
                centers[node] = self.min[axis] + (coordinate + 0.5) * edges[node];
            }
        }
        centers
    }

    /// Mean colours in the lower three bytes, levels in the highest.
    #[inline(always)]
    fn colors_and_levels(&self, nodes: &Nodes<'_>) -> [u32; BATCH] {
        let before = &self.points.colors_before;
        let mut sums = [0; BATCH];
        let mut counts = [0.0; BATCH];
        let mut most = 0;
        for node in 0..BATCH {
            let (first, end) = (nodes.firsts[node], nodes.ends[node]);
            sums[node] = before[end as usize].wrapping_sub(before[first as usize]);
            let count = end.wrapping_sub(first);
            counts[node] = count as i32 as f32;
            most = most.max(count);
        }
        // One division a node; a mean halfway between two numbers may be rounded to either.
        let shares = counts.map(|count| 1.0 / count);
        let mut means = [[0.0; BATCH]; 3];
        for (channel, means) in (0..).zip(&mut means) {
            for ((mean, &sum), &share) in means.iter_mut().zip(&sums).zip(&shares) {
                *mean = channel_of(sum, channel) * share;
            }
        }
        if most > MOST_SUMMED {
            self.replace_large_means(nodes, &mut means);
        }
        let mut packed = nodes.levels.map(|level| level << 24);
        for (channel, means) in (0..).zip(&means) {
            for (packed, &mean) in packed.iter_mut().zip(means) {
                *packed |= rounded_byte(mean) << (8 * channel);
            }
        }
        packed
    }

    /// Mean colours of nodes whose sums do not fit a field.
    #[cold]
    fn replace_large_means(&self, nodes: &Nodes<'_>, means: &mut [[f32; BATCH]; 3]) {
        for node in 0..BATCH {
            let (first, end) = (nodes.firsts[node], nodes.ends[node]);
            if end.wrapping_sub(first) <= MOST_SUMMED || end < first {
                continue;
            }
            for (channel, means) in (0..).zip(&mut *means) {
                let sum: f64 = (first..end)
                    .step_by(MOST_SUMMED as usize)
                    .map(|first| {
                        let end = end.min(first + MOST_SUMMED) as usize;
                        let before = &self.points.colors_before;
                        let sum = before[end].wrapping_sub(before[first as usize]);
                        f64::from(channel_of(sum, channel))
                    })
                    .sum();
                means[node] = (sum / f64::from(end - first)) as f32;
            }
        }
    }
}

/// A number in 0..=255, rounded.
#[inline(always)]
fn rounded_byte(value: f32) -> u32 {
    // At 2²³ the last bit of an f32 is worth 1: the sum is rounded there, and its low byte is the number.
    (value + 8_388_608.0).to_bits() & 255
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::StopCriterion;

    #[test]
    fn sums_beyond_32_bits_are_exact() {
        // One node of 17 million points: its sum of red needs 33 bits, and half of it 32.
        let count = (1 << 24) + 12_345;
        let colors: Vec<[u8; 4]> = (0..count).map(|i| [255, (i % 3) as u8, 7, 0]).collect();
        let positions = vec![Vec3::ONE; count];
        let tree = Octree::build(&positions, &colors, StopCriterion::Loss(0.0));
        assert_eq!(tree.level_voxels(0)[0].color, [255, 1, 7]);
    }
}
