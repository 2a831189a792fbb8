//! Cells of small subtrees, tested side by side instead of by descending.
//!
//! How it works: where the border of the frustum or of two levels of detail cuts through a cell of few points,
//! descending from cell to cell costs more than testing all cells of the first level on which any may stop. Nothing
//! above that level needs a test: the bounding sphere of a cell lies in the spheres of all cells that contain it, so it
//! alone determines whether they are visible. The cells of 64 points are read off their parting levels together and
//! tested eight at a time; a bit of each says whether it is in view, another whether it stops. Runs of cells that are
//! alike are emitted as one range, or sifted one level below.
//!
//! When it wins: a cell takes 2 to 3 ns so, one that is visited by itself 50 to 60, most of them for unpredictable
//! branches. In large subtrees most cells would be tested that descending passes over, or emits with thousands of
//! others.

use super::partings::write_beginnings;
use super::surfels::LodSurfels;
use super::traversal::{PlaneMask, Traversal};
use crate::levels::cut::{Cut, NodeRange};
use crate::math::morton::LEVELS;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, dispatch, f32x8, mask32x8, u32x8};
use glam::Vec3;
use std::ops::Range;

/// Common data of the cells of a subtree.
pub(super) struct Subtree {
    /// The planes that not all of it is inside of.
    pub(super) planes: PlaneMask,
    /// The highest level on which a cell may stop.
    pub(super) first_stop: u32,
    /// The level of the leaves.
    pub(super) depth: u32,
}

/// Points whose cells are tested together.
const BLOCK: usize = 64;

/// Cells tested by one instruction.
const LANES: usize = 8;

/// At most [`BLOCK`] consecutive cells of one level, and the test results of each, the first one in the lowest
/// bit.
struct CellBlock {
    level: u32,
    /// The first points of the cells, then the point after the last cell; later entries do not matter.
    firsts: [u32; BLOCK + LANES],
    in_view: u64,
    may_stop: u64,
    must_stop: u64,
}

impl CellBlock {
    fn new(level: u32) -> Self {
        Self {
            level,
            firsts: [0; BLOCK + LANES],
            in_view: 0,
            may_stop: 0,
            must_stop: 0,
        }
    }

    fn points(&self, cells: Range<u32>) -> Range<usize> {
        self.firsts[cells.start as usize] as usize..self.firsts[cells.end as usize] as usize
    }
}

