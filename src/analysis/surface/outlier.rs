//! Outlier detection: isolated points next to a surface.
//!
//! How it works: a point is an *outlier* if it is far from its neighbours, relative to their own spacing, and off the
//! plane that fits them best. Neither criterion alone suffices. A point of a sparse wall next to a dense one is far
//! from the others, but on their plane; a point of an edge is off the plane, but near.
//!
//! When it wins: over a bound on distances alone (statistical outlier removal), which takes sparse parts of a cloud for
//! outliers where others are dense. Points of image-based reconstruction are like that: crowded where a texture is
//! rich, few on a wall, and wrong matches in mid-air.

use crate::analysis::DEFAULT_NEIGHBOURS;
use crate::analysis::search::neighbours::{Neighbours, nearest_neighbours};
use crate::math::SymmetricMat3;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Neighbours whose mean distance tells how far apart points are.
const NEAREST: usize = 6;

/// Minimum distance of an outlier from its neighbours, as a multiple of their spacing.
const FAR: f32 = 1.5;

/// Minimum distance of an outlier off the plane of its neighbours, as a fraction of its distance from them: 17°.
const OFF_PLANE: f32 = 0.3;

/// Number of outlier removal rounds: without the first ones, those next to them are found to be isolated as well.
const ROUNDS: usize = 2;

/// Returns the outlier mask of `positions` (finite), in their order. None are outliers where there are fewer than 13.
pub fn outliers(positions: &[Vec3]) -> Vec<bool> {
    let mut is_outlier = vec![false; positions.len()];
    for _ in 0..ROUNDS {
        let retained: Vec<usize> = (0..positions.len()).filter(|&at| !is_outlier[at]).collect();
        let places: Vec<Vec3> = retained.iter().map(|&at| positions[at]).collect();
        for (at, found) in retained.into_iter().zip(outlier_of(&places)) {
            is_outlier[at] = found;
        }
    }
    is_outlier
}

/// Returns the outliers of one round.
fn outlier_of(positions: &[Vec3]) -> Vec<bool> {
    let neighbours = nearest_neighbours(positions, DEFAULT_NEIGHBOURS);
    if neighbours.per_point() < DEFAULT_NEIGHBOURS {
        return vec![false; positions.len()];
    }
    let spacing = |at: usize| {
        let nearest = neighbours.of(at)[..NEAREST].iter();
        let sum: f32 = nearest
            .map(|&other| positions[other as usize].distance(positions[at]))
            .sum();
        sum / NEAREST as f32
    };
    let spacings: Vec<f32> = (0..positions.len()).into_par_iter().map(spacing).collect();
    let is_outlier = |at: usize| {
        // Of 3,517 points without noise, none passes both tests.
        spacings[at] > FAR * usual_spacing(&spacings, neighbours.of(at))
            && height_above(positions, &neighbours, at) > OFF_PLANE * spacings[at]
    };
    (0..positions.len()).into_par_iter().map(is_outlier).collect()
}

/// The median of the spacings of some points.
fn usual_spacing(spacings: &[f32], points: &[u32]) -> f32 {
    let mut of_points: Vec<f32> = points.iter().map(|&point| spacings[point as usize]).collect();
    let center = of_points.len() / 2;
    *of_points.select_nth_unstable_by(center, f32::total_cmp).1
}

/// Computes the distance of a point from the plane of its neighbours.
fn height_above(positions: &[Vec3], neighbours: &Neighbours, at: usize) -> f32 {
    let around = neighbours.of(at);
    let offset = |&other: &u32| (positions[other as usize] - positions[at]).as_dvec3();
    let mean = around.iter().map(offset).sum::<DVec3>() / around.len() as f64;
    let spread = around.iter().map(offset).fold(SymmetricMat3::default(), |sum, offset| {
        let d = offset - mean;
        SymmetricMat3 {
            xx: sum.xx + d.x * d.x,
            xy: sum.xy + d.x * d.y,
            xz: sum.xz + d.x * d.z,
            yy: sum.yy + d.y * d.y,
            yz: sum.yz + d.y * d.z,
            zz: sum.zz + d.z * d.z,
        }
    });
    spread.smallest_eigenvector().dot(mean).abs() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of `edge`² points in the plane z = 0, `step` apart, from `from` on.
    fn square(from: Vec3, edge: usize, step: f32) -> Vec<Vec3> {
        let at = |at: usize| from + step * Vec3::new((at % edge) as f32, (at / edge) as f32, 0.0);
        (0..edge * edge).map(at).collect()
    }

    fn found(positions: &[Vec3]) -> Vec<usize> {
        let is_outlier = outliers(positions);
        assert_eq!(is_outlier.len(), positions.len());
        (0..positions.len()).filter(|&at| is_outlier[at]).collect()
    }

    #[test]
    fn only_floating_points_are_outliers() {
        let mut positions = square(Vec3::ZERO, 20, 1.0);
        positions.extend([
            Vec3::new(7.3, 8.1, 4.0),
            Vec3::new(15.0, 3.0, -9.0),
            Vec3::new(3.0, 30.0, 20.0),
        ]);
        assert_eq!(found(&positions), [400, 401, 402]);
        // Anywhere and at any scale.
        let moved: Vec<Vec3> = positions
            .iter()
            .map(|&place| 1e-3 * place + Vec3::new(5.0, -2.0, 1.0))
            .collect();
        assert_eq!(found(&moved), [400, 401, 402]);
    }

    #[test]
    fn sparse_surfaces_next_to_dense_ones_are_not_outliers() {
        let mut positions = square(Vec3::ZERO, 20, 0.1);
        // A wall with few points on it, the nearest of them ten times as far away as they are apart.
        positions.extend(square(Vec3::new(3.0, 0.0, 0.0), 6, 1.5));
        assert_eq!(found(&positions), Vec::<usize>::new());
    }

    #[test]
    fn edges_and_corners_are_not_outliers() {
        // Three faces of a cube.
        let face = square(Vec3::new(0.5, 0.5, 0.0), 12, 1.0);
        let mut positions = face.clone();
        positions.extend(face.iter().map(|place| Vec3::new(place.z, place.x, place.y)));
        positions.extend(face.iter().map(|place| Vec3::new(place.y, place.z, place.x)));
        assert_eq!(found(&positions), Vec::<usize>::new());
    }

    #[test]
    fn few_or_coincident_points_are_not_outliers() {
        assert_eq!(found(&[]), Vec::<usize>::new());
        assert_eq!(found(&square(Vec3::ZERO, 3, 1.0)), Vec::<usize>::new());
        assert_eq!(found(&[Vec3::ONE; 40]), Vec::<usize>::new());
    }
}
