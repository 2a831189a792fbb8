//! The voxel of a node, computed from its points on demand.
//!
//! How it works: the points of a node are a range in Morton order. Its cell is the upper part of the first one's; its
//! colour the difference of two running sums over all points, divided by their number.
//!
//! When it wins: of all nodes, one view shows a third (leaves only) or less, so a frame that is played and gone never
//! pays for the others, and they need no memory. Of levels that are coarse enough for it, repeatedly drawn records are
//! cached (`cached_levels.rs`): reading the points of cells that have several each takes longer than copying.

use super::color_sums::{ColorSum, MAX_SUMMED, field_of};
use super::gap::Gap;
use super::gaps::add_gaps;
use super::sorted_points::SortedPoints;
use super::tree::Octree;
use super::write::{BATCH, NodeWriter, Nodes};
use crate::cloud::VoxelRecord;
use crate::levels::cut::{Cut, NodeRange};
use crate::math::morton::{LEVELS, PackedCell};
use bytemuck::Zeroable;
use glam::Vec3;

impl Octree {
    /// Returns the voxels that represent the cloud at `level`, in Morton order: its nodes, and the leaves above it.
    /// Empty below the deepest level.
    pub fn level_voxels(&self, level: u32) -> Vec<VoxelRecord> {
        let mut ranges = Vec::new();
        if self.level_counts.len() > level as usize {
            self.cut_at(level, self.root(), &mut ranges);
        }
        let mut voxels = Vec::new();
        self.write_ranges(&ranges, &mut voxels);
        voxels
    }

    /// Adds the records of `node` at `level`. Recursion is bounded by the 21 levels.
    fn cut_at(&self, level: u32, node: NodeRange, ranges: &mut Vec<NodeRange>) {
        if node.level == level || self.is_leaf(node.level, &node.points) {
            ranges.push(node);
            return;
        }
        if let Some(leaf_level) = self.leaves.only_level(&node.points) {
            ranges.push(NodeRange {
                level: level.min(leaf_level),
                points: node.points,
            });
            return;
        }
        for (_, child) in self.points.children(&node) {
            self.cut_at(level, child, ranges);
        }
    }

    /// Replaces the contents of `out` by the voxels of a cut of this tree.
    pub fn write_voxels(&self, cut: &Cut, out: &mut Vec<VoxelRecord>) {
        self.write_ranges(&cut.ranges, out);
    }

    /// Adds the voxels of gaps: cubes of their own in the colours of the adjacent leaves.
    pub fn add_gap_voxels(&self, gaps: &[Gap], out: &mut Vec<VoxelRecord>) {
        let before = out.len();
        add_gaps(gaps, &self.voxel_writer(), out);
        for (voxel, gap) in out[before..].iter_mut().zip(gaps) {
            voxel.center = self
                .cube
                .cell_center(gap.level.into(), self.cell_of_gap(gap))
                .to_array();
        }
    }

    fn voxel_writer(&self) -> VoxelWriter<'_> {
        VoxelWriter {
            points: &self.points,
            min: self.cube.min.as_vec3(),
            edge: self.cube.edge,
        }
    }

    fn write_ranges(&self, ranges: &[NodeRange], out: &mut Vec<VoxelRecord>) {
        let writer = self.voxel_writer();
        let coarse = self.points.coarse_levels().len() as u32;
        let may_be_cached = ranges.iter().filter(|range| range.level < coarse);
        let cached = self.points.voxels.cached(may_be_cached, &self.points, &writer);
        self.points.write_nodes(ranges, &writer, &cached, out);
    }
}

impl SortedPoints {
    /// The numbers of nodes of the levels whose voxels are worth keeping, from the root's on.
    pub(super) fn coarse_levels(&self) -> &[usize] {
        let is_coarse = |&count: &usize| count * POINTS_PER_CACHED_VOXEL <= self.len();
        let count = self.occupied.iter().take_while(|&count| is_coarse(count)).count();
        &self.occupied[..count]
    }
}

/// Minimum average points per node for keeping voxels: with fewer points, a voxel is computed from hardly more bytes
/// than it has.
// With 4.7 points per node (1,000,000 points, 4 px), 210,789 voxels take 0.63 ms to copy and 1.55 ms to compute.
const POINTS_PER_CACHED_VOXEL: usize = 3;

struct VoxelWriter<'a> {
    points: &'a SortedPoints,
    min: Vec3,
    /// Edge length of the root.
    edge: f32,
}

