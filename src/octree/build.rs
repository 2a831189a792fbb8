//! Building an octree from sorted Morton codes (paper 000 §VI-A).
//!
//! How it works:
//! 1. Points become 63-bit Morton codes, which are sorted. The points of any cell of any level now stand together.
//! 2. For each code the level at which it *parts* from the one before it is noted: it is the first point of its cell there
//!    and on every deeper level. A histogram of these levels, summed up, counts the occupied cells of every level,
//!    so one scan answers the stop criterion for all depths, and says where each level begins in the breadth-first array.
//! 3. One walk over the points writes all levels at once. Where a code parts at level p, the nodes of the levels from the
//!    leaves up to p are complete: each is written behind the last one of its level and adds its colours to its parent.
//!    Then as many new nodes are opened. What is in the making is one node a level, which stays in the nearest cache.
//!
//! Halves of a large cloud are walked by two threads: the scan of step 2 over one half tells where the other's nodes
//! begin. They cut it between cells of some *middle* level; what is above that is little, and a walk over these cells
//! instead of points.
//!
//! When it wins: no node is searched for, allocated or visited twice, and each level is written in ascending order.

use super::{Cube, Octree, StopCriterion, stop::OccupiedCells};
use crate::{
    cloud::VoxelRecord,
    math::{
        morton::{self, LEVELS},
        sort_codes,
    },
};
use fearless_simd::{Level, dispatch};
use glam::{Vec3, Vec4};
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
        let mut upper = LevelWriter::new(&mut tree);
        if positions.len() < 2 * PARALLEL_POINTS || rayon::current_num_threads() == 1 {
            upper.write_points(points);
        } else {
            let lower = upper.split_off(middle_level(&occupied, depth, positions.len()));
            let first_root = lower.levels[0].first;
            upper.write_above(&lower.share_points(points), first_root);
        }
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
            // Zero pages of the system; a vector of records would be filled with zeros.
            voxels: bytemuck::zeroed_vec(node_count),
        }
    }
}

/// The level at which each sorted code parts from the one before it; 0 for the first.
fn parting_levels(codes: &[u64]) -> Vec<u8> {
    let mut partings = vec![0; codes.len()];
    dispatch!(Level::new(), _simd => write_partings(codes, &mut partings));
    partings
}

#[inline(always)]
fn write_partings(codes: &[u64], partings: &mut [u8]) {
    for (pair, parting) in codes.windows(2).zip(partings.iter_mut().skip(1)) {
        *parting = morton::parting_level(pair[0], pair[1]);
    }
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

/// Below this, points are not shared out among threads.
const PARALLEL_POINTS: usize = 1 << 14;

/// Points that a cell of the middle level should hold: small against what a thread takes, and many for one cell.
const MIDDLE_POINTS: usize = 512;

/// The deepest level whose cells still hold that many on average.
fn middle_level(occupied: &OccupiedCells, depth: u32, point_count: usize) -> u32 {
    (0..=depth)
        .rev()
        .find(|&level| occupied[level as usize] * MIDDLE_POINTS <= point_count)
        .unwrap_or(0)
}

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

/// Points of one leaf whose colours are averaged: as many as can be summed in 31 bits. (The others would not be seen.)
const MOST_SUMMED: i32 = 1 << 23;

/// A node whose points are not all known yet.
#[derive(Debug, Clone, Copy)]
struct OpenNode {
    /// Red, green, blue and the number of points, summed over what is complete: exact up to 2¹⁶ points, then rounded to
    /// 24 bits.
    sum: Vec4,
    mask: u8,
}

/// A node of the middle level, written already, for its ancestors.
#[derive(Debug, Clone, Copy)]
struct Root {
    code: u64,
    parting: u8,
    sum: Vec4,
}

/// Consecutive nodes of one level, to be written in order. Masks and children are empty for leaves.
#[derive(Debug)]
struct LevelPart<'a> {
    /// Number of the first of them.
    first: u32,
    /// How many are written.
    written: usize,
    masks: &'a mut [u8],
    first_child: &'a mut [u32],
    voxels: &'a mut [VoxelRecord],
}

