//! Cells that all frames of a sequence share.
//!
//! **How it works.** The cube around the first frame is one cell of the lattice. Halves of it are its finer cells. Two
//! cells along each axis are one coarser cell: the cube is its lower half first, its upper half next, and so on by
//! turns, so that coarser cells reach in all directions. The cube of any frame is the smallest block of two cells along
//! each axis that contains it: its own cube for the first frame, to the last bit. Whatever else changes, points at rest
//! stay in the same cells, and no frame needs to know its neighbours.
//!
//! **Why not a lattice fixed in the coordinates of the file.** It was measured: a cloud meets such a lattice anywhere,
//! so its cells are up to twice as large as those of its own cube, and images change when the same cloud is moved or
//! scaled (`docs/notebook/errors.md`).
//!
//! **When it loses.** A frame slightly larger than the first has a cube two or four times as large: one or two more of
//! the 21 levels are nearly empty.

use super::{Aabb, Cube};
use glam::DVec3;

/// Maximum doublings or halvings between the first cube and another. Cells are worth sharing as long as both clouds
/// have points in them; a frame of another order of magnitude has its own cube.
const MAX_LEVELS_AWAY: i32 = 40;

/// The cells of a sequence, of all sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// One of its cells.
    reference: Cube,
}

impl Lattice {
    /// The lattice that has this cube as one of its cells.
    pub fn of(reference: Cube) -> Self {
        Self { reference }
    }

    /// Returns the smallest cube around a box whose octants and all smaller cells are of this lattice; the
    /// [fitted cube](Cube::around_box) of points that all coincide and of boxes of another order of magnitude. `None`
    /// for an empty box.
    pub fn cube_around(&self, bounds: &Aabb) -> Option<Cube> {
        let fitted = Cube::around_box(bounds)?;
        if bounds.min == bounds.max {
            return Some(fitted);
        }
        // Half an edge is at least half of the longest side, and less than all of it is always enough.
        let smallest = (f64::from(fitted.edge) / f64::from(self.reference.edge)).log2().floor() as i32 - 1;
        let mut sizes = smallest..=smallest + 2;
        Some(sizes.find_map(|level| self.block(level, bounds)).unwrap_or(fitted))
    }

    /// Returns the doublings from the edge of the reference cube to that of another cube; 0 for the cube of the first
    /// frame.
    pub fn level_of(&self, cube: &Cube) -> i32 {
        (f64::from(cube.edge) / f64::from(self.reference.edge)).log2().round() as i32
    }

    /// Returns the block of two cells of a level along each axis that contains a box, if there is one.
    fn block(&self, level: i32, bounds: &Aabb) -> Option<Cube> {
        let edge = self.reference.edge * 2f32.powi(level + 1);
        if level.abs() > MAX_LEVELS_AWAY || !edge.is_normal() {
            return None;
        }
        let [min, max] = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
        let one_cell = self.corner_below(level + 1, min);
        let two_cells = self.corner_below(level, min);
        // Upper faces belong to the last cells.
        let end = DVec3::splat(f64::from(edge));
        let is_one_cell = max.cmple(one_cell + end);
        let is_two_cells = max.cmple(two_cells + end);
        (is_one_cell | is_two_cells).all().then(|| Cube {
            min: DVec3::select(is_one_cell, one_cell, two_cells),
            edge,
        })
    }

    /// Smallest corner of the cell of a level that contains a place.
    fn corner_below(&self, level: i32, place: DVec3) -> DVec3 {
        let edge = f64::from(self.reference.edge) * 2f64.powi(level);
        let border = self.reference.min - f64::from(self.reference.edge) * cells_below(level);
        let corner = ((place - border) / edge).floor() * edge + border;
        // A place on a border may have been rounded up to it.
        corner - DVec3::select(corner.cmpgt(place), DVec3::splat(edge), DVec3::ZERO)
    }
}

