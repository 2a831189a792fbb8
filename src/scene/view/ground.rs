//! The grid on the ground: which plane, how wide its cells are, and where a pixel's ray meets it.
//!
//! **How it works.** The plane lies at the lower side of a box around the cloud. Its cells are a power of ten wide, so
//! that 5 to 50 of them lie under the cloud; lines ten times finer and ten times coarser appear where there is space.
//! Lines are at whole multiples of the spacing in the coordinates of the file. Renderers intersect the ray of each
//! pixel with the plane; how many pixels away the nearest line is follows from the derivative, which is known in closed
//! form, so that both draw the same lines (`shaders/effects/grid.wgsl`, `render/effects/grid`).

use crate::math::Aabb;
use crate::scene::style::luma;
use crate::scene::{Background, UpAxis, ViewTransform};
use glam::{DVec3, Vec3, Vec3Swizzles as _};

/// Cells under the cloud at least.
const MIN_CELLS: f64 = 5.0;

/// Grid extent: how far lines are seen, in widths of the cloud from its centre.
const REACH_WIDTHS: f32 = 2.0;

/// Colours of lines before a dark and a light background.
const ON_DARK: [f32; 3] = [0.80, 0.84, 0.90];
const ON_LIGHT: [f32; 3] = [0.22, 0.25, 0.30];

/// A plane with lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundPlane {
    /// Grid crossing of two lines, near the centre of the cloud on the plane, relative to the sequence origin.
    pub point_in_frame: Vec3,
    /// The axis that is up.
    pub normal: Vec3,
    /// Between two lines, scene units: a power of ten.
    pub spacing: f32,
    /// Grid extent: how far from the point lines are seen, scene units.
    pub reach: f32,
    /// Red, green and blue of the lines, 0 to 1. It is chosen with the packet, not when it is drawn: an image with
    /// alpha is drawn on black and on white, and its lines must be the same on both.
    pub color: [f32; 3],
}

impl GroundPlane {
    /// The plane through the lower side of a box, which is relative to `origin`, for lines before `background`.
    pub fn under(bounds: &Aabb, origin: DVec3, up: UpAxis, background: Background) -> Self {
        let normal = up.direction();
        let extent = bounds.extent().as_dvec3();
        let width = (extent - extent * normal.abs()).max_element();
        let spacing = spacing_under(width);
        let center = origin + bounds.center().as_dvec3();
        let lowest = center.dot(normal) - 0.5 * extent.dot(normal.abs());
        let crossing = (center / spacing).round() * spacing;
        let point = crossing + normal * (lowest - crossing.dot(normal));
        let is_dark = luma(background.top) + luma(background.bottom) < 255.0;
        Self {
            point_in_frame: (point - origin).as_vec3(),
            normal: normal.as_vec3(),
            spacing: spacing as f32,
            reach: REACH_WIDTHS * width.max(spacing) as f32,
            color: if is_dark { ON_DARK } else { ON_LIGHT },
        }
    }

    /// The plane as an eye sees it.
    pub fn seen_by(&self, view: &ViewTransform) -> SeenGround {
        let rotation = view.view_from_frame_rotation;
        let right = self.normal.yzx().abs();
        let point = view.to_view(self.point_in_frame);
        let axes = [right, self.normal.cross(right)].map(|axis| rotation * axis);
        let normal = rotation * self.normal;
        SeenGround {
            normal,
            height: normal.dot(point),
            axes,
            point_along_axes: axes.map(|axis| axis.dot(point)),
            spacing: self.spacing,
            reach: self.reach,
            color: self.color,
        }
    }
}

/// The largest power of ten with at least [`MIN_CELLS`] cells in a width; 1 for an invalid width.
fn spacing_under(width: f64) -> f64 {
    let exponent = (width / MIN_CELLS).log10();
    // Numbers that are a power of ten except for rounding errors count as that power.
    let spacing = 10f64.powi((exponent + 1e-9).floor().clamp(-30.0, 30.0) as i32);
    if width > 0.0 && width.is_finite() { spacing } else { 1.0 }
}

