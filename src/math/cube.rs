//! The cube that encloses a cloud, and the cells its points fall into.
//!
//! **One lattice for all clouds.** The cells of a level with edge 2ᵏ have their corners on `2ᵏ·(n + t)`, n an integer,
//! t ⅓ for even k and ⅔ for odd k, along each axis of scene coordinates. Every cell is then divided into eight of the
//! next level exactly, whatever the cloud: a surface at rest falls into the same cells in every frame, although other
//! points move, come or go, and no frame needs to know another. A cube fitted to each frame moved all cells with its
//! farthest point.
//!
//! A cloud's cube is the smallest block of two lattice cells along each axis that holds it. So it grows by whole
//! octants, its edge is one to four times the extent of the cloud, and all levels but the root's are of the lattice.
//!
//! **Thirds.** No f32 is a third of a power of two. So no coordinate lies on a border (unless f32 hardly resolves the
//! cloud), and planes at round coordinates, as floors at zero, are a third of a cell away from the borders of every
//! level: noise smaller than that does not spread them over two layers of cells.

use super::{
    Aabb,
    morton::{self, FINEST_CELLS, LEVELS, PackedCell},
};
use fearless_simd::{Level, dispatch};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Edge of the cube around points that all coincide, in scene units, unless they lie so far out that f32 cannot tell
/// the ends of such an edge apart.
const LONE_EDGE: f32 = 1.0;

/// Exponents of the edges of the lattice's cells that a cube may be a block of. Larger ones have no f32 as edge of the
/// cube; the finest cells of smaller ones have no edge that is a normal f32.
const HALF_EDGE_EXPONENTS: RangeInclusive<i32> = -105..=126;

/// The cube that Morton codes and octrees divide: every cell of every level is a cube too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cube {
    /// Smallest corner, relative to the sequence origin. In f64, as thirds are not exact in f32.
    pub min: DVec3,
    /// Edge length; positive and finite.
    pub edge: f32,
}

impl Cube {
    /// The cube of no points.
    pub const EMPTY: Self = Self {
        min: DVec3::ZERO,
        edge: LONE_EDGE,
    };

    /// Returns the smallest block of two lattice cells along each axis that holds `points`; `None` for no points.
    ///
    /// Points that coincide sit at the centre of a cube of edge 1 (or of 2⁻²⁰ of their distance from the origin, if
    /// that is more). Clouds too small or too large for the lattice get the cube around their bounding box; the edge is
    /// at most the largest f32.
    pub fn around(points: &[Vec3]) -> Option<Self> {
        Self::around_box(&Aabb::from_points(points))
    }

    /// [`Cube::around`] points with these bounds.
    pub fn around_box(bounds: &Aabb) -> Option<Self> {
        if bounds.is_empty() {
            return None;
        }
        let [min, max] = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
        let longest = (max - min).max_element();
        if longest == 0.0 {
            let edge = LONE_EDGE.max(bounds.max.abs().max_element() / (1 << 20) as f32);
            return Some(Self {
                min: min - DVec3::splat(0.5 * f64::from(edge)),
                edge,
            });
        }
        Some(Self::on_lattice(min, max).unwrap_or_else(|| Self::fitted(min, longest)))
    }

    /// The smallest block of lattice cells that holds a box; `None` if its edge is out of range. Precondition: the box
    /// has a length.
    fn on_lattice(min: DVec3, max: DVec3) -> Option<Self> {
        // Half an edge is at least half the extent, and twice that is always enough.
        let smallest = (max - min).max_element().log2().floor() as i32 - 1;
        let fits = |exponent: i32| Lattice::new(exponent).block(min, max);
        let mut exponents = smallest..=smallest + 2;
        let (exponent, corner) = exponents.find_map(|exponent| Some((exponent, fits(exponent)?)))?;
        HALF_EDGE_EXPONENTS.contains(&exponent).then(|| Self {
            min: corner,
            edge: 2f32.powi(exponent + 1),
        })
    }

    /// The cube from the smallest corner of a box with its longest edge, rounded up.
    fn fitted(min: DVec3, longest: f64) -> Self {
        let nearest = longest.min(f64::from(f32::MAX)) as f32;
        let edge = if f64::from(nearest) < longest {
            nearest.next_up().min(f32::MAX)
        } else {
            nearest
        };
        Self { min, edge }
    }

    /// Edge of the cells of `level`.
    pub fn cell_edge(&self, level: u32) -> f32 {
        (f64::from(self.edge) / f64::from(1u32 << level)) as f32
    }

