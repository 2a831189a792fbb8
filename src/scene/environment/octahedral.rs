//! A map of all directions: the sphere unfolded from an octahedron onto a square (Praun and Hoppe 2003).
//!
//! Texels are about equally large everywhere, and between any two there is a straight path: so colours are blended
//! between four texels of one square, by the same few operations in both renderers. Around the square is a border of
//! one texel, which repeats the texels beyond the edge on the sphere: no test for the edge is needed.
//!
//! Directions are in the environment's axes: y is up.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Texels around the square.
const BORDER: usize = 1;

/// Linear light from all directions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Octahedral {
    edge: usize,
    /// Rows from above, with the border.
    texels: Vec<Vec3>,
}

impl Octahedral {
    /// Creates an octahedral map with `edge` texels along an edge of the square; `light` is evaluated at the centre of
    /// each.
    pub(super) fn new(edge: usize, light: impl Fn(Vec3) -> Vec3 + Sync) -> Self {
        let stride = edge + 2 * BORDER;
        let mut texels = vec![Vec3::ZERO; stride * stride];
        texels.par_chunks_mut(stride).enumerate().for_each(|(row, texels)| {
            for (column, texel) in texels.iter_mut().enumerate() {
                let [x, y] = within(edge, column, row);
                *texel = light(direction_of(edge, x, y));
            }
        });
        Self { edge, texels }
    }

    pub(super) fn edge(&self) -> usize {
        self.edge
    }

    /// The texels with the border, row after row.
    pub(super) fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// Half as many texels along an edge, each the mean of four. Precondition: an even number of them.
    pub(super) fn halved(&self) -> Self {
        let edge = self.edge / 2;
        let stride = edge + 2 * BORDER;
        let texel = |column: usize, row: usize| {
            let [x, y] = within(edge, column, row);
            let four = [[0, 0], [1, 0], [0, 1], [1, 1]];
            four.map(|[right, down]| self.texel(2 * x + right, 2 * y + down))
                .iter()
                .sum::<Vec3>()
                * 0.25
        };
        let texels = (0..stride * stride).map(|place| texel(place % stride, place / stride));
        Self {
            edge,
            texels: texels.collect(),
        }
    }

    /// The texel of a column and a row of the square.
    fn texel(&self, x: usize, y: usize) -> Vec3 {
        self.texels[(self.edge + 2 * BORDER) * (y + BORDER) + x + BORDER]
    }

    /// Returns the light from a direction of any length but 0, interpolated between the centres of four texels.
    pub(super) fn at(&self, direction: Vec3) -> Vec3 {
        let place = (square_of(direction) * 0.5 + 0.5) * self.edge as f32 + (BORDER as f32 - 0.5);
        let first = place.floor();
        let Vec2 { x, y } = place - first;
        let stride = self.edge + 2 * BORDER;
        let corner = stride * first.y as usize + first.x as usize;
        let row = |start: usize| self.texels[start].lerp(self.texels[start + 1], x);
        row(corner).lerp(row(corner + stride), y)
    }

    /// Each direction with its light and its share of the sphere.
    pub(super) fn shares(&self) -> impl Iterator<Item = (Vec3, Vec3, f32)> {
        let edge = self.edge;
        let places = (0..edge * edge).map(move |place| (place % edge, place / edge));
        // The solid angle of a texel of the unfolded octahedron is proportional to its distance to the power of -3,
        // since all faces are equally far from the centre. The other factors are the same for all.
        let solid_angle = move |x: usize, y: usize| unfolded(edge, x, y).length().powi(-3);
        let all: f64 = places.clone().map(|(x, y)| f64::from(solid_angle(x, y))).sum();
        places.map(move |(x, y)| {
            let share = f64::from(solid_angle(x, y)) / all;
            (direction_of(edge, x, y), self.texel(x, y), share as f32)
        })
    }
}