impl Traversal<'_> {
    /// Emits the nodes that represent some points: of the cells of `level`, those that are in view and stop, and below
    /// the others their descendants. No cell above `level` stops. Recursion is bounded by the 21 levels.
    pub(super) fn sift(&self, level: u32, points: Range<usize>, subtree: &Subtree, cut: &mut Cut) {
        let sorted = &self.tree.points;
        let mut next = points.start;
        while next < points.end {
            let block_end = points.end.min(next + BLOCK);
            let mut block = CellBlock::new(level);
            let count = dispatch!(
                self.simd,
                simd => self.test_block(simd, next..block_end, subtree.planes, &mut block)
            );
            // The last cell may have points beyond the block.
            next = match points.end - block_end {
                0 => block_end,
                _ => sorted.next_beginning(level, block_end, points.end),
            };
            block.firsts[count] = next as u32;
            cut.tested.nodes += count;
            if let Some(surfels) = self.back_faces {
                self.drop_back_faces(surfels, &mut block);
            }
            self.emit_block(&block, subtree, cut);
        }
    }

    fn emit_block(&self, block: &CellBlock, subtree: &Subtree, cut: &mut Cut) {
        let stop = self.stopping(block, subtree.depth);
        cut.tested.emitted += stop.count_ones() as usize;
        let level = block.level;
        let mut left = block.in_view;
        while left != 0 {
            let first = left.trailing_zeros();
            let is_stop = stop >> first & 1 == 1;
            let alike = if is_stop { left & stop } else { left & !stop };
            let end = first + (alike >> first).trailing_ones();
            let points = block.points(first..end);
            left &= u64::MAX.checked_shl(end).unwrap_or(0);
            if is_stop {
                cut.emit(NodeRange { level, points });
            } else {
                self.sift(subtree.first_stop.max(level + 1), points, subtree, cut);
            }
        }
    }

    /// The cells in view that are not divided.
    fn stopping(&self, block: &CellBlock, depth: u32) -> u64 {
        if block.level == depth {
            return block.in_view;
        }
        let mut stop = block.in_view & block.must_stop;
        for cell in set_bits(block.in_view & block.may_stop & !block.must_stop) {
            let points = block.points(cell..cell + 1);
            let distance = self.center(block.level, points.start) - self.view.eye;
            let node = NodeRange {
                level: block.level,
                points,
            };
            stop |= u64::from(self.stops(&node, distance.abs())) << cell;
        }
        stop
    }

    /// Takes cells out of view whose points all face away, if this is the level to know it.
    fn drop_back_faces(&self, surfels: &LodSurfels, block: &mut CellBlock) {
        let Some(surfels) = surfels.cones(block.level, block.firsts[0] as usize) else {
            return;
        };
        let sphere_radius = self.levels[block.level as usize].sphere_radius;
        for cell in set_bits(block.in_view) {
            let first = block.firsts[cell as usize] as usize;
            let from_eye = self.center(block.level, first) - self.view.eye;
            if surfels[cell as usize].faces_away(from_eye, sphere_radius) {
                block.in_view &= !(1 << cell);
            }
        }
    }

    /// Returns the centre of the cell of `level` that contains a point.
    fn center(&self, level: u32, point: usize) -> Vec3 {
        let cell = self.tree.points.cells[point].coordinates();
        let cell = cell.map(|coordinate| coordinate >> (LEVELS - level));
        self.tree.cube.cell_center(level, cell)
    }

    /// Fills a block with the cells of its level that begin among some points, at most [`BLOCK`]; returns their number.
    #[inline(always)]
    fn test_block<S: Simd>(&self, simd: S, points: Range<usize>, planes: PlaneMask, block: &mut CellBlock) -> usize {
        let level = block.level;
        let first = points.start as u32;
        let partings = &self.tree.points.partings[points];
        let count = write_beginnings(partings, level, first, &mut block.firsts);
        let limits = &self.levels[level as usize];
        let (mut all_in_view, mut all_may_stop, mut all_must_stop) = (0, 0, 0);
        let none = u32x8::splat(simd, 0);
        let lane_bits = simd.load_array_u32x8([1, 2, 4, 8, 16, 32, 64, 128]);
        let rows = block.firsts[..count.next_multiple_of(LANES)].as_chunks();
        for (row, firsts) in rows.0.iter().enumerate() {
            let center = self.centers(simd, level, firsts);
            let in_view = self.in_view(simd, center, limits.sphere_radius, planes);
            let nearest_squared = self.nearest_squared(simd, center, 0.5 * limits.edge);
            let may_stop = nearest_squared.simd_gt(limits.may_stop_beyond_squared);
            let must_stop = nearest_squared.simd_gt(limits.must_stop_beyond_squared);
            // One byte for each of the three, so that the lanes are joined only once.
            let bits = in_view.select(lane_bits, none)
                | may_stop.select(lane_bits << 8, none)
                | must_stop.select(lane_bits << 16, none);
            let (low, high) = simd.split_u32x8(bits);
            let [a, b, c, d]: [u32; 4] = (low | high).into();
            let [in_view, may_stop, must_stop, _] = (a | b | c | d).to_le_bytes();
            all_in_view |= u64::from(in_view) << (LANES * row);
            all_may_stop |= u64::from(may_stop) << (LANES * row);
            all_must_stop |= u64::from(must_stop) << (LANES * row);
        }
        // The last row may be longer than the number of cells.
        block.in_view = all_in_view & u64::MAX >> (BLOCK - count);
        block.may_stop = all_may_stop;
        block.must_stop = all_must_stop;
        count
    }

    /// Returns the centres of the cells of `level` that contain eight points.
    #[inline(always)]
    fn centers<S: Simd>(&self, simd: S, level: u32, points: &[u32; LANES]) -> [f32x8<S>; 3] {
        let mut cells = [[0; LANES]; 3];
        for (lane, &point) in points.iter().enumerate() {
            let cell = self.tree.points.cells[point as usize];
            for (axis, cells) in cells.iter_mut().enumerate() {
                // Below 2²¹; a signed conversion is one instruction.
                cells[lane] = cell.coordinate(axis, level) as i32;
            }
        }
        let edge = self.levels[level as usize].edge;
        let min = self.tree.cube.min.as_vec3();
        let [x, y, z] = cells;
        [
            centers_along(simd, x, edge, min.x),
            centers_along(simd, y, edge, min.y),
            centers_along(simd, z, edge, min.z),
        ]
    }

    /// Returns a mask of the spheres, of eight, that are not outside any of the frustum planes.
    #[inline(always)]
    fn in_view<S: Simd>(&self, simd: S, [x, y, z]: [f32x8<S>; 3], radius: f32, planes: PlaneMask) -> mask32x8<S> {
        let mut outside = mask32x8::splat(simd, 0);
        let mut untested = planes;
        while untested != 0 {
            let plane = self.view.frustum.planes()[untested.trailing_zeros() as usize];
            untested &= untested - 1;
            let distance = x * plane.x + y * plane.y + z * plane.z + plane.w;
            outside |= distance.simd_lt(-radius);
        }
        !outside
    }

    /// Squares of the distances from the eye to the nearest points of eight cells.
    #[inline(always)]
    fn nearest_squared<S: Simd>(&self, simd: S, [x, y, z]: [f32x8<S>; 3], half_edge: f32) -> f32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let eye = self.view.eye;
        let x = ((x - eye.x).abs() - half_edge).max(zero);
        let y = ((y - eye.y).abs() - half_edge).max(zero);
        let z = ((z - eye.z).abs() - half_edge).max(zero);
        x * x + y * y + z * z
    }
}

#[inline(always)]
fn centers_along<S: Simd>(simd: S, cells: [i32; LANES], edge: f32, min: f32) -> f32x8<S> {
    (simd.cvt_f32_i32x8(simd.load_array_i32x8(cells)) + 0.5) * edge + min
}

/// The positions of the set bits, ascending.
fn set_bits(mut bits: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (place < u64::BITS).then_some(place)
    })
}