    /// Returns the centre of a cell of `level` by its integer coordinates.
    pub fn cell_center(&self, level: u32, cell: [u32; 3]) -> Vec3 {
        let cell = Vec3::from_array(cell.map(|coordinate| coordinate as f32));
        self.min.as_vec3() + (cell + 0.5) * self.cell_edge(level)
    }

    /// The finest cells that hold `points`. Precondition: the points this cube was made around.
    ///
    /// Cells are half-open: a point on the border of two belongs to the upper one, except for the upper faces of the
    /// cube, which belong to the last cells. On the lattice no point is on a border.
    pub fn cells(&self, points: &[Vec3]) -> Vec<PackedCell> {
        bytemuck::cast_vec(self.quantized::<false>(points))
    }

    /// The Morton codes of [`Cube::cells`].
    pub fn codes(&self, points: &[Vec3]) -> Vec<u64> {
        self.quantized::<true>(points)
    }

    /// Writes [`Cube::codes`], on this thread.
    pub(crate) fn write_codes(&self, points: &[Vec3], codes: &mut [u64]) {
        let quantizer = Quantizer::new(self);
        dispatch!(Level::new(), _simd => quantizer.write_cells::<true>(points, codes));
    }

    /// Codes, or else packed cells.
    fn quantized<const INTERLEAVED: bool>(&self, points: &[Vec3]) -> Vec<u64> {
        let quantizer = Quantizer::new(self);
        let level = Level::new();
        let mut cells = vec![0; points.len()];
        cells
            .par_chunks_mut(BLOCK)
            .zip(points.par_chunks(BLOCK))
            .with_min_len(BLOCKS_PER_TASK)
            .for_each(|(cells, points)| {
                dispatch!(level, _simd => quantizer.write_cells::<INTERLEAVED>(points, cells));
            });
        cells
    }

    /// [`Cube::cells`] and [`Cube::codes`] at once.
    pub(crate) fn cells_and_codes(&self, points: &[Vec3]) -> (Vec<PackedCell>, Vec<u64>) {
        let quantizer = Quantizer::new(self);
        let level = Level::new();
        let mut cells = vec![0; points.len()];
        let mut codes = vec![0; points.len()];
        cells
            .par_chunks_mut(BLOCK)
            .zip(codes.par_chunks_mut(BLOCK))
            .zip(points.par_chunks(BLOCK))
            .with_min_len(BLOCKS_PER_TASK)
            .for_each(|((cells, codes), points)| {
                dispatch!(level, _simd => quantizer.write_cells_and_codes(points, cells, codes));
            });
        (bytemuck::cast_vec(cells), codes)
    }
}

/// The cells of one size.
struct Lattice {
    edge: f64,
    /// One of their borders, on every axis.
    border: f64,
    /// A border of the cells twice as long.
    border_above: f64,
}

impl Lattice {
    /// Cells with an edge of 2 to the power of `exponent`.
    fn new(exponent: i32) -> Self {
        let edge = 2f64.powi(exponent);
        let third = edge / 3.0;
        // Borders of one level are borders of the next finer one: 2·(n + ⅔) = (2n + 1) + ⅓ and 2·(n + ⅓) = 2n + ⅔.
        let (border, border_above) = if exponent % 2 == 0 {
            (third, 4.0 * third)
        } else {
            (2.0 * third, 2.0 * third)
        };
        Self {
            edge,
            border,
            border_above,
        }
    }

    /// Returns the smallest corner of two cells along each axis that hold a box: the cell of the next level where one
    /// does. `None` if the box is in more cells.
    fn block(&self, min: DVec3, max: DVec3) -> Option<DVec3> {
        let corner_below = |place: DVec3, edge: f64, border: f64| ((place - border) / edge).floor() * edge + border;
        let corner = corner_below(min, self.edge, self.border);
        let above = corner_below(min, 2.0 * self.edge, self.border_above);
        let end = DVec3::splat(2.0 * self.edge);
        let is_one_cell = max.cmplt(above + end);
        let is_two_cells = max.cmplt(corner + end);
        (is_one_cell | is_two_cells)
            .all()
            .then(|| DVec3::select(is_one_cell, above, corner))
    }
}

/// Points that are quantised together.
const BLOCK: usize = 64;

/// Blocks that are worth handing to another thread: 16,384 points.
const BLOCKS_PER_TASK: usize = 256;

/// Maps points to finest cells, exactly.
///
/// `floor(offset / cell)` needs a correctly rounded division to put a point that lies on a border into the right cell.
/// A multiplication with the reciprocal is faster but not exact, so it is only rounded to the *nearest* border, and a
/// second test determines on which side of it the point is: `border · cell` is exact in f64 (22 bits times the 24 of an
/// f32), so comparing it with the offset is, too.
struct Quantizer {
    min: DVec3,
    cell: f64,
    cells_per_unit: f64,
}

