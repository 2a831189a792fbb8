//! Robust normal estimation: a few points far off the surface do not turn the normals.
//!
//! How it works: principal components minimise the *squares* of the distances to the plane, so that one point far off
//! outweighs all others. Here the plane is fitted iteratively, each point weighted by `1 / (1 + (r / s)²)` with its
//! distance `r` from the previous plane (iteratively reweighted least squares with Cauchy's weights; Holland and Welsch
//! 1977). The scale `s` is a multiple of the weighted mean of these distances, so that it follows the noise of the
//! neighbourhood and shrinks as outliers lose their weight.
//!
//! When it wins: over plain principal components where some points are far off the surface, and next to edges, where
//! the points of the other face count for less. Noise common to all points is best averaged out with equal weights:
//! there, and where the surface is curved and free of noise, this is a few percent worse. It takes several times as
//! long.
//!
//! Weights by the distance of the neighbours (a Gaussian) were measured as well: they gain on curved surfaces without
//! noise and lose with any, as fewer points count. So do weights that fall off faster, and a scale from the median.

use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{PointTree, SlotPoint};
use crate::math::SymmetricMat3;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Fits after the one with equal weights.
const ROUNDS: usize = 4;

/// The distance with half the weight, as a multiple of the weighted mean distance. Gaussian noise has its mean at 0.8
/// standard deviations, so half the weight is at three.
const SCALE: f64 = 3.6;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 9;

/// Fits the planes of points from `first_slot` on again, starting from their `normals`. Slots in `without_plane`
/// (ascending) stay.
pub(in crate::analysis) fn refine(
    tree: &PointTree,
    neighbours: &Neighbours,
    first_slot: usize,
    without_plane: &[u32],
    normals: &mut [Vec3],
) {
    normals
        .par_chunks_mut(POINTS_PER_TASK)
        .enumerate()
        .for_each(|(task, normals)| {
            let mut samples = Vec::with_capacity(neighbours.per_point() + 1);
            for (normal, slot) in normals.iter_mut().zip(first_slot + POINTS_PER_TASK * task..) {
                if without_plane.binary_search(&(slot as u32)).is_err() {
                    gather(tree.points(), slot, neighbours.of(slot), &mut samples);
                    *normal = refit(&mut samples, normal.as_dvec3()).as_vec3();
                }
            }
        });
}

/// A point of a neighbourhood.
#[derive(Debug, Clone, Copy)]
struct WeightedOffset {
    /// From the point whose plane it is, in scaled units.
    offset: DVec3,
    weight: f64,
}

/// Sets `samples` to a point and its neighbours, of equal weight.
fn gather(points: &[SlotPoint], slot: usize, list: &[u32], samples: &mut Vec<WeightedOffset>) {
    let center = points[slot].position;
    let others = list.iter().map(|&other| points[other as usize].position);
    samples.clear();
    samples.extend(others.chain([center]).map(|position| WeightedOffset {
        offset: (position - center).as_dvec3(),
        weight: 1.0,
    }));
}

/// The normal of the plane through `samples`, starting from `normal`.
fn refit(samples: &mut [WeightedOffset], mut normal: DVec3) -> DVec3 {
    let mut mean = weighted_mean(samples);
    for _ in 0..ROUNDS {
        let distance = |sample: &WeightedOffset| normal.dot(sample.offset - mean).abs();
        let (sum, weights) = samples.iter().fold((0.0, 0.0), |(sum, weights), sample| {
            (sum + sample.weight * distance(sample), weights + sample.weight)
        });
        let scale = SCALE * sum / weights;
        if scale == 0.0 {
            // All points lie on the plane.
            break;
        }
        for sample in &mut *samples {
            let ratio = distance(sample) / scale;
            sample.weight = 1.0 / (1.0 + ratio * ratio);
        }
        mean = weighted_mean(samples);
        normal = covariance(samples, mean).smallest_eigenvector();
    }
    normal
}

fn weighted_mean(samples: &[WeightedOffset]) -> DVec3 {
    let (sum, weights) = samples.iter().fold((DVec3::ZERO, 0.0), |(sum, weights), sample| {
        (sum + sample.weight * sample.offset, weights + sample.weight)
    });
    sum / weights
}

/// The covariance of the samples about `mean`, not divided by their weights.
fn covariance(samples: &[WeightedOffset], mean: DVec3) -> SymmetricMat3 {
    samples.iter().fold(SymmetricMat3::default(), |sum, sample| {
        let d = sample.offset - mean;
        let w = sample.weight * d;
        SymmetricMat3 {
            xx: sum.xx + w.x * d.x,
            xy: sum.xy + w.x * d.y,
            xz: sum.xz + w.x * d.z,
            yy: sum.yy + w.y * d.y,
            yz: sum.yz + w.y * d.z,
            zz: sum.zz + w.z * d.z,
        }
    })
}
