//! Building an octree from sorted Morton codes (paper 000 §VI-A).
//!
//! How it works:
//! 1. Points become 63-bit Morton codes, which are sorted. The points of any cell of any level now stand together.
//! 2. For each code the level at which it *parts* from the one before it is noted: it is the first point of its cell there
//!    and on every deeper level. A histogram of these levels, summed up, counts the occupied cells of every level,
//!    so one scan answers the stop criterion for all depths, and says where each level begins in the breadth-first array.
//! 3. The leaves are the points that part at the leaf level or above. Each coarser level follows from the finer one in the
//!    same way: the nodes that part at this level or above begin a new parent. Colours are added up as it goes.
//! 4. Steps like 3 stream through memory once for each level. So they are taken for a *block* of a thousand points at a
//!    time, made of whole cells of some middle level: all levels of a block stay in the nearest cache. What is above the
//!    middle level is little, and done at the end.
//!
//! When it wins: no node is searched for, allocated or visited twice, and each level is written in ascending order. Inner
//! loops select instead of branching: whether a node is the first child of its parent is a coin toss that a branch
//! predictor loses.

use super::{Cube, Octree, StopCriterion, stop::OccupiedCells};
use crate::{
    cloud::VoxelRecord,
    math::{
        morton::{self, LEVELS},
        sort_codes,
    },
};
use glam::{BVec4A, Vec3, Vec4};
use std::ops::Range;

impl Octree {
    /// Builds the octree of `positions` down to the level that `stop` asks for.
    ///
    /// Colours are averaged per cell on every level. No points make an octree without nodes; one point, or points that all
    /// coincide, a root that is a leaf. The answer depends on the arguments alone.
    ///
    /// # Panics
    /// Preconditions: finite positions, one colour a point, at most 2³¹ points.
    pub fn build(positions: &[Vec3], colors: &[[u8; 4]], stop: StopCriterion) -> Self {
        assert_eq!(positions.len(), colors.len(), "one colour for each point");
        let Some(cube) = Cube::around(positions) else {
            return Self {
                cube: Cube::EMPTY,
                point_count: 0,
                level_counts: Vec::new(),
                masks: Vec::new(),
                first_child: Vec::new(),
                voxels: Vec::new(),
            };
        };
        let sorted = sort_codes(&cube.codes(positions));
        let partings = parting_levels(&sorted.codes);
        let occupied = occupied_cells(&partings);
        let depth = stop.depth(&occupied, positions.len());
        let colors: Vec<[u8; 4]> = sorted
            .order
            .iter()
            .map(|&index| colors[index as usize])
            .collect();

        let mut writer = LevelWriter::new(cube, depth, positions.len(), &occupied);
        let middle = middle_level(&occupied, depth, positions.len());
        let mut roots = LevelNodes::default();
        let mut nodes = LevelNodes::default();
        for block in blocks(&partings, middle) {
            nodes.set_leaves(
                depth,
                &sorted.codes[block.clone()],
                &partings[block.clone()],
                &colors[block],
            );
            writer.write_voxels(depth, &nodes);
            writer.write_levels(middle..depth, &mut nodes);
            roots.append(&nodes);
        }
        writer.write_levels(0..middle, &mut roots);
        writer.tree
    }
}

/// The level at which each sorted code parts from the one before it; 0 for the first.
fn parting_levels(codes: &[u64]) -> Vec<u8> {
    let first = codes.first().map(|_| 0);
    first
        .into_iter()
        .chain(
            codes
                .windows(2)
                .map(|pair| morton::parting_level(pair[0], pair[1])),
        )
        .collect()
}

/// Cells of every level that hold a point: one for each code that parted there or above.
fn occupied_cells(partings: &[u8]) -> OccupiedCells {
    let mut parted = [0usize; LEVELS as usize + 2];
    for &level in partings {
        parted[level as usize] += 1;
    }
    let mut total = 0;
    std::array::from_fn(|level| {
        total += parted[level];
        total
    })
}

