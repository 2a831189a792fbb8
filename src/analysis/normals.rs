//! Normals by principal component analysis of the neighbours.
//!
//! How it works: the normal is the direction in which a point and its neighbours spread least, the eigenvector of the
//! smallest eigenvalue of their covariance (Hoppe et al. 1992). Offsets are taken from the point itself first, which is exact
//! in f32 for near neighbours wherever the cloud lies, then centred on their mean and added up in f64: nothing cancels,
//! however far from the origin.
//!
//! The sign is arbitrary here; [`super::orientation`] decides it.

use super::{neighbours::Neighbours, point_tree::PointTree};
use crate::math::SymmetricMat3;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Unit normals by slot.
pub(super) fn plane_normals(tree: &PointTree, neighbours: &Neighbours) -> Vec<Vec3> {
    (0..tree.len())
        .into_par_iter()
        .with_min_len(1 << 9)
        .map(|slot| plane_normal(tree.positions(), slot, neighbours.of(slot)))
        .collect()
}

/// Estimates those of `normals` (by slot) that are zero.
pub(super) fn fill_missing(tree: &PointTree, neighbours: &Neighbours, normals: &mut [Vec3]) {
    for (slot, normal) in normals.iter_mut().enumerate() {
        if *normal == Vec3::ZERO {
            *normal = plane_normal(tree.positions(), slot, neighbours.of(slot));
        }
    }
}

/// The direction of least spread; +Z when there is no spread at all.
fn plane_normal(positions: &[Vec3], slot: usize, neighbours: &[u32]) -> Vec3 {
    let point = positions[slot];
    let offsets = || {
        neighbours
            .iter()
            .map(|&neighbour| (positions[neighbour as usize] - point).as_dvec3())
    };
    // The point itself has offset zero.
    let mean = offsets().sum::<DVec3>() / (neighbours.len() + 1) as f64;
    let mut covariance = SymmetricMat3::default();
    for offset in std::iter::once(DVec3::ZERO).chain(offsets()) {
        let d = offset - mean;
        covariance.xx += d.x * d.x;
        covariance.xy += d.x * d.y;
        covariance.xz += d.x * d.z;
        covariance.yy += d.y * d.y;
        covariance.yz += d.y * d.z;
        covariance.zz += d.z * d.z;
    }
    if covariance.xx + covariance.yy + covariance.zz > 0.0 {
        covariance.eigen().vectors[0].as_vec3()
    } else {
        Vec3::Z
    }
}
