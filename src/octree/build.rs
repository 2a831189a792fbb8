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
//! Halves of a large cloud are written by two threads: the scan of step 2 over one half tells where the other's nodes begin.
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
use rayon::prelude::*;

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
            .par_iter()
            .with_min_len(PARALLEL_POINTS)
            .map(|&index| colors[index as usize])
            .collect();
        let points = SortedPoints {
            codes: &sorted.codes,
            partings: &partings,
            colors: &colors,
        };

        let mut tree =
            Self::with_levels(cube, positions.len(), occupied[..=depth as usize].to_vec());
        let middle = middle_level(&occupied, depth, positions.len());
        let mut upper = LevelWriter::new(&mut tree);
        let lower = upper.split_off(middle);
        let first_root = lower.levels[0].next;
        let mut roots = lower.write_points(points);
        upper.write_parents(first_root, &mut roots);
        tree
    }

    /// A tree of this shape with nothing written yet.
    fn with_levels(cube: Cube, point_count: usize, level_counts: Vec<usize>) -> Self {
        let node_count: usize = level_counts.iter().sum();
        let internal_count = node_count - level_counts.last().copied().unwrap_or(0);
        let mut first_child = vec![0; internal_count + 1];
        first_child[internal_count] = node_count as u32;
        Self {
            cube,
            point_count,
            level_counts,
            masks: vec![0; internal_count],
            first_child,
            voxels: vec![bytemuck::Zeroable::zeroed(); node_count],
        }
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

/// Below this, points are not shared out among threads.
const PARALLEL_POINTS: usize = 16 * BLOCK_POINTS;

/// A run of points in Morton order.
#[derive(Debug, Clone, Copy)]
struct SortedPoints<'a> {
    codes: &'a [u64],
    partings: &'a [u8],
    colors: &'a [[u8; 4]],
}

