//! Building an octree from sorted Morton codes (paper 000 §VI-A; the bottom-up construction in 000's future work).
//!
//! How it works:
//! 1. Points become 63-bit Morton codes, which are sorted. The points of any cell of any level now stand together.
//! 2. For each code the level at which it *parts* from the one before it is noted: it is the first point of its cell there
//!    and on every deeper level. A histogram of these levels, summed up, counts the occupied cells of every level,
//!    so one scan answers the stop criterion for all depths.
//! 3. The leaves are the points whose parting level is not below the leaf level. Each coarser level follows from the finer
//!    one in the same way, nodes instead of points: every level is one pass over contiguous arrays that shrink as it
//!    goes, compacted in place. A pass also adds up the colours, so every node knows the mean of its points.
//!
//! When it wins: no node is ever searched for, allocated or visited twice; the passes cost a few cycles a node, less than
//! the sort does a point.
//!
//! Loops select instead of branching: whether a node is the first child of its parent is a coin toss that a branch
//! predictor loses.

use super::{Cube, Octree, StopCriterion, stop::OccupiedCells};
use crate::{
    cloud::VoxelRecord,
    math::{
        morton::{self, LEVELS},
        sort_codes,
    },
};
use glam::{DVec4, Vec3, Vec4};

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

        let mut nodes = LevelNodes::leaves(
            depth,
            occupied[depth as usize],
            &sorted.codes,
            &partings,
            sorted.order.iter().map(|&index| colors[index as usize]),
        );
        let level_counts = occupied[..=depth as usize].to_vec();
        let node_count: usize = level_counts.iter().sum();
        let internal_count = node_count - occupied[depth as usize];
        let mut tree = Self {
            cube,
            point_count: positions.len(),
            level_counts,
            masks: vec![0; internal_count],
            first_child: vec![0; internal_count + 1],
            voxels: vec![bytemuck::Zeroable::zeroed(); node_count],
        };
        tree.first_child[internal_count] = node_count as u32;
        let mut first = internal_count;
        nodes.write_voxels(&cube, depth, &mut tree.voxels[first..]);
        for level in (0..depth).rev() {
            let first_of_children = first;
            first -= occupied[level as usize];
            let here = first..first_of_children;
            nodes.merge_into_parents(
                level,
                first_of_children as u32,
                &mut tree.masks[here.clone()],
                &mut tree.first_child[here.clone()],
            );
            nodes.write_voxels(&cube, level, &mut tree.voxels[here]);
        }
        tree
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

/// The nodes of one level while the tree is built, in Morton order.
struct LevelNodes {
    /// Integer coordinates of the cell on its level; the last lane is unused and makes the record one SIMD register.
    cells: Vec<[u32; 4]>,
    /// Level at which the node parts from the one before it.
    partings: Vec<u8>,
    /// Red, green, blue and the number of points, summed over the points inside. Exact up to 2¹⁶ points a cell, then
    /// rounded to 24 bits.
    sums: Vec<Vec4>,
}

impl LevelNodes {
    /// The `count` occupied cells of `level`.
    fn leaves(
        level: u32,
        count: usize,
        codes: &[u64],
        partings: &[u8],
        colors: impl Iterator<Item = [u8; 4]>,
    ) -> Self {
        let mut nodes = Self {
            cells: vec![[0; 4]; count],
            partings: vec![0; count],
            sums: vec![Vec4::ZERO; count],
        };
        let shift = 3 * (LEVELS - level);
        let mut place = usize::MAX;
        // In f64: a cell may hold more points than f32 can add one by one.
        let mut sum = DVec4::ZERO;
        for ((&code, &parting), [red, green, blue, _]) in codes.iter().zip(partings).zip(colors) {
            let color = DVec4::new(f64::from(red), f64::from(green), f64::from(blue), 1.0);
            if u32::from(parting) <= level {
                place = place.wrapping_add(1);
                let [x, y, z] = morton::decode(code >> shift);
                nodes.cells[place] = [x, y, z, 0];
                nodes.partings[place] = parting;
                sum = DVec4::ZERO;
            }
            sum += color;
            nodes.sums[place] = sum.as_vec4();
        }
        nodes
    }

    /// Replaces the nodes by their parents on `level`, writing the masks and first children of these.
    fn merge_into_parents(
        &mut self,
        level: u32,
        first_of_children: u32,
        masks: &mut [u8],
        first_child: &mut [u32],
    ) {
        let mut parent = usize::MAX;
        let mut mask = 0;
        let mut first = 0;
        let mut parting = 0;
        let mut sum = Vec4::ZERO;
        for child in 0..self.partings.len() {
            let child_parting = self.partings[child];
            let [x, y, z, _] = self.cells[child];
            let is_first = u32::from(child_parting) <= level;
            let octant = x & 1 | (y & 1) << 1 | (z & 1) << 2;
            parent = parent.wrapping_add(usize::from(is_first));
            mask = if is_first { 0 } else { mask } | 1 << octant;
            first = if is_first {
                first_of_children + child as u32
            } else {
                first
            };
            parting = if is_first { child_parting } else { parting };
            sum = if is_first { Vec4::ZERO } else { sum } + self.sums[child];

            masks[parent] = mask;
            first_child[parent] = first;
            self.cells[parent] = [x >> 1, y >> 1, z >> 1, 0];
            self.partings[parent] = parting;
            self.sums[parent] = sum;
        }
        let count = masks.len();
        self.cells.truncate(count);
        self.partings.truncate(count);
        self.sums.truncate(count);
    }

    /// Writes what is drawn for each node.
    fn write_voxels(&self, cube: &Cube, level: u32, voxels: &mut [VoxelRecord]) {
        let edge = cube.cell_edge(level);
        for ((voxel, &[x, y, z, _]), &sum) in voxels.iter_mut().zip(&self.cells).zip(&self.sums) {
            // Below 2²¹, so that a signed conversion, which is one instruction, is exact.
            let cell = Vec3::new(x as i32 as f32, y as i32 as f32, z as i32 as f32);
            let [red, green, blue, _] = (sum / sum.w + 0.5).to_array().map(|mean| mean as u8);
            *voxel = VoxelRecord {
                center: (cube.min + (cell + 0.5) * edge).to_array(),
                color: [red, green, blue],
                level: level as u8,
            };
        }
    }
}