impl<'a> LevelPart<'a> {
    /// Takes the first `count` nodes away. Precondition: none is written.
    fn take(&mut self, count: usize) -> LevelPart<'a> {
        let internal = count.min(self.masks.len());
        let taken = LevelPart {
            first: self.first,
            written: 0,
            masks: self.masks.split_off_mut(..internal).unwrap_or_default(),
            first_child: self
                .first_child
                .split_off_mut(..internal)
                .unwrap_or_default(),
            voxels: self.voxels.split_off_mut(..count).unwrap_or_default(),
        };
        self.first += count as u32;
        taken
    }

    /// Number of the node that is written next.
    #[inline(always)]
    fn next(&self) -> u32 {
        self.first + self.written as u32
    }

    /// Notes where the children of the next node begin.
    #[inline(always)]
    fn begin(&mut self, first_child: u32) {
        if let Some(place) = self.first_child.get_mut(self.written) {
            *place = first_child;
        }
    }

    /// Writes the next node.
    #[inline(always)]
    fn write(&mut self, mask: u8, voxel: VoxelRecord) {
        if let Some(place) = self.masks.get_mut(self.written) {
            *place = mask;
        }
        self.voxels[self.written] = voxel;
        self.written += 1;
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
            first: 0,
            written: 0,
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

    /// Writes the nodes of points that are whole cells of the top level, on several threads; these cells.
    fn share_points(mut self, points: SortedPoints<'_>) -> Vec<Root> {
        if points.len() >= 2 * PARALLEL_POINTS {
            let (low, high) = points.split_after(points.len() / 2, self.top);
            if high.len() > 0 {
                let low_writer = self.split_points(low);
                let (mut roots, high_roots) =
                    rayon::join(|| low_writer.share_points(low), || self.share_points(high));
                roots.extend(high_roots);
                return roots;
            }
        }
        self.write_points(points)
    }

    /// [`Self::share_points`] on this thread.
    fn write_points(self, points: SortedPoints<'_>) -> Vec<Root> {
        dispatch!(Level::new(), _simd => Walk::new(self).over_points(points))
    }

    /// Writes the levels above `roots`, which are written and numbered from `first_root`.
    fn write_above(self, roots: &[Root], first_root: u32) {
        if !self.levels.is_empty() {
            Walk::new(self).over_roots(roots, first_root);
        }
    }
}

/// A walk over sorted points or nodes that writes the levels above them.
struct Walk<'a> {
    cube: Cube,
    top: usize,
    bottom: usize,
    levels: Vec<LevelPart<'a>>,
    /// One for each level, counted from the root's.
    open: [OpenNode; LEVELS as usize + 1],
    edges: [f32; LEVELS as usize + 1],
    /// The last code, and where its top cell parted from the one before.
    code: u64,
    top_parting: u8,
    /// First child of the bottom node that is opened next; leaves have none.
    child_of_bottom: u32,
    roots: Vec<Root>,
}

// Inlined, so that the walk over points is compiled for each level of SIMD.
impl<'a> Walk<'a> {
    fn new(writer: LevelWriter<'a>) -> Self {
        let cube = writer.cube;
        Self {
            cube,
            top: writer.top as usize,
            bottom: writer.top as usize + writer.levels.len() - 1,
            roots: Vec::with_capacity(writer.levels[0].voxels.len()),
            levels: writer.levels,
            open: [OpenNode {
                sum: Vec4::ZERO,
                mask: 0,
            }; LEVELS as usize + 1],
            edges: std::array::from_fn(|level| cube.cell_edge(level as u32)),
            code: 0,
            top_parting: 0,
            child_of_bottom: 0,
        }
    }

    #[inline(always)]
    fn over_points(mut self, points: SortedPoints<'_>) -> Vec<Root> {
        let mut sum = [0; 4];
        let colored = points.partings.iter().zip(points.colors);
        for (index, (&code, (&parting, color))) in points.codes.iter().zip(colored).enumerate() {
            if index == 0 {
                self.begin(parting, code);
            } else if usize::from(parting) <= self.bottom {
                self.open[self.bottom].sum = Vec4::from_array(sum.map(|sum| sum as f32));
                self.move_on(parting, code);
                sum = [0; 4];
            }
            if sum[3] < MOST_SUMMED {
                let [red, green, blue, _] = *color;
                for (sum, add) in sum.iter_mut().zip([red, green, blue, 1]) {
                    *sum += i32::from(add);
                }
            }
        }
        self.open[self.bottom].sum = Vec4::from_array(sum.map(|sum| sum as f32));
        self.move_on(0, self.code);
        self.roots
    }