/// A [`GroundPlane`] in view space. The ray with z = -1 meets it at `height / (normal · ray)` of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenGround {
    /// Unit normal.
    pub normal: Vec3,
    /// From the eye to the plane along the normal: negative where the eye is above.
    pub height: f32,
    /// Unit vectors across the lines.
    pub axes: [Vec3; 2],
    /// Coordinates of the plane's point along them, from the eye.
    pub point_along_axes: [f32; 2],
    /// As in [`GroundPlane`].
    pub spacing: f32,
    /// As in [`GroundPlane`].
    pub reach: f32,
    /// As in [`GroundPlane`].
    pub color: [f32; 3],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;
    use proptest::prelude::*;

    #[test]
    fn five_to_fifty_cells_are_under_a_cloud_of_any_size() {
        for decade in -6..=6 {
            for width in [1.0, 2.0, 4.99, 5.0, 5.01, 9.99] {
                let width = width * 10f64.powi(decade);
                let cells = width / spacing_under(width);
                assert!((4.999..50.001).contains(&cells), "{width}: {cells}");
            }
        }
        assert_eq!(spacing_under(5.0), 1.0);
        assert_eq!(spacing_under(49.0), 1.0);
        assert_eq!(spacing_under(50.0), 10.0);
        assert_eq!(spacing_under(0.0), 1.0);
        assert_eq!(spacing_under(f64::NAN), 1.0);
    }

    proptest! {
        /// Far from zero as well: lines are at whole numbers of the file, and the plane at the lower side.
        #[test]
        fn lines_are_at_round_coordinates_of_the_file(
            center in prop::array::uniform3(-3.0f32..3.0),
            half in prop::array::uniform3(0.4f32..2.0),
            axis in 0..UpAxis::ALL.len(),
            is_far: bool,
        ) {
            let origin = if is_far { DVec3::new(4_194_304.0, -65_536.0, 8192.0) } else { DVec3::ZERO };
            let (center, half) = (Vec3::from_array(center), Vec3::from_array(half));
            let bounds = Aabb { min: center - half, max: center + half };
            let (_, up) = UpAxis::ALL[axis];
            let ground = GroundPlane::under(&bounds, origin, up, Background::default());
            let point = origin + ground.point_in_frame.as_dvec3();
            let spacing = 10f64.powi(ground.spacing.log10().round() as i32);
            for axis in 0..3 {
                let is_up = ground.normal[axis] != 0.0;
                let lines = point[axis] / spacing;
                prop_assert!(is_up || (lines - lines.round()).abs() < 1e-4, "{}", lines);
                let from_center = (ground.point_in_frame - center)[axis].abs();
                prop_assert!(is_up || from_center <= 0.51 * ground.spacing);
            }
            let below = |corner: Vec3| (corner - ground.point_in_frame).dot(ground.normal);
            let lowest = below(bounds.min).min(below(bounds.max));
            prop_assert!(lowest.abs() < 1e-5, "{}", lowest);
        }

        /// The formula of the renderers against a point of the plane that is projected.
        #[test]
        fn the_ray_of_a_pixel_meets_the_plane_where_a_point_of_it_is_drawn(
            place in prop::array::uniform2(-1.0f32..1.0),
            azimuth in -180.0f64..180.0,
            elevation in 5.0f64..90.0,
        ) {
            let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
            let camera = Camera {
                azimuth_deg: azimuth,
                elevation_deg: elevation,
                ..Camera::framing(&bounds, DVec3::ZERO, UpAxis::Z)
            };
            let view = camera.transform(DVec3::ZERO, [640, 480]);
            let ground = GroundPlane::under(&bounds, DVec3::ZERO, UpAxis::Z, Background::default());
            let seen = ground.seen_by(&view);
            let point = Vec3::new(place[0], place[1], -1.0);
            let in_view = view.to_view(point);
            let ray = in_view / -in_view.z;
            let distance = seen.height / seen.normal.dot(ray);
            prop_assert!((distance / -in_view.z - 1.0).abs() < 1e-4);
            let hit = (0..2).map(|axis| distance * seen.axes[axis].dot(ray) - seen.point_along_axes[axis]);
            let hit: Vec<f32> = hit.collect();
            let length = (point - ground.point_in_frame).length();
            prop_assert!((hit[0].hypot(hit[1]) - length).abs() < 1e-4);
        }
    }
}
