//! Normals by principal component analysis of the neighbours.
//!
//! How it works: the normal is the direction in which a point and its neighbours spread least, the eigenvector of the
//! smallest eigenvalue of their covariance (Hoppe et al. 1992). Offsets are taken from the point itself, which is exact in
//! f32 for near neighbours wherever the cloud lies, and added up in f64. Their mean is no larger than they are, so
//! subtracting its square loses nothing that f32 coordinates had.
//!
//! The sign is arbitrary here; [`super::orientation`] decides it.

use super::neighbours::Neighbours;
use super::point_tree::{PointTree, SlotPoint};
use crate::math::SymmetricMat3;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Unit normals by slot.
pub(super) fn plane_normals(tree: &PointTree, neighbours: &Neighbours) -> Vec<Vec3> {
    (0..tree.len())
        .into_par_iter()
        .with_min_len(1 << 9)
        .map(|slot| plane_normal(tree.points(), slot, neighbours.of(slot)))
        .collect()
}

/// Estimates those of `normals` (by slot) that are zero.
pub(super) fn fill_missing(tree: &PointTree, neighbours: &Neighbours, normals: &mut [Vec3]) {
    for (slot, normal) in normals.iter_mut().enumerate() {
        if *normal == Vec3::ZERO {
            *normal = plane_normal(tree.points(), slot, neighbours.of(slot));
        }
    }
}

/// The direction of least spread; +Z when there is no spread at all.
fn plane_normal(points: &[SlotPoint], slot: usize, neighbours: &[u32]) -> Vec3 {
    let point = points[slot].position;
    // The point itself has offset zero and adds nothing.
    let mut sum = DVec3::ZERO;
    let mut squares = DVec3::ZERO;
    let mut products = DVec3::ZERO;
    for &neighbour in neighbours {
        let d = (points[neighbour as usize].position - point).as_dvec3();
        sum += d;
        squares += d * d;
        products += d * DVec3::new(d.y, d.z, d.x);
    }
    let share = 1.0 / (neighbours.len() + 1) as f64;
    let squares = squares - sum * sum * share;
    let products = products - sum * DVec3::new(sum.y, sum.z, sum.x) * share;
    let covariance = SymmetricMat3 {
        xx: squares.x,
        xy: products.x,
        xz: products.z,
        yy: squares.y,
        yz: products.y,
        zz: squares.z,
    };
    if squares.element_sum() > 0.0 {
        covariance.smallest_eigenvector().as_vec3()
    } else {
        Vec3::Z
    }
}