impl NodeWriter for VoxelWriter<'_> {
    type Record = VoxelRecord;

    #[inline(always)]
    fn write(&self, nodes: &Nodes<'_>, out: &mut [VoxelRecord]) {
        let count = out.len().min(BATCH);
        let (firsts, ends) = (&nodes.firsts[..count], &nodes.ends[..count]);
        let levels = &nodes.levels[..count];
        let mut gathered = Gathered::zeroed();
        self.gather(firsts, ends, &mut gathered);
        let mut edges = [0.0; BATCH];
        for (edge, &level) in edges[..count].iter_mut().zip(levels) {
            *edge = self.edge * power_of_two(-(level as i32));
        }
        let mut centers = [[0.0; BATCH]; 3];
        for (axis, centers) in centers.iter_mut().enumerate() {
            // A register holds twice as many 32-bit numbers, so the cells are split first.
            let mut finest = [0; BATCH];
            for (coordinate, cell) in finest[..count].iter_mut().zip(&gathered.cells) {
                *coordinate = cell.coordinate(axis, LEVELS);
            }
            let cells = finest.iter().zip(levels).zip(&edges);
            for (center, ((&coordinate, &level), &edge)) in centers[..count].iter_mut().zip(cells) {
                // Below 2²¹; a signed conversion is one instruction.
                let coordinate = (coordinate >> (LEVELS - level)) as i32 as f32;
                *center = self.min[axis] + (coordinate + 0.5) * edge;
            }
        }
        let mut means = [[0.0; BATCH]; 3];
        for (channel, means) in (0..).zip(&mut means) {
            let mut fields = [0; BATCH];
            for (field, &sum) in fields[..count].iter_mut().zip(&gathered.sums) {
                *field = field_of(sum, channel);
            }
            let sums = fields.iter().zip(&gathered.shares);
            for (mean, (&sum, &share)) in means[..count].iter_mut().zip(sums) {
                *mean = sum as i32 as f32 * share;
            }
        }
        if gathered.max_points > MAX_SUMMED {
            self.replace_large_means(firsts, ends, &mut means);
        }
        let ([x, y, z], [red, green, blue]) = (&centers, &means);
        for (node, (voxel, &level)) in out.iter_mut().zip(levels).enumerate() {
            *voxel = bytemuck::cast([
                x[node].to_bits(),
                y[node].to_bits(),
                z[node].to_bits(),
                rounded_byte(red[node]) | rounded_byte(green[node]) << 8 | rounded_byte(blue[node]) << 16 | level << 24,
            ]);
        }
    }
}

/// Data gathered for the nodes of a batch.
#[derive(Zeroable)]
struct Gathered {
    cells: [PackedCell; BATCH],
    /// Colours summed up.
    sums: [ColorSum; BATCH],
    /// One over the numbers of points.
    shares: [f32; BATCH],
    max_points: u32,
}

impl VoxelWriter<'_> {
    #[inline(always)]
    fn gather(&self, firsts: &[u32], ends: &[u32], gathered: &mut Gathered) {
        let before = self.points.colors_before.as_slice();
        let nodes = firsts.iter().zip(ends);
        let out = gathered.cells.iter_mut().zip(&mut gathered.sums);
        // Prefetching the two lines of each node took 15 % longer.
        for ((&first, &end), (cell, sum)) in nodes.clone().zip(out) {
            *cell = self.points.cells[first as usize];
            *sum = before[end as usize].wrapping_sub(before[first as usize]);
        }
        for ((&first, &end), share) in nodes.zip(&mut gathered.shares) {
            // One division per node; a mean halfway between two numbers may be rounded to either.
            *share = 1.0 / (end - first) as i32 as f32;
        }
        let counts = firsts.iter().zip(ends).map(|(&first, &end)| end - first);
        gathered.max_points = counts.fold(0, u32::max);
    }

    /// Mean colours of nodes whose sums do not fit a field.
    #[cold]
    fn replace_large_means(&self, firsts: &[u32], ends: &[u32], means: &mut [[f32; BATCH]; 3]) {
        let before = &self.points.colors_before;
        for (node, (&first, &end)) in firsts.iter().zip(ends).enumerate() {
            if end - first <= MAX_SUMMED {
                continue;
            }
            for (channel, means) in (0..).zip(&mut *means) {
                let sum: f64 = (first..end)
                    .step_by(MAX_SUMMED as usize)
                    .map(|first| {
                        let end = end.min(first + MAX_SUMMED);
                        let sum = before[end as usize].wrapping_sub(before[first as usize]);
                        f64::from(field_of(sum, channel))
                    })
                    .sum();
                means[node] = (sum / f64::from(end - first)) as f32;
            }
        }
    }
}

/// Returns the power of two with an exponent from −126 to 127.
#[inline(always)]
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
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
    use crate::levels::octree::StopCriterion;

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