/// Points that a block should have: all its levels together take 100 KiB at most.
const BLOCK_POINTS: usize = 1024;

/// The deepest level whose cells still hold half a block on average.
fn middle_level(occupied: &OccupiedCells, depth: u32, point_count: usize) -> u32 {
    (0..=depth)
        .rev()
        .find(|&level| occupied[level as usize] * BLOCK_POINTS / 2 <= point_count)
        .unwrap_or(0)
}

/// Ranges of points that are whole cells of `level`, each as short as it can be with at least [`BLOCK_POINTS`].
fn blocks(partings: &[u8], level: u32) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        if start == partings.len() {
            return None;
        }
        let least = (start + BLOCK_POINTS).min(partings.len());
        let end = partings[least..]
            .iter()
            .position(|&parting| u32::from(parting) <= level)
            .map_or(partings.len(), |beyond| least + beyond);
        Some(std::mem::replace(&mut start, end)..end)
    })
}

/// Some nodes of one level, in Morton order.
#[derive(Debug, Default)]
struct LevelNodes {
    /// Integer coordinates of the cell on its level. The last lane is zero and makes this one SIMD register.
    cells: Vec<[u32; 4]>,
    /// Level at which the node parts from the one before it.
    partings: Vec<u8>,
    /// Red, green, blue and the number of points, summed over the points inside: exact up to 2¹⁶ points a cell, then
    /// rounded to 24 bits.
    sums: Vec<Vec4>,
    /// While merging: the first child of each parent, and what the sums will be.
    starts: Vec<u32>,
    parent_sums: Vec<Vec4>,
}

impl LevelNodes {
    fn resize(&mut self, count: usize) {
        self.cells.resize(count, [0; 4]);
        self.partings.resize(count, 0);
        self.sums.resize(count, Vec4::ZERO);
    }

    fn append(&mut self, other: &Self) {
        self.cells.extend_from_slice(&other.cells);
        self.partings.extend_from_slice(&other.partings);
        self.sums.extend_from_slice(&other.sums);
    }

    /// Becomes the occupied cells of `level`, from sorted points.
    fn set_leaves(&mut self, level: u32, codes: &[u64], partings: &[u8], colors: &[[u8; 4]]) {
        self.resize(codes.len());
        let shift = 3 * (LEVELS - level);
        let mut count = 0;
        // In integers: f32 cannot add more than 2¹⁶ points one by one without rounding each.
        let mut sum = [0u64; 4];
        for ((&code, &parting), &[red, green, blue, _]) in codes.iter().zip(partings).zip(colors) {
            if u32::from(parting) <= level {
                let [x, y, z] = morton::decode(code >> shift);
                self.cells[count] = [x, y, z, 0];
                self.partings[count] = parting;
                count += 1;
                sum = [0; 4];
            }
            for (sum, add) in sum.iter_mut().zip([red, green, blue, 1]) {
                *sum += u64::from(add);
            }
            // Below 2⁶³, so that a signed conversion, which is one instruction, is exact.
            self.sums[count - 1] = Vec4::from_array(sum.map(|sum| sum as i64 as f32));
        }
        self.resize(count);
    }

    /// Replaces the nodes by their parents on `level`, and writes the masks of these and the numbers of their first
    /// children, counted from `next_child`.
    fn merge_into_parents(
        &mut self,
        level: u32,
        next_child: u32,
        masks: &mut [u8],
        first_child: &mut [u32],
    ) {
        // Three loops over few arrays each: one over all of them would run out of registers.
        self.starts.resize(self.partings.len(), 0);
        let mut parents = 0;
        for (&parting, child) in self.partings.iter().zip(0u32..) {
            // Overwritten until a child that begins a parent moves on.
            self.starts[parents] = child;
            parents += usize::from(u32::from(parting) <= level);
        }
        let masks = &mut masks[..parents];
        let mut parent = 0;
        let mut mask = 0;
        let mut sum = Vec4::ZERO;
        self.parent_sums.resize(parents, Vec4::ZERO);
        for ((&parting, &cell), &child_sum) in self.partings.iter().zip(&self.cells).zip(&self.sums)
        {
            let is_first = u32::from(parting) <= level;
            parent += usize::from(is_first);
            mask = if is_first { 0 } else { mask } | 1 << octant(cell);
            sum = Vec4::select(BVec4A::splat(is_first), Vec4::ZERO, sum) + child_sum;
            // Written for every child: the last one leaves what is right. The first child of all begins a parent.
            masks[parent - 1] = mask;
            self.parent_sums[parent - 1] = sum;
        }
        std::mem::swap(&mut self.sums, &mut self.parent_sums);
        for ((parent, &start), first_child) in
            self.starts[..parents].iter().enumerate().zip(first_child)
        {
            *first_child = next_child + start;
            self.cells[parent] = self.cells[start as usize].map(|coordinate| coordinate >> 1);
            self.partings[parent] = self.partings[start as usize];
        }
        self.resize(parents);
    }
}

