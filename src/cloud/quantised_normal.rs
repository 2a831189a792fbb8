//! Unit vectors as indices of 13, 15 or 17 bits: the faces of an octahedron that is refined repeatedly (Botsch et al.
//! 2002 §4.1).
//!
//! How it works: three bits name the octant (x, y, z negative). Its face is a spherical triangle; halving its edges,
//! and putting the new corners back on the sphere, splits it into four, which two bits name: 0 is the central one, 1 to
//! 3 are at its corners. Five refinements make 13 bits, six 15, seven 17. Finer detail is encoded in lower bits, so an
//! index without them names the enclosing triangle, and one index serves every precision.
//!
//! A triangle stands for the direction of its centroid. The normal of the flat triangle, which the paper takes, is its
//! circumcentre, and at the corners of the octahedron, where triangles stay right-angled however small they are, that
//! is a point on the edge to a neighbour.
//!
//! When it wins: where something is computed for directions instead of points (light, footprints of splats), as a table
//! of all indices of 13 bits has 8192 entries; and where normals are stored. The octahedral coordinates of
//! [`super::oct_encode`] are quicker to decode, and more precise for their bits, but do not name the directions one by
//! one.

use glam::Vec3;
use std::sync::LazyLock;

/// Refinements of the finest indices.
const FINEST_LEVEL: u32 = 7;

/// Bits of the finest indices.
pub const FINEST_NORMAL_BITS: u32 = bits(FINEST_LEVEL);

/// Bits of an index after `level` refinements.
const fn bits(level: u32) -> u32 {
    3 + 2 * level
}

/// Triangles of the first octant, of all levels above the finest one after the other: the planes that part each from
/// the ones at its corners.
static PLANES: LazyLock<Vec<[Vec3; 3]>> = LazyLock::new(|| {
    let levels = (0..FINEST_LEVEL).flat_map(triangles);
    levels.map(|triangle| corner_planes(&triangle)).collect()
});

/// The directions of every level from 0 on.
static DIRECTIONS: LazyLock<Vec<Vec<Vec3>>> = LazyLock::new(|| {
    let directions_of = |level| {
        let first_octant: Vec<Vec3> = triangles(level)
            .iter()
            .map(|[a, b, c]| (*a + *b + *c).normalize())
            .collect();
        let mirrored = |octant: u32| {
            let signs = Vec3::from_array([0, 1, 2].map(|axis| sign(octant >> axis & 1)));
            first_octant.iter().map(move |&direction| signs * direction)
        };
        (0..8).flat_map(mirrored).collect()
    };
    (0..=FINEST_LEVEL).map(directions_of).collect()
});

fn sign(is_negative: u32) -> f32 {
    if is_negative == 0 { 1.0 } else { -1.0 }
}

/// The triangles of the first octant on a level, in the order of their indices.
fn triangles(level: u32) -> Vec<[Vec3; 3]> {
    let mut triangles = vec![[Vec3::X, Vec3::Y, Vec3::Z]];
    for _ in 0..level {
        triangles = triangles.iter().flat_map(parts).collect();
    }
    triangles
}

/// Returns the midpoints of the edges from the first corner to the second, on to the third, and back.
fn edge_centers([a, b, c]: &[Vec3; 3]) -> [Vec3; 3] {
    [(*a + *b).normalize(), (*b + *c).normalize(), (*c + *a).normalize()]
}

fn parts(triangle: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let [a, b, c] = *triangle;
    let [ab, bc, ca] = edge_centers(triangle);
    [[ab, bc, ca], [a, ab, ca], [ab, b, bc], [ca, bc, c]]
}

/// For each corner the plane through the origin that cuts its part off; the corner is on its positive side.
fn corner_planes(triangle: &[Vec3; 3]) -> [Vec3; 3] {
    let [ab, bc, ca] = edge_centers(triangle);
    [ab.cross(ca), bc.cross(ab), ca.cross(bc)]
}

/// The index of a direction after `level` refinements (7 at most): `3 + 2·level` bits. Length does not matter; zero and
/// NaN have some index.
pub fn quantise_direction(direction: Vec3, level: u32) -> u32 {
    let negative = |axis: usize| u32::from(direction[axis] < 0.0) << axis;
    let octant = negative(0) | negative(1) | negative(2);
    let direction = direction.abs();
    let mut path = 0;
    let mut level_start = 0;
    for depth in 0..level.min(FINEST_LEVEL) {
        let planes = &PLANES[level_start + path as usize];
        let corner = planes.iter().position(|plane| plane.dot(direction) > 0.0);
        path = path << 2 | corner.map_or(0, |corner| corner as u32 + 1);
        level_start += 1 << (2 * depth);
    }
    octant << (2 * level) | path
}

/// The finest index of a unit normal; [`FINEST_NORMAL_BITS`] bits.
pub fn quantise_normal(normal: Vec3) -> u32 {
    quantise_direction(normal, FINEST_LEVEL)
}

/// Reduces a finest index to `bits` bits.
pub fn coarser_normal(index: u32, bits: u32) -> u32 {
    index >> (FINEST_NORMAL_BITS - bits.min(FINEST_NORMAL_BITS))
}

/// The unit vectors of all indices of a level (7 at most), by index.
pub fn quantised_directions(level: u32) -> &'static [Vec3] {
    &DIRECTIONS[level.min(FINEST_LEVEL) as usize]
}