/// The last bit of an f64 this large is worth 1: adding it rounds to an integer, which is then in the low bits.
const ROUNDING: f64 = (1u64 << 52) as f64;

/// In the last cell, and nearer to its lower border than to its upper one, so that it is rounded to no cell more.
const MAX_CELLS: f64 = FINEST_CELLS as f64 - 0.75;

impl Quantizer {
    fn new(cube: &Cube) -> Self {
        let cell = f64::from(cube.edge) / f64::from(FINEST_CELLS);
        Self {
            min: cube.min,
            cell,
            cells_per_unit: 1.0 / cell,
        }
    }

    /// Writes the codes of points, or else their packed cells.
    #[inline(always)]
    fn write_cells<const INTERLEAVED: bool>(&self, points: &[Vec3], cells: &mut [u64]) {
        for (cell, point) in cells.iter_mut().zip(points) {
            let indices = self.indices(*point);
            *cell = if INTERLEAVED {
                interleaved(indices)
            } else {
                packed(indices)
            };
        }
    }

    /// Writes both.
    #[inline(always)]
    fn write_cells_and_codes(&self, points: &[Vec3], cells: &mut [u64], codes: &mut [u64]) {
        for (point, (cell, code)) in points.iter().zip(cells.iter_mut().zip(codes)) {
            let indices = self.indices(*point);
            *cell = packed(indices);
            *code = interleaved(indices);
        }
    }

    /// The indices of the cell of a point along the axes. Loops over points are compiled so that registers hold one
    /// axis of four points, which never leave them before their cells are whole.
    #[inline(always)]
    fn indices(&self, point: Vec3) -> [u64; 3] {
        [
            self.index(f64::from(point.x) - self.min.x),
            self.index(f64::from(point.y) - self.min.y),
            self.index(f64::from(point.z) - self.min.z),
        ]
    }

    /// The index of the cell at a distance of `offset` from the lower face. It is negative only where f64 rounds the
    /// corner of a cube that f32 hardly resolves.
    #[inline(always)]
    fn index(&self, offset: f64) -> u64 {
        let offset = offset.max(0.0);
        let rounded = (offset * self.cells_per_unit).min(MAX_CELLS) + ROUNDING;
        let is_below = (rounded - ROUNDING) * self.cell > offset;
        (rounded.to_bits() - u64::from(is_below)) & u64::from(FINEST_CELLS - 1)
    }
}

/// The number in a [`PackedCell`].
#[inline(always)]
fn packed([x, y, z]: [u64; 3]) -> u64 {
    x | y << LEVELS | z << (2 * LEVELS)
}