    fn over_roots(mut self, roots: &[Root], first_root: u32) {
        for (root, number) in roots.iter().zip(first_root..) {
            if usize::from(root.parting) <= self.bottom {
                self.child_of_bottom = number;
            }
            if number == first_root {
                self.begin(root.parting, root.code);
            } else if usize::from(root.parting) <= self.bottom {
                self.move_on(root.parting, root.code);
            }
            let parent = &mut self.open[self.bottom];
            parent.mask |= 1 << octant(root.code, self.bottom + 1);
            parent.sum += root.sum;
        }
        self.move_on(0, self.code);
    }

    /// Opens the first node of every level, which `code` lies in.
    fn begin(&mut self, parting: u8, code: u64) {
        (self.top_parting, self.code) = (parting, code);
        for level in (self.top..=self.bottom).rev() {
            self.open_node(level, code);
        }
    }

    /// Writes the open nodes from the bottom up to level `parting` and opens those that `code` is the first of: in one
    /// loop, as its length is what the processor cannot guess.
    #[inline(always)]
    fn move_on(&mut self, parting: u8, code: u64) {
        let [x, y, z] = morton::decode(self.code);
        let cell = [x, y, z, 0];
        let min = self.cube.min.extend(0.0);
        let top = usize::from(parting).max(self.top);
        for level in (top..=self.bottom).rev() {
            let OpenNode { sum, mask } = self.open[level];
            // Below 2²¹, so that a signed conversion, which is one instruction, is exact.
            let cell = cell.map(|c| (c >> (LEVELS as usize - level)) as i32 as f32);
            let center = min + (Vec4::from_array(cell) + 0.5) * self.edges[level];
            let voxel = voxel_record(center, sum / sum.w, level as u32);
            self.levels[level - self.top].write(mask, voxel);
            if level > self.top {
                self.open[level - 1].sum += sum;
            } else {
                self.roots.push(Root {
                    code: self.code,
                    parting: self.top_parting,
                    sum,
                });
                self.top_parting = parting;
            }
            self.open_node(level, code);
        }
        if top > self.top {
            self.open[top - 1].mask |= 1 << octant(code, top);
        }
        self.code = code;
    }

    /// Opens a node of `level`; that of the level below, its first child, is open.
    #[inline(always)]
    fn open_node(&mut self, level: usize, code: u64) {
        let (mask, first_child) = match self.levels.get(level + 1 - self.top) {
            Some(below) => (1 << octant(code, level + 1), below.next()),
            None => (0, self.child_of_bottom),
        };
        self.open[level] = OpenNode {
            sum: Vec4::ZERO,
            mask,
        };
        self.levels[level - self.top].begin(first_child);
    }
}

/// The octant in its parent of the cell of `level` that a finest cell lies in.
#[inline(always)]
fn octant(code: u64, level: usize) -> u64 {
    code >> (3 * (LEVELS as usize - level)) & 7
}

/// The record of a cell, put together as one register of 16 bytes: `color` has numbers in 0..=255, to be rounded.
#[inline(always)]
fn voxel_record(center: Vec4, color: Vec4, level: u32) -> VoxelRecord {
    // At 2²³ the last bit of an f32 is worth 1: sums are rounded there.
    let rounded = (color + 8_388_608.0) - 8_388_608.0;
    // Three bytes side by side are an integer below 2²⁴, exact in f32.
    let packed = rounded.dot(Vec4::new(1.0, 256.0, 65_536.0, 0.0)) as i32 as u32;
    // As the bytes of the record lie in memory, whatever the processor's order.
    let color_and_level = f32::from_bits(u32::from_ne_bytes((packed | level << 24).to_le_bytes()));
    let [x, y, z, _] = center.to_array();
    bytemuck::cast([x, y, z, color_and_level])
}