/// The octant of a cell in its parent: the lowest bits of its coordinates, moved to where signs are to be picked up.
fn octant(cell: [u32; 4]) -> u32 {
    Vec4::from_array(cell.map(|coordinate| f32::from_bits(coordinate << 31))).is_negative_bitmask()
}

/// A tree whose levels are being filled, each from its beginning.
struct LevelWriter {
    tree: Octree,
    /// Number of the next node of each level.
    next: [usize; LEVELS as usize + 1],
}

impl LevelWriter {
    fn new(cube: Cube, depth: u32, point_count: usize, occupied: &OccupiedCells) -> Self {
        let level_counts = occupied[..=depth as usize].to_vec();
        let node_count: usize = level_counts.iter().sum();
        let internal_count = node_count - occupied[depth as usize];
        let mut first_child = vec![0; internal_count + 1];
        first_child[internal_count] = node_count as u32;
        let mut end = 0;
        Self {
            tree: Octree {
                cube,
                point_count,
                level_counts,
                masks: vec![0; internal_count],
                first_child,
                voxels: vec![bytemuck::Zeroable::zeroed(); node_count],
            },
            next: occupied.map(|count| {
                end += count;
                end - count
            }),
        }
    }

    /// Merges nodes of the level `levels.end`, written already, up to the level `levels.start`, writing each.
    fn write_levels(&mut self, levels: Range<u32>, nodes: &mut LevelNodes) {
        for level in levels.rev() {
            let below = self.next[level as usize + 1] - nodes.partings.len();
            let first = self.next[level as usize];
            nodes.merge_into_parents(
                level,
                below as u32,
                &mut self.tree.masks[first..],
                &mut self.tree.first_child[first..],
            );
            self.write_voxels(level, nodes);
        }
    }

    /// Writes what is drawn for each node, and moves on.
    fn write_voxels(&mut self, level: u32, nodes: &LevelNodes) {
        let next = &mut self.next[level as usize];
        let voxels = &mut self.tree.voxels[*next..*next + nodes.cells.len()];
        *next += voxels.len();
        let edge = self.tree.cube.cell_edge(level);
        let min = self.tree.cube.min.extend(0.0);
        for ((voxel, &cell), &sum) in voxels.iter_mut().zip(&nodes.cells).zip(&nodes.sums) {
            // Below 2²¹, so that a signed conversion, which is one instruction, is exact.
            let cell = Vec4::from_array(cell.map(|coordinate| coordinate as i32 as f32));
            let [x, y, z, _] = (min + (cell + 0.5) * edge).to_array();
            *voxel = VoxelRecord {
                center: [x, y, z],
                color: rounded_bytes(sum / sum.w),
                level: level as u8,
            };
        }
    }
}

/// The first three of four numbers in 0..=255, rounded.
fn rounded_bytes(values: Vec4) -> [u8; 3] {
    // At 2²³ the last bit of an f32 is worth 1: the sum is rounded there, and its low byte is the number.
    let [red, green, blue, _] = (values + 8_388_608.0).to_array();
    [red, green, blue].map(|value| value.to_bits() as u8)
}
