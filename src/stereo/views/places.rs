//! From disparities to places in the world.
//!
//! Yang et al. 2006, section 5.1: of rectified images, with 3 × 4 matrices M₁ and M₂ from the world to pixels whose
//! third rows agree, a place q of pixel (u, v) and partner (u + d, v) fulfils λ [u, u + d, v, 1]ᵀ = A q, where A has
//! the rows M₁(1), M₂(1), M₁(2), M₁(3). So q = A⁻¹ [u, u + d, v, 1]ᵀ: one product of a matrix and a vector for each
//! pixel. The d of the paper is the negative of disparities here.

use super::view::pixels_from_rays;
use crate::photos::center_of;
use crate::rgbd::Camera;
use glam::{DAffine3, DMat4, DVec2, DVec3, DVec4};

/// The inverse of A.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Places {
    world_from_match: DMat4,
    /// Origin that A maps from, so that its numbers are near 1 wherever the cameras are.
    origin: DVec3,
}

impl Places {
    /// Creates the mapping for rectified cameras: with the same focal length, the same principal-point row and the same
    /// rotation, separated along x.
    pub(in crate::stereo) fn new(cameras: &[Camera; 2], poses: &[DAffine3; 2]) -> Self {
        // Relative to a camera, so that a scene far from the origin of the world loses no precision.
        let origin = center_of(poses[0]);
        let rows = [0, 1].map(|index| {
            let pixels = pixels_from_rays(&cameras[index]);
            let rotation = pixels * poses[index].matrix3;
            let translation = pixels * poses[index].transform_point3(origin);
            [0, 1, 2].map(|row| rotation.row(row).extend(translation[row]))
        });
        let [first, second] = rows;
        let a = DMat4::from_cols(first[0], second[0], first[1], first[2]).transpose();
        Self {
            world_from_match: a.inverse(),
            origin,
        }
    }

    /// The place in the world of `pixel` of the first rectified image, whose partner is `disparity` columns further
    /// left; `None` where that is infinitely far, or behind.
    pub fn point(&self, pixel: DVec2, disparity: f64) -> Option<DVec3> {
        let place = self.world_from_match * DVec4::new(pixel.x, pixel.x - disparity, pixel.y, 1.0);
        (place.w > 0.0 && place.is_finite()).then(|| self.origin + place.truncate() / place.w)
    }
}
