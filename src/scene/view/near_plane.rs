//! The near plane of an image, by its content.
//!
//! **How it works.** Depth is `near / distance` in floating point, so it resolves the same fraction of a distance
//! whatever the near plane is. The near plane is therefore chosen by the box around the content: it lies between the
//! eye and the box; where the eye is in or next to the box, it is [`NEAREST_OF_FARTHEST`] of the farthest distance in
//! it. It is never farther away than a fraction of the distance of the target
//! ([`NEAR_FRACTION`](super::camera::NEAR_FRACTION)): most images are drawn with that one.
//!
//! Orthographic views keep the plane of their telephoto lens. Its eye is a thousand times as far away as the target
//! appears, and objects next to it would be enlarged, unlike with parallel rays.

use super::camera::ViewTransform;
use crate::math::Aabb;
use glam::DMat3;

/// Nearest distance that is drawn, as a part of the farthest, where the eye is within the content.
const NEAREST_OF_FARTHEST: f64 = 1e-8;

/// Share of the distance from the eye to the box that the near plane is at: splats reach beyond the box of their
/// centres.
const SHARE_BEFORE_BOX: f64 = 0.5;

impl ViewTransform {
    /// Returns this view with a near plane that nothing inside of `content`, a box in the space of the frame, is cut
    /// off by.
    #[must_use]
    pub fn near_for(self, content: &Aabb) -> Self {
        let is_perspective = self.telephoto == 1.0;
        if !is_perspective || content.is_empty() {
            return self;
        }
        let [nearest, farthest] = self.depths_of(content);
        // Nothing behind the eye is drawn.
        if farthest <= 0.0 {
            return self;
        }
        let wanted = (SHARE_BEFORE_BOX * nearest).max(NEAREST_OF_FARTHEST * farthest);
        let near = f64::from(self.near).min(wanted) as f32;
        Self {
            near: near.max(f32::MIN_POSITIVE),
            ..self
        }
    }

    /// Distances along the view axis of the nearest and the farthest corner of a box; negative behind the eye.
    fn depths_of(&self, content: &Aabb) -> [f64; 2] {
        // In f64, as the eye may be next to the corner of a box whose centre is far away.
        let rotation: DMat3 = self.view_from_frame_rotation.as_dmat3();
        let forward = -rotation.row(2);
        let eye = self.eye_high.as_dvec3() + self.eye_low.as_dvec3();
        let [min, max] = [content.min, content.max].map(|corner| corner.as_dvec3() - eye);
        let along = [forward * min, forward * max];
        let nearest = along[0].min(along[1]);
        let farthest = along[0].max(along[1]);
        [nearest.element_sum(), farthest.element_sum()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Projection, UpAxis};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    fn camera(projection: Projection) -> Camera {
        let unit = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        Camera {
            projection,
            ..Camera::framing(&unit, DVec3::ZERO, UpAxis::Y)
        }
    }

    proptest! {
        /// Every place of the box that is farther away than a hundred-millionth of the farthest is drawn, and where
        /// the usual plane cuts nothing off it stays.
        #[test]
        fn nothing_of_the_content_is_cut_off(
            low in prop::array::uniform3(-1e3f32..1e3),
            size in prop::array::uniform3(0f32..1e3),
            share in prop::array::uniform3(0f32..=1.0),
            distance in 1e-2f64..1e5,
        ) {
            let low = Vec3::from_array(low);
            let size = Vec3::from_array(size);
            let content = Aabb { min: low, max: low + size };
            let usual = Camera { distance, ..camera(Projection::Perspective) }.transform(DVec3::ZERO, [640, 480]);
            let view = usual.near_for(&content);
            let place = low + size * Vec3::from_array(share);
            let depth = f64::from(-view.to_view(place).z);
            let [nearest, farthest] = usual.depths_of(&content);
            // Of the rounding of f32, relative to coordinates.
            let slack = 1e-6 * f64::from(low.abs().max_element() + 1e3) + 1e-6 * distance;
            prop_assert!(depth >= nearest - slack && depth <= farthest + slack);
            prop_assert!(view.near > 0.0 && view.near <= usual.near);
            prop_assert!(depth <= 1e-8 * farthest + slack || f64::from(view.near) <= depth + slack);
            if nearest > 2.001 * f64::from(usual.near) {
                prop_assert_eq!(view.near, usual.near);
            }
        }
    }

    #[test]
    fn orthographic_views_and_content_behind_the_eye_change_nothing() {
        let everywhere = Aabb {
            min: Vec3::splat(-1e3),
            max: Vec3::splat(1e3),
        };
        let parallel = camera(Projection::Orthographic).transform(DVec3::ZERO, [64, 64]);
        assert_eq!(parallel.near_for(&everywhere), parallel);
        let view = camera(Projection::Perspective).transform(DVec3::ZERO, [64, 64]);
        assert!(view.near_for(&everywhere).near < 0.1 * view.near);
        assert_eq!(view.near_for(&Aabb::EMPTY), view);
        let behind = (2.0 * view.eye_high.as_dvec3()).as_vec3();
        assert_eq!(
            view.near_for(&Aabb {
                min: behind,
                max: behind
            }),
            view
        );
    }
}