/// Returns the texel of the square that a position with the border repeats: beyond an edge the sphere continues at the
/// same edge, mirrored at its midpoint.
fn within(edge: usize, column: usize, row: usize) -> [usize; 2] {
    let (x, y) = (column as isize - BORDER as isize, row as isize - BORDER as isize);
    let last = edge as isize - 1;
    let (beyond_x, beyond_y) = (x < 0 || x > last, y < 0 || y > last);
    let [x, y] = match (beyond_x, beyond_y) {
        (false, false) => [x, y],
        (true, false) => [x.clamp(0, last), last - y],
        (false, true) => [last - x, y.clamp(0, last)],
        (true, true) => [last - x.clamp(0, last), last - y.clamp(0, last)],
    };
    [x as usize, y as usize]
}

/// Returns the position of the centre of a texel on the octahedron |x| + |y| + |z| = 1.
fn unfolded(edge: usize, x: usize, y: usize) -> Vec3 {
    let place = (Vec2::new(x as f32, y as f32) + 0.5) * (2.0 / edge as f32) - 1.0;
    let up = 1.0 - place.x.abs() - place.y.abs();
    let folded = if up < 0.0 {
        (Vec2::ONE - Vec2::new(place.y, place.x).abs()) * Vec2::ONE.copysign(place)
    } else {
        place
    };
    Vec3::new(folded.x, up, folded.y)
}

fn direction_of(edge: usize, x: usize, y: usize) -> Vec3 {
    unfolded(edge, x, y).normalize()
}

/// Returns the position of a direction on the square, from -1 to 1 along both edges.
fn square_of(direction: Vec3) -> Vec2 {
    let on_octahedron = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let place = Vec2::new(on_octahedron.x, on_octahedron.z);
    if on_octahedron.y < 0.0 {
        (Vec2::ONE - Vec2::new(place.y, place.x).abs()) * Vec2::ONE.copysign(place)
    } else {
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_and_directions_round_trip() {
        let map = Octahedral::new(16, |direction| direction);
        for (direction, texel, _) in map.shares() {
            assert!(direction.distance(texel) < 1e-6);
            assert!(map.at(direction).distance(texel) < 1e-5, "{direction}");
        }
    }

    /// Also across edges: a step between neighbouring directions is a small step of light.
    #[test]
    fn light_is_continuous_over_the_whole_sphere() {
        let map = Octahedral::new(64, |direction| direction);
        // Across an edge of the octahedron four texels blend to half a texel below it, 1/64, which appears up to √3
        // times as large from the centre of a face.
        let max = 3f32.sqrt() / 64.0;
        for step in 0..20_000 {
            let y = 1.0 - 2.0 * (step as f32 + 0.5) / 20_000.0;
            let angle = 2.399_963 * step as f32;
            let ring = (1.0 - y * y).sqrt();
            let direction = Vec3::new(ring * angle.cos(), y, ring * angle.sin());
            assert!(map.at(direction).distance(direction) < max, "{direction}");
        }
    }

    #[test]
    fn texel_weights_match_solid_angles() {
        let map = Octahedral::new(64, |_| Vec3::ONE);
        // The mean of the square of each coordinate over the sphere is a third; of the fourth power a fifth.
        let mean = |value: fn(Vec3) -> f32| map.shares().map(|(d, _, share)| value(d) * share).sum::<f32>();
        assert!((mean(|_| 1.0) - 1.0).abs() < 1e-4);
        for value in [|d: Vec3| d.x * d.x, |d: Vec3| d.y * d.y, |d: Vec3| d.z * d.z] {
            assert!((mean(value) - 1.0 / 3.0).abs() < 1e-3);
        }
        assert!((mean(|d| d.y.powi(4)) - 0.2).abs() < 1e-3);
        assert!(mean(|d| d.y).abs() < 1e-4);
    }

    #[test]
    fn a_halved_map_preserves_its_light() {
        // The four averaged texels do not have quite the same solid angle: that is a second-order error, 3e-3 for 32
        // texels along an edge and a quarter of it for twice as many.
        let map = Octahedral::new(64, Vec3::abs);
        let mean = |map: &Octahedral| map.shares().map(|(_, light, share)| light * share).sum::<Vec3>();
        assert!(mean(&map).distance(mean(&map.halved())) < 1e-3);
        assert_eq!(map.halved().edge(), 32);
    }
}