/// The unit vectors of all indices with this many bits: 13, 15 or 17, or another odd number from 3 on.
pub fn quantised_normals(bits: u32) -> &'static [Vec3] {
    quantised_directions(bits.saturating_sub(3) / 2)
}

/// The largest angle between a unit vector and the decoded direction of its index, in radians: no place in a triangle
/// is farther than a corner, and 2.5° at 13 bits.
pub fn largest_normal_error(bits: u32) -> f32 {
    LARGEST_ERRORS[(bits.saturating_sub(3) / 2).min(FINEST_LEVEL) as usize]
}

static LARGEST_ERRORS: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let largest = |level| {
        let chords = triangles(level).into_iter().flat_map(|corners| {
            let center = corners.iter().sum::<Vec3>().normalize();
            corners.map(|corner| (corner - center).length())
        });
        // Allowance for the rounding of corners and indices.
        1e-5 + 2.0 * (0.5 * chords.fold(0f32, f32::max)).asin()
    };
    (0..=FINEST_LEVEL).map(largest).collect()
});

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn angle(a: Vec3, b: Vec3) -> f32 {
        // The chord is exact for small angles, where acos is not.
        2.0 * (0.5 * (a - b).length()).min(1.0).asin()
    }

    /// Directions all over the sphere, on a golden spiral.
    fn spiral(count: u32) -> impl Iterator<Item = Vec3> {
        let golden_angle = std::f32::consts::PI * (3.0 - 5f32.sqrt());
        (0..count).map(move |i| {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
            let (sin, cos) = (golden_angle * i as f32).sin_cos();
            let ring = (1.0 - z * z).sqrt();
            Vec3::new(ring * cos, ring * sin, z)
        })
    }

    #[test]
    fn every_index_of_every_precision_round_trips() {
        for bits in [13, 15, 17] {
            let normals = quantised_normals(bits);
            assert_eq!(normals.len(), 1 << bits);
            for (index, &normal) in normals.iter().enumerate() {
                let finest = quantise_normal(normal);
                assert_eq!(coarser_normal(finest, bits), index as u32, "{bits} {normal}");
            }
        }
    }

    /// Dropping low bits names the triangle around: its direction is the precise one but for the coarser precision.
    #[test]
    fn masking_bits_gives_the_coarser_triangle() {
        for (index, &normal) in quantised_normals(17).iter().enumerate() {
            for bits in [15, 13] {
                let coarser = quantised_normals(bits)[coarser_normal(index as u32, bits) as usize];
                assert_eq!(
                    coarser_normal(index as u32, bits),
                    quantise_direction(normal, (bits - 3) / 2)
                );
                assert!(angle(coarser, normal) <= largest_normal_error(bits));
            }
        }
    }

    /// The central part of a triangle has its direction, so an index with zeros for low bits can stand for it.
    #[test]
    fn central_subtriangles_have_the_direction_of_their_parent() {
        for (index, &normal) in quantised_normals(13).iter().enumerate() {
            let center = quantised_normals(17)[index << 4];
            assert!(angle(normal, center).to_degrees() < 0.03, "{normal} {center}");
        }
    }

    /// Against the nearest of all directions, found by looking at each: how much is lost by taking the triangle around.
    #[test]
    fn errors_are_close_to_those_of_the_nearest_direction() {
        let all = quantised_normals(13);
        let (mut sum, mut nearest_sum, mut largest) = (0.0, 0.0, 0f32);
        let count = 3000;
        for unit in spiral(count) {
            let error = angle(all[coarser_normal(quantise_normal(unit), 13) as usize], unit);
            let nearest = all
                .iter()
                .fold(f32::MAX, |min, &normal| min.min((normal - unit).length_squared()));
            sum += f64::from(error);
            nearest_sum += f64::from(nearest.sqrt());
            largest = largest.max(error);
        }
        let mean_deg = (sum / f64::from(count)).to_degrees();
        assert!(sum <= 1.05 * nearest_sum, "{sum} beside {nearest_sum}");
        assert!((0.7..1.0).contains(&mean_deg), "{mean_deg}°");
        assert!(largest <= largest_normal_error(13), "{}°", largest.to_degrees());
    }

    #[test]
    fn every_two_bits_halve_the_error() {
        for (bits, mean_max_deg) in [(13, 1.0), (15, 0.5), (17, 0.25)] {
            let all = quantised_normals(bits);
            let (mut sum, mut largest) = (0.0, 0f32);
            for unit in spiral(100_000) {
                let error = angle(all[coarser_normal(quantise_normal(unit), bits) as usize], unit);
                sum += f64::from(error);
                largest = largest.max(error);
            }
            let mean_deg = (sum / 1e5).to_degrees();
            assert!(mean_deg < mean_max_deg, "{bits} bits: {mean_deg}°");
            let bound = largest_normal_error(bits);
            let largest_deg = largest.to_degrees();
            assert!((0.6 * bound..=bound).contains(&largest), "{bits} bits: {largest_deg}°");
        }
    }

    #[test]
    fn degenerate_directions_have_an_index() {
        for odd in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, -Vec3::splat(1e-45)] {
            assert!(quantise_normal(odd) < 1 << FINEST_NORMAL_BITS);
        }
    }

    proptest! {
        #[test]
        fn length_does_not_matter(unit in prop::array::uniform3(-1f32..1.0), scale in -30i32..30) {
            let unit = Vec3::from_array(unit);
            prop_assume!(unit.length() > 1e-3);
            prop_assert_eq!(quantise_normal(unit), quantise_normal(unit * 2f32.powi(scale)));
        }
    }
}