/// A Morton code.
#[inline(always)]
fn interleaved([x, y, z]: [u64; 3]) -> u64 {
    morton::spread(x) | morton::spread(y) << 1 | morton::spread(z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_cube_is_two_cells_along_each_axis() {
        // Cells of edge 1 have borders at n + ⅓: the smallest that divide a box of 1.5 into two.
        let cube = Cube::around(&[Vec3::new(-1.0, 2.0, 0.0), Vec3::new(0.5, 2.25, 0.125)]).unwrap();
        assert_eq!(cube.edge, 4.0);
        let thirds = cube.min * 3.0;
        assert!((thirds - thirds.round()).abs().max_element() < 1e-12, "{cube:?}");
        assert_eq!(Cube::around(&[]), None);
    }

    #[test]
    fn round_coordinates_are_a_third_of_a_cell_from_borders() {
        let cube = Cube::around(&[Vec3::splat(-1.0), Vec3::splat(3.0)]).unwrap();
        for level in 1..=10 {
            let cells = (DVec3::ZERO - cube.min) / f64::from(cube.cell_edge(level));
            let share = cells.x.fract();
            assert!(
                (share - 1.0 / 3.0).abs() < 1e-9 || (share - 2.0 / 3.0).abs() < 1e-9,
                "{share}"
            );
        }
    }

    #[test]
    fn coincident_points_are_centered() {
        for point in [
            Vec3::ZERO,
            Vec3::splat(1e7),
            Vec3::new(-3e37, 0.0, 2e37),
            Vec3::splat(1e-40),
        ] {
            let cube = Cube::around(&[point; 3]).unwrap();
            assert!(cube.edge >= LONE_EDGE && cube.edge.is_finite());
            assert!((cube.cell_center(0, [0; 3]) - point).length() <= 1e-6 * cube.edge);
        }
    }

    #[test]
    fn extents_beyond_f32_stay_finite() {
        let points = [Vec3::splat(-f32::MAX), Vec3::splat(f32::MAX)];
        let cube = Cube::around(&points).unwrap();
        assert!(cube.edge.is_finite());
        assert_eq!(cube.codes(&points), [0, morton::encode([FINEST_CELLS - 1; 3])]);
    }

    #[test]
    fn the_smallest_and_largest_extents_have_valid_cells() {
        for exponent in -149..=127 {
            let end = 2f64.powi(exponent) as f32;
            let points = [Vec3::ZERO, Vec3::new(0.0, end, 0.0)];
            let cube = Cube::around(&points).unwrap();
            assert!(cube.edge >= end && cube.edge.is_finite(), "2^{exponent}: {cube:?}");
            let codes = cube.codes(&points);
            assert!(codes[0] < codes[1], "2^{exponent}: {cube:?}");
        }
    }

    proptest! {
        /// Points on the borders of the cells of a cube off the lattice, where a reciprocal misplaces: for many edges
        /// and levels.
        #[test]
        fn borders_belong_to_the_upper_cell(edge in 1u32..10_000, exponent in -30i32..30, level in 1u32..=12,
            index in 0u32..4096) {
            let index = index & ((1 << level) - 1);
            let edge = edge as f32 * 2f32.powi(exponent);
            let border = f64::from(edge) * f64::from(index) / f64::from(1u32 << level);
            prop_assume!(f64::from(border as f32) == border);
            let points = [Vec3::ZERO, Vec3::splat(edge), Vec3::new(border as f32, 0.0, 0.0)];
            let codes = Cube { min: DVec3::ZERO, edge }.codes(&points);
            prop_assert_eq!(codes[2], morton::encode([index << (21 - level), 0, 0]));
            prop_assert_eq!(codes[1], morton::encode([FINEST_CELLS - 1; 3]));
        }

        #[test]
        fn cells_hold_their_points(points in prop::collection::vec(prop::array::uniform3(-1e3f32..1e3), 2..40)) {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from_array).collect();
            let cube = Cube::around(&points).unwrap();
            let cell_edge = f64::from(cube.edge) / f64::from(FINEST_CELLS);
            prop_assert_eq!(cube.cells_and_codes(&points), (cube.cells(&points), cube.codes(&points)));
            for (code, point) in cube.codes(&points).into_iter().zip(&points) {
                prop_assert_eq!(cube.cells(&[*point]), [PackedCell::from_code(code)]);
                let offset = (point.as_dvec3() - cube.min).to_array();
                for (index, offset) in morton::decode(code).into_iter().zip(offset) {
                    let lower = f64::from(index) * cell_edge;
                    let last = index == FINEST_CELLS - 1;
                    prop_assert!(lower <= offset &&
                        (offset < lower + cell_edge || last && offset <= lower + cell_edge));
                }
            }
        }

        /// Points at rest are in the same cells, whatever else there is, and the cube is as small as possible.
        #[test]
        fn cells_of_one_size_coincide_for_all_clouds(
            resting in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 2..20),
            other in prop::array::uniform3(-1e3f32..1e3), scale in -60i32..60) {
            let scale = 2f32.powi(scale);
            let mut points: Vec<Vec3> = resting.into_iter().map(|point| Vec3::from_array(point) * scale).collect();
            let alone = Cube::around(&points).unwrap();
            let bounds = Aabb::from_points(&points);
            let extent = (bounds.max - bounds.min).max_element();
            prop_assume!(extent > 0.0);
            prop_assert!(alone.edge >= extent && alone.edge <= 4.0 * extent, "{alone:?} for {extent}");
            points.push(Vec3::from_array(other) * scale);
            let together = Cube::around(&points).unwrap();
            let levels_more = (together.edge / alone.edge).log2() as u32;
            for level in 1..=10 {
                let center = |cube: &Cube, level: u32, point| {
                    let cell = cube.cells(&[point])[0].coordinates().map(|at| at >> (LEVELS - level));
                    cube.cell_center(level, cell)
                };
                for &point in &points[..points.len() - 1] {
                    let [a, b] = [center(&alone, level, point), center(&together, level + levels_more, point)];
                    // Corners of cubes are rounded to f32 for centres.
                    let rounding = 2.0 * f32::EPSILON * together.edge;
                    prop_assert!((a - b).abs().max_element() <= rounding, "{a} {b}");
                }
            }
        }
    }
}
