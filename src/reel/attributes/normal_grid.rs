//! Triangles of the refined octahedron as positions on a plane, where adjacent triangles are close to each other.
//!
//! How it works: the index of a direction ([`quantise_direction`](crate::cloud::quantise_direction)) is a path from
//! triangle to triangle. Following it with integer corners ends at a cell (u, v) of the face's grid of 2ˡ rows, and in
//! its lower or upper half. The eight faces are then unfolded to a square as octahedral maps are: those above z = 0 in
//! the centre, the others folded outwards over its corners. Centroids of triangles are stored in thirds of a cell, so
//! that everything stays in integers.

use crate::cloud::{largest_normal_error, quantised_normals};
use std::sync::OnceLock;

/// A node without a normal.
pub(in crate::reel) const MISSING: [i16; 2] = [i16::MIN; 2];

/// Directions of one precision and their places.
#[derive(Debug)]
pub(in crate::reel) struct NormalGrid {
    /// Cells along half the square.
    half: i32,
    /// Position of each index, in thirds of a cell from the centre.
    places: Vec<[i16; 2]>,
    /// The place of each triangle, cells row by row and their halves; its unit vector, and that in 1024ths.
    by_cell: Vec<[i16; 2]>,
    units: Vec<glam::Vec3>,
    directions: Vec<[i16; 3]>,
    /// Cosine of the largest angle between a unit vector and the direction of its quantised position.
    min_cosine: f32,
}

impl NormalGrid {
    /// The grid of indices of 13, 15 or 17 bits.
    pub(in crate::reel) fn of(bits: u8) -> &'static Self {
        static GRIDS: [OnceLock<NormalGrid>; 3] = [const { OnceLock::new() }; 3];
        let which = usize::from(bits.clamp(13, 17) - 13) / 2;
        GRIDS[which].get_or_init(|| Self::new(13 + 2 * which as u32))
    }

    fn new(bits: u32) -> Self {
        let level = (bits - 3) / 2;
        let half = 1i32 << level;
        let mut grid = Self {
            half,
            places: Vec::with_capacity(1 << bits),
            by_cell: vec![MISSING; 8 * (half * half) as usize],
            units: vec![glam::Vec3::ZERO; 8 * (half * half) as usize],
            directions: Vec::new(),
            min_cosine: min_cosine(bits),
        };
        for index in 0..1u32 << bits {
            let place = place_of(index, level);
            let cell = grid.cell_of(place);
            grid.places.push(place);
            grid.by_cell[cell] = place;
            grid.units[cell] = quantised_normals(bits)[index as usize];
        }
        let in_1024ths = |unit: &glam::Vec3| unit.to_array().map(|along| (along * 1024.0).round() as i16);
        grid.directions = grid.units.iter().map(in_1024ths).collect();
        grid
    }

    /// The number of the triangle at a place: half cells along the first axis, four times those of half of the square,
    /// for each cell along the second one.
    pub(in crate::reel) fn cell_of(&self, [x, y]: [i16; 2]) -> usize {
        // Relative to the corner of the square: unsigned numbers are divided faster.
        let [x, y] = [x, y].map(|along| (i32::from(along) + 3 * self.half) as u32);
        2 * ((y / 3) as usize * 2 * self.half as usize + (x / 3) as usize) + usize::from(x % 3 == 2)
    }

    /// The place of an index. Precondition: it has no more bits than the grid.
    pub(in crate::reel) fn place(&self, index: u32) -> [i16; 2] {
        self.places[index as usize]
    }

    /// The direction at a place, in 1024ths.
    pub(in crate::reel) fn direction(&self, place: [i16; 2]) -> [i16; 3] {
        self.directions[self.cell_of(place)]
    }

    /// The place of a triangle. Precondition: the number is below 8 · half².
    pub(in crate::reel) fn place_of_cell(&self, cell: usize) -> [i16; 2] {
        self.by_cell[cell]
    }

    /// The unit vectors of all triangles, by their number.
    pub(in crate::reel) fn units(&self) -> &[glam::Vec3] {
        &self.units
    }

    /// The unit vector at a place.
    pub(in crate::reel) fn unit(&self, place: [i16; 2]) -> glam::Vec3 {
        self.units[self.cell_of(place)]
    }

    /// Returns true if a position is within the largest quantisation error of a unit vector.
    pub(in crate::reel) fn is_near(&self, place: [i16; 2], direction: glam::Vec3) -> bool {
        place != MISSING && self.unit(place).dot(direction) >= self.min_cosine
    }

    /// Cells along half the square.
    pub(in crate::reel) fn half(&self) -> i32 {
        self.half
    }
}

/// Rounded up, so that it is the same wherever cosines differ in their last bit.
fn min_cosine(bits: u32) -> f32 {
    let parts = f64::from(1 << 20);
    ((f64::from(largest_normal_error(bits)).cos() * parts).ceil() / parts) as f32
}

/// Returns the position of the centroid of a triangle.
fn place_of(index: u32, level: u32) -> [i16; 2] {
    let half = 1i32 << level;
    let mut corners = [[half, 0], [0, half], [0, 0]];
    for depth in (0..level).rev() {
        let [a, b, c] = corners;
        let center = |p: [i32; 2], q: [i32; 2]| [p[0].midpoint(q[0]), p[1].midpoint(q[1])];
        let [ab, bc, ca] = [center(a, b), center(b, c), center(c, a)];
        corners = match index >> (2 * depth) & 3 {
            0 => [ab, bc, ca],
            1 => [a, ab, ca],
            2 => [ab, b, bc],
            _ => [ca, bc, c],
        };
    }
    // The sum of three corners is three times their centroid.
    let [x, y] = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<i32>());
    let octant = index >> (2 * level);
    let [x, y] = if octant & 4 == 0 {
        [x, y]
    } else {
        [3 * half - y, 3 * half - x]
    };
    let signed = |along: i32, bit: u32| if octant >> bit & 1 == 0 { along } else { -along };
    [signed(x, 0) as i16, signed(y, 1) as i16]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_has_a_distinct_place() {
        for bits in [13, 15, 17] {
            let grid = NormalGrid::of(bits);
            let cells: std::collections::BTreeSet<usize> =
                (0..1 << bits).map(|index| grid.cell_of(grid.place(index))).collect();
            assert_eq!(cells.len(), 1 << bits);
            for (index, &unit) in (0..).zip(quantised_normals(u32::from(bits))) {
                assert_eq!(grid.unit(grid.place(index)), unit);
                assert_eq!(grid.place_of_cell(grid.cell_of(grid.place(index))), grid.place(index));
            }
        }
    }

    /// Triangles that are near on the square are near on the sphere; the other way round only away from its border.
    #[test]
    fn neighbouring_places_are_neighbouring_directions() {
        let grid = NormalGrid::of(13);
        for index in 0..1 << 13 {
            let [x, y] = grid.place(index);
            let unit = grid.unit([x, y]);
            let half = grid.half() as i16;
            for [dx, dy] in [[3, 0], [0, 3]] {
                let neighbor = [x + dx, y + dy];
                let is_inside = neighbor.iter().all(|along| along.div_euclid(3) < half);
                // The diagonals differ between quadrants.
                if is_inside && (x < 0) == (neighbor[0] < 0) && (y < 0) == (neighbor[1] < 0) {
                    assert!(unit.dot(grid.unit(neighbor)).acos().to_degrees() < 6.5, "{index}");
                }
            }
        }
    }
}