impl SortedPoints<'_> {
    fn len(&self) -> usize {
        self.codes.len()
    }

    /// Two runs, of which the first ends with a cell of `level` and has at least `least` points, if there are that many.
    fn split_after(&self, least: usize, level: u32) -> (Self, Self) {
        let least = least.min(self.len());
        let place = self.partings[least..]
            .iter()
            .position(|&parting| u32::from(parting) <= level)
            .map_or(self.len(), |beyond| least + beyond);
        let (codes, later_codes) = self.codes.split_at(place);
        let (partings, later_partings) = self.partings.split_at(place);
        let (colors, later_colors) = self.colors.split_at(place);
        let later = Self {
            codes: later_codes,
            partings: later_partings,
            colors: later_colors,
        };
        (
            Self {
                codes,
                partings,
                colors,
            },
            later,
        )
    }
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
    fn len(&self) -> usize {
        self.partings.len()
    }

    /// How many cells of `level` begin with one of the nodes.
    fn count_begun(&self, level: u32) -> usize {
        self.partings
            .iter()
            .filter(|&&parting| u32::from(parting) <= level)
            .count()
    }

    /// Writes what is drawn for each node of `level`.
    fn write_voxels(&self, cube: &Cube, level: u32, voxels: &mut [VoxelRecord]) {
        let edge = cube.cell_edge(level);
        let min = cube.min.extend(0.0);
        for ((voxel, &cell), &sum) in voxels.iter_mut().zip(&self.cells).zip(&self.sums) {
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
    fn set_leaves(&mut self, level: u32, points: SortedPoints<'_>) {
        self.resize(points.len());
        let shift = 3 * (LEVELS - level);
        let mut count = 0;
        let mut sum = [0; 4];
        let colored = points.partings.iter().zip(points.colors);
        for (&code, (&parting, &[red, green, blue, _])) in points.codes.iter().zip(colored) {
            if u32::from(parting) <= level {
                let [x, y, z] = morton::decode(code >> shift);
                self.cells[count] = [x, y, z, 0];
                self.partings[count] = parting;
                count += 1;
                sum = [0; 4];
            }
            if sum[3] < MOST_SUMMED {
                for (sum, add) in sum.iter_mut().zip([red, green, blue, 1]) {
                    *sum += i32::from(add);
                }
            }
            self.sums[count - 1] = Vec4::from_array(sum.map(|sum| sum as f32));
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

/// Points of one leaf whose colours are averaged: as many as can be summed in 31 bits. (The others would not be seen.)
const MOST_SUMMED: i32 = 1 << 23;

/// The octant of a cell in its parent: the lowest bits of its coordinates, moved to where signs are to be picked up.
fn octant(cell: [u32; 4]) -> u32 {
    Vec4::from_array(cell.map(|coordinate| f32::from_bits(coordinate << 31))).is_negative_bitmask()
}

/// Consecutive nodes of one level that are still to be written. Masks and children are empty for leaves.
#[derive(Debug)]
struct LevelPart<'a> {
    /// Number of the first of them.
    next: u32,
    masks: &'a mut [u8],
    first_child: &'a mut [u32],
    voxels: &'a mut [VoxelRecord],
}

impl<'a> LevelPart<'a> {
    /// Takes the first `count` nodes away.
    fn take(&mut self, count: usize) -> LevelPart<'a> {
        let internal = count.min(self.masks.len());
        let taken = LevelPart {
            next: self.next,
            masks: self.masks.split_off_mut(..internal).unwrap_or_default(),
            first_child: self
                .first_child
                .split_off_mut(..internal)
                .unwrap_or_default(),
            voxels: self.voxels.split_off_mut(..count).unwrap_or_default(),
        };
        self.next += count as u32;
        taken
    }
}

/// Fills some nodes of some consecutive levels, each from its beginning.
#[derive(Debug)]
struct LevelWriter<'a> {
    cube: Cube,
    /// Level of the first of `levels`.
    top: u32,
    levels: Vec<LevelPart<'a>>,
}

impl<'a> LevelWriter<'a> {
    fn new(tree: &'a mut Octree) -> Self {
        let internal_count = tree.masks.len();
        let mut rest = LevelPart {
            next: 0,
            masks: &mut tree.masks,
            first_child: &mut tree.first_child[..internal_count],
            voxels: &mut tree.voxels,
        };
        Self {
            cube: tree.cube,
            top: 0,
            levels: tree
                .level_counts
                .iter()
                .map(|&count| rest.take(count))
                .collect(),
        }
    }

    /// Keeps the levels above `level`; the writer of the others.
    fn split_off(&mut self, level: u32) -> Self {
        Self {
            cube: self.cube,
            top: level,
            levels: self.levels.split_off((level - self.top) as usize),
        }
    }

    /// Keeps all but the first nodes of each level, as many as `points` begin; the writer of these.
    fn split_points(&mut self, points: SortedPoints<'_>) -> Self {
        let begun = occupied_cells(points.partings);
        let levels = self.levels.iter_mut().zip(&begun[self.top as usize..]);
        Self {
            cube: self.cube,
            top: self.top,
            levels: levels.map(|(part, &count)| part.take(count)).collect(),
        }
    }

    /// Writes the nodes of points that are whole cells of the top level; these cells.
    fn write_points(mut self, points: SortedPoints<'_>) -> LevelNodes {
        if points.len() >= 2 * PARALLEL_POINTS {
            let (low, high) = points.split_after(points.len() / 2, self.top);
            if high.len() > 0 {
                let low_writer = self.split_points(low);
                let (mut roots, high_roots) =
                    rayon::join(|| low_writer.write_points(low), || self.write_points(high));
                roots.append(&high_roots);
                return roots;
            }
        }
        let leaf_level = self.top + self.levels.len() as u32 - 1;
        let mut roots = LevelNodes::default();
        let mut nodes = LevelNodes::default();
        let mut rest = points;
        while rest.len() > 0 {
            let block;
            (block, rest) = rest.split_after(BLOCK_POINTS, self.top);
            nodes.set_leaves(leaf_level, block);
            let leaves = self.take(leaf_level, nodes.len());
            nodes.write_voxels(&self.cube, leaf_level, leaves.voxels);
            self.merge_up(leaf_level, leaves.next, &mut nodes);
            roots.append(&nodes);
        }
        roots
    }

    /// Writes all levels above `nodes`, whose first is number `first_node`.
    fn write_parents(mut self, first_node: u32, nodes: &mut LevelNodes) {
        self.merge_up(self.top + self.levels.len() as u32, first_node, nodes);
    }

    /// Merges nodes of `level`, written already, up to the top level, writing each on the way.
    fn merge_up(&mut self, level: u32, mut first_node: u32, nodes: &mut LevelNodes) {
        for level in (self.top..level).rev() {
            let count = nodes.count_begun(level);
            let parents = self.take(level, count);
            nodes.merge_into_parents(level, first_node, parents.masks, parents.first_child);
            nodes.write_voxels(&self.cube, level, parents.voxels);
            first_node = parents.next;
        }
    }

    fn take(&mut self, level: u32, count: usize) -> LevelPart<'a> {
        self.levels[(level - self.top) as usize].take(count)
    }
}

/// The first three of four numbers in 0..=255, rounded.
fn rounded_bytes(values: Vec4) -> [u8; 3] {
    // At 2²³ the last bit of an f32 is worth 1: the sum is rounded there, and its low byte is the number.
    let [red, green, blue, _] = (values + 8_388_608.0).to_array();
    [red, green, blue].map(|value| value.to_bits() as u8)
}
