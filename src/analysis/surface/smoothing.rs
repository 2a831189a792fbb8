//! Projection of points onto the surface around them: moving least squares.
//!
//! How it works: after Alexa et al. (2003), each point is moved along the normal of a local reference plane. That plane
//! is fitted to the neighbours, weighted by their distance from the point's projection onto it, which is found in
//! [`ROUNDS`] steps. Then a quadric over the plane is fitted with the same weights, and the point moves onto it. A
//! plane alone would shrink round objects: their points lie on one side of it.
//!
//! The neighbourhood is given in point spacings and holds the number of points that a disk of this radius has; so its
//! width follows the local point spacing. Weights end at the farthest neighbour.
//!
//! Points in a row, or in one place, stay where they are: they have no surface. Edges become round, as with any smooth
//! surface.
//!
//! When it wins: over normals from more neighbours where the positions themselves are noisy, which shows in silhouettes
//! and edge-on views whatever the normals.

use super::noise::Quadric;
use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{LANES, PointTree, SlotPoint};
use crate::math::SymmetricMat3;
use crate::progress::Progress;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Fits of the reference plane: with the second, the point has moved to where its weights are measured from.
const ROUNDS: usize = 3;

/// Neighbours at least and at most: a quadric has six coefficients.
const NEIGHBOURS: [f32; 2] = [8.0, 128.0];

/// Radius of the weights as a multiple of the distance to the farthest neighbour, which would count for nothing.
const REACH: f64 = 1.1;

/// Ratio of the variances along a surface below which points are a row.
const MIN_VARIANCE_RATIO: f64 = 0.01;

/// Consecutive slots whose neighbours are in memory at a time: whole buckets.
const POINTS_PER_BLOCK: usize = 1024 * LANES;

/// Number of neighbours within a radius in point spacings.
pub(in crate::analysis) fn neighbours_within(spacings: f32) -> usize {
    let [min, max] = NEIGHBOURS;
    (PI * spacings * spacings).round().clamp(min, max) as usize
}

/// The points on the surface around them, by slot, in units of the tree. Advances `progress` by the number of points;
/// once it is cancelled, the rest stays.
pub(in crate::analysis) fn projected(tree: &PointTree, spacings: f32, progress: &Progress) -> Vec<Vec3> {
    let mut places: Vec<Vec3> = tree.points().iter().map(|point| point.position).collect();
    let k = neighbours_within(spacings);
    places
        .par_chunks_mut(POINTS_PER_BLOCK)
        .enumerate()
        .for_each(|(block, places)| {
            if progress.is_cancelled() {
                return;
            }
            let first = POINTS_PER_BLOCK * block;
            let slots = first..first + places.len();
            let neighbours = tree.neighbours_of(slots.clone(), k);
            let mut offsets = Vec::with_capacity(k + 1);
            for (place, slot) in places.iter_mut().zip(slots) {
                gather(tree.points(), slot, &neighbours, &mut offsets);
                if let Some(moved) = movement(&offsets) {
                    *place += moved.as_vec3();
                }
            }
            progress.advance(places.len());
        });
    places
}

/// Sets `offsets` to the offsets from a point to itself and its neighbours.
fn gather(points: &[SlotPoint], slot: usize, neighbours: &Neighbours, offsets: &mut Vec<DVec3>) {
    let center = points[slot].position;
    offsets.clear();
    offsets.push(DVec3::ZERO);
    let others = neighbours.of(slot).iter();
    offsets.extend(others.map(|&other| (points[other as usize].position - center).as_dvec3()));
}

/// Offset of a point to the surface through these, relative to it; `None` where they are not a surface.
fn movement(offsets: &[DVec3]) -> Option<DVec3> {
    let reach_squared = offsets
        .iter()
        .fold(0.0, |reach: f64, offset| reach.max(offset.length_squared()));
    let radius_squared = reach_squared * REACH * REACH;
    if radius_squared.is_nan() || radius_squared < f64::MIN_POSITIVE {
        return None;
    }
    // Projection of the point onto its reference plane.
    let mut place = DVec3::ZERO;
    let mut axes = [DVec3::Z; 3];
    for _ in 0..ROUNDS {
        let (mean, covariance) = weighted(offsets, place, radius_squared);
        let eigen = covariance.eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.values[a].total_cmp(&eigen.values[b]));
        let [_, narrow, wide] = order.map(|axis| eigen.values[axis]);
        if narrow <= MIN_VARIANCE_RATIO * wide {
            return None;
        }
        axes = order.map(|axis| eigen.vectors[axis]);
        // Along the normal from where the point was: it does not slide over the surface.
        place = axes[0] * axes[0].dot(mean);
    }
    let [normal, tangent, bitangent] = axes;
    let scale = radius_squared.sqrt().recip();
    let heights = offsets.iter().map(|&offset| {
        let from_place = offset - place;
        let on_plane = DVec2::new(from_place.dot(tangent), from_place.dot(bitangent)) * scale;
        (on_plane, from_place.dot(normal), weight(from_place, radius_squared))
    });
    let height = Quadric::fit(heights).map_or(0.0, |quadric| quadric.height(DVec2::ZERO));
    Some(place + normal * height)
}

/// Mean and covariance of points weighted by their distance from `place`.
fn weighted(offsets: &[DVec3], place: DVec3, radius_squared: f64) -> (DVec3, SymmetricMat3) {
    let weights = || {
        offsets
            .iter()
            .map(|&offset| (offset, weight(offset - place, radius_squared)))
    };
    let (sum, total) = weights().fold((DVec3::ZERO, 0.0), |(sum, total), (offset, weight)| {
        (sum + weight * offset, total + weight)
    });
    let mean = sum / total;
    let covariance = weights().fold(SymmetricMat3::default(), |sum, (offset, weight)| {
        let d = offset - mean;
        let w = weight * d;
        SymmetricMat3 {
            xx: sum.xx + w.x * d.x,
            xy: sum.xy + w.x * d.y,
            xz: sum.xz + w.x * d.z,
            yy: sum.yy + w.y * d.y,
            yz: sum.yz + w.y * d.z,
            zz: sum.zz + w.z * d.z,
        }
    });
    (mean, covariance)
}

/// The weight of a point at an offset: a bell that ends at the radius, and never nothing, so that there is a mean.
fn weight(offset: DVec3, radius_squared: f64) -> f64 {
    let within = (1.0 - offset.length_squared() / radius_squared).max(1e-3);
    within * within
}
