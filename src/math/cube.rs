//! The cube that encloses a cloud, and the cells its points fall into.

use super::{
    Aabb,
    morton::{self, FINEST_CELLS, LEVELS, PackedCell},
};
use fearless_simd::{Level, dispatch};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Edge of the cube around points that all coincide, in scene units, unless they lie so far out that f32 cannot tell
/// the ends of such an edge apart.
const LONE_EDGE: f32 = 1.0;

/// The cube that Morton codes and octrees divide: every cell of every level is a cube too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cube {
    /// Smallest corner, relative to the sequence origin. In f64, as a corner of a [`Lattice`](super::Lattice) may lie
    /// between two f32.
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

    /// Returns the bounding cube whose smallest corner is that of the bounding box of `points` and whose edge is the
    /// longest of the box, rounded up; `None` for no points.
    ///
    /// Points that coincide sit at the centre of a cube of edge 1 (or of 2⁻²⁰ of their distance from the origin, if
    /// that is more). A box wider than the largest f32 gets that as its edge.
    pub fn around(points: &[Vec3]) -> Option<Self> {
        Self::around_box(&Aabb::from_points(points))
    }

    /// [`Cube::around`] points with these bounds.
    pub fn around_box(bounds: &Aabb) -> Option<Self> {
        if bounds.is_empty() {
            return None;
        }
        let min = bounds.min.as_dvec3();
        let longest = (bounds.max.as_dvec3() - min).max_element();
        if longest == 0.0 {
            let edge = LONE_EDGE.max(bounds.max.abs().max_element() / (1 << 20) as f32);
            return Some(Self {
                min: min - DVec3::splat(0.5 * f64::from(edge)),
                edge,
            });
        }
        let nearest = longest.min(f64::from(f32::MAX)) as f32;
        let edge = if f64::from(nearest) < longest {
            nearest.next_up().min(f32::MAX)
        } else {
            nearest
        };
        Some(Self { min, edge })
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

    /// The finest cells that hold `points`. Precondition: points inside this cube.
    ///
    /// Cells are half-open: a point on the border of two belongs to the upper one, except for the upper faces of the
    /// cube, which belong to the last cells.
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

    /// The index of the cell at a distance of `offset` from the lower face, which must not be negative.
    #[inline(always)]
    fn index(&self, offset: f64) -> u64 {
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
    fn the_longest_edge_rules_and_extremes_are_inside() {
        let cube = Cube::around(&[Vec3::new(-1.0, 2.0, 0.0), Vec3::new(0.5, 2.25, 0.125)]).unwrap();
        assert_eq!(cube.min, DVec3::new(-1.0, 2.0, 0.0));
        assert_eq!(cube.edge, 1.5);
        assert_eq!(Cube::around(&[]), None);
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

    proptest! {
        /// Points on the borders of cells, where a reciprocal misplaces: for many edges and levels.
        #[test]
        fn borders_belong_to_the_upper_cell(edge in 1u32..10_000, exponent in -30i32..30, level in 1u32..=12,
            index in 0u32..4096) {
            let index = index & ((1 << level) - 1);
            let edge = edge as f32 * 2f32.powi(exponent);
            let border = f64::from(edge) * f64::from(index) / f64::from(1u32 << level);
            prop_assume!(f64::from(border as f32) == border);
            let points = [Vec3::ZERO, Vec3::splat(edge), Vec3::new(border as f32, 0.0, 0.0)];
            let codes = Cube::around(&points).unwrap().codes(&points);
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
    }
}