/// Distance from the reference cube down to the next border of a level, in its edges: 0, 0, 2, 2, 10, 10, 42, …
fn cells_below(level: i32) -> f64 {
    match level / 2 {
        pairs @ 1.. => 2.0 * (4f64.powi(pairs) - 1.0) / 3.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::morton::{FINEST_CELLS, LEVELS};
    use glam::Vec3;
    use proptest::prelude::*;

    fn unit() -> Lattice {
        Lattice::of(Cube {
            min: DVec3::ZERO,
            edge: 1.0,
        })
    }

    fn around(lattice: &Lattice, min: Vec3, max: Vec3) -> Cube {
        lattice.cube_around(&Aabb { min, max }).unwrap()
    }

    #[test]
    fn cubes_grow_to_both_sides() {
        // Cells of edge 2 have borders at -2, 0, 2; those of edge 4 at -2, 2; of edge 8 at -2, 6; of edge 16 at -10, 6.
        let cubes = [
            ([0.0, 1.0], (0.0, 1.0)),
            ([0.2, 0.4], (0.0, 0.5)),
            ([0.3, 0.6], (0.25, 0.5)),
            ([-0.1, 1.0], (-1.0, 2.0)),
            ([-0.1, 1.1], (-2.0, 4.0)),
            ([0.0, 1.1], (0.0, 2.0)),
            ([-1.0, 3.0], (-2.0, 8.0)),
            ([-9.0, 6.0], (-10.0, 16.0)),
        ];
        for ([min, max], (corner, edge)) in cubes {
            let cube = around(&unit(), Vec3::splat(min), Vec3::splat(max));
            assert_eq!((cube.min, cube.edge), (DVec3::splat(corner), edge), "{min} to {max}");
        }
    }

    #[test]
    fn the_first_cube_is_fitted_and_has_level_zero() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 5e6 - 1.0
        };
        for _ in 0..1000 {
            let corners = [0; 2].map(|_| Vec3::new(random(), random(), random()));
            let bounds = Aabb::from_points(&corners);
            let fitted = Cube::around_box(&bounds).unwrap();
            let lattice = Lattice::of(fitted);
            assert_eq!(lattice.cube_around(&bounds), Some(fitted));
            assert_eq!(lattice.level_of(&fitted), 0);
        }
    }

    #[test]
    fn clouds_of_another_magnitude_have_their_own_cubes() {
        for edge in [1e-30f32, 1e30] {
            let cube = around(&unit(), Vec3::ZERO, Vec3::new(0.0, edge, 0.0));
            assert_eq!((cube.min, cube.edge), (DVec3::ZERO, edge));
        }
        let lone = around(&unit(), Vec3::ONE, Vec3::ONE);
        assert_eq!(Some(lone), Cube::around(&[Vec3::ONE]));
        assert_eq!(unit().cube_around(&Aabb::EMPTY), None);
    }

    proptest! {
        /// Cells of any size are those of the first cube's lattice: whole numbers of them lie between any two corners.
        #[test]
        fn all_cubes_share_their_cells(
            min in prop::array::uniform3(-5f32..5.0),
            extent in prop::array::uniform3(0f32..20.0),
            first in prop::array::uniform3(-3f32..3.0),
            edge in 0.1f32..4.0,
        ) {
            prop_assume!(extent.iter().any(|&side| side > 1e-3));
            let reference = Cube { min: Vec3::from_array(first).as_dvec3(), edge };
            let lattice = Lattice::of(reference);
            let (min, extent) = (Vec3::from_array(min), Vec3::from_array(extent));
            let bounds = Aabb { min, max: min + extent };
            let cube = lattice.cube_around(&bounds).unwrap();
            let end = cube.min + f64::from(cube.edge);
            prop_assert!(cube.min.cmple(bounds.min.as_dvec3()).all() && bounds.max.as_dvec3().cmple(end).all());
            // Less than four times the longest side, and no smaller block contains the box.
            prop_assert!(f64::from(cube.edge) <= 4.0 * f64::from(extent.max_element()) * 1.000_001);
            let level = lattice.level_of(&cube);
            prop_assert_eq!(lattice.block(level - 2, &bounds), None);
            // All its cells of half its edge or less, by the distances of their borders.
            let octant = f64::from(cube.edge) / 2.0;
            let borders = reference.min - f64::from(edge) * cells_below(level - 1);
            let apart = (cube.min - borders) / octant;
            prop_assert!((apart - apart.round()).abs().max_element() < 1e-9, "{apart}");
        }

        /// Two clouds that have points in common have them in the same finest cells that both have.
        #[test]
        fn common_points_are_in_common_cells(
            common in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 2..20),
            far in prop::array::uniform3(-9f32..9.0),
        ) {
            let points: Vec<Vec3> = common.into_iter().map(Vec3::from_array).collect();
            let more: Vec<Vec3> = points.iter().copied().chain([far.into()]).collect();
            let small = Cube::around(&points).unwrap();
            let lattice = Lattice::of(small);
            let large = lattice.cube_around(&Aabb::from_points(&more)).unwrap();
            let level = lattice.level_of(&large);
            prop_assume!((0..=8).contains(&level));
            // A border of the small cube is one of the large cube's cells.
            let cell = f64::from(small.edge) / f64::from(FINEST_CELLS >> level);
            let corner = ((small.min - large.min) / cell).round().as_u64vec3().to_array();
            let (in_small, in_large) = (small.cells(&points), large.cells(&more));
            for (few, many) in in_small.iter().zip(&in_large) {
                for (axis, corner) in corner.into_iter().enumerate() {
                    let few = u64::from(few.coordinate(axis, LEVELS - level as u32));
                    let many = u64::from(many.coordinate(axis, LEVELS));
                    let last = u64::from((FINEST_CELLS >> level) - 1);
                    // Points on the upper face of the small cube are in its last cells.
                    prop_assert!(many == corner + few || few == last && many == corner + few + 1);
                }
            }
        }
    }
}
