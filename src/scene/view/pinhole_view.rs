//! The view of a sensor: a pinhole is a field of view from top to bottom, and a [`PicturePlane`].
//!
//! So it is a [`Camera`] as others are: it can be turned, moved, written as text, and be a keyframe of a path. A
//! rendered image of the size of the sensor's has its pixels; a wider one shows more at both sides, a narrower one
//! less.

use crate::rgbd;
use crate::scene::{Camera, PicturePlane, Projection, UpAxis};
use glam::{DAffine3, DVec2, DVec3};

impl Camera {
    /// Creates the view of a pinhole camera at `world_from_camera` (x right, y down, z forward), whose lens distortion
    /// is ignored: points are at their undistorted positions. `distance` is the target's, which lies on its axis.
    ///
    /// Precondition: `world_from_camera` is a rotation and a translation, `distance` above 0.
    pub fn of_pinhole(pinhole: &rgbd::Camera, world_from_camera: DAffine3, distance: f64, up: UpAxis) -> Self {
        let axes = world_from_camera.matrix3;
        let (right, back) = (axes.x_axis, -axes.z_axis);
        let (azimuth_deg, elevation_deg) = up.angles_of(back);
        let size = DVec2::from_array(pinhole.size_px().map(f64::from));
        let focal = pinhole.focal_px();
        // Pixel centres are at integers there, and at halves here.
        let from_center = pinhole.principal_px() + 0.5 - 0.5 * size;
        let mut camera = Self {
            target_in_world: world_from_camera.translation - distance * back,
            distance,
            azimuth_deg,
            elevation_deg,
            fov_deg: 2.0 * (0.5 * size.y / focal.y).atan().to_degrees(),
            up,
            projection: Projection::Perspective,
            plane: PicturePlane::CENTERED,
        };
        let upright = camera.view_from_world_rotation();
        let roll = (upright * right).truncate();
        camera.plane = PicturePlane {
            roll_deg: roll.y.atan2(roll.x).to_degrees(),
            shift: from_center * DVec2::new(1.0, -1.0) / size.y,
            pixel_aspect: focal.x / focal.y,
        };
        camera
    }

    /// Sets the vertical field of view, degrees. The image of a sensor ends with that: it becomes one with the view
    /// axis in the centre.
    pub fn set_fov_deg(&mut self, fov_deg: f64) {
        self.fov_deg = fov_deg;
        self.plane = self.plane.centered();
    }

    /// Pixels to the right and upwards for a slope of 1, and the place of the view axis from the lower left corner, in
    /// an image of this size.
    pub(crate) fn px_per_slope(&self, viewport_px: [u32; 2]) -> (DVec2, DVec2) {
        let size = DVec2::from_array(viewport_px.map(f64::from));
        let upwards = 0.5 * size.y * self.lens().focal;
        let axis = 0.5 * size + self.plane.shift * size.y;
        (DVec2::new(upwards * self.plane.pixel_aspect, upwards), axis)
    }
}

/// Returns the distance of a target on the axis of a sensor at `world_from_camera`, so that the view orbits about the
/// scene: the depth of `center`, its centre; otherwise `radius`, its size.
pub fn sensor_target_distance(world_from_camera: &DAffine3, center: DVec3, radius: f64) -> f64 {
    let depth = (center - world_from_camera.translation).dot(world_from_camera.matrix3.z_axis);
    let min = f64::MIN_POSITIVE.sqrt();
    if depth > min { depth } else { radius.max(min) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::rgbd::Distortion;
    use glam::{DQuat, Vec3};
    use proptest::prelude::*;

    fn pinhole() -> rgbd::Camera {
        let (focal, principal) = (DVec2::new(518.9, 531.2), DVec2::new(325.58, 253.74));
        rgbd::Camera::new([640, 480], focal, principal, Distortion::None).unwrap()
    }

    /// Position of a place of the world in the shaders' image of `size`, in pixels whose centres are at integers.
    fn shaded_px(camera: &Camera, place: DVec3, size: [u32; 2]) -> DVec2 {
        let view = camera.transform(DVec3::ZERO, size);
        let clip = view.clip_from_view() * view.to_view(place.as_vec3()).extend(1.0);
        let size = DVec2::from_array(size.map(f64::from));
        let ndc = DVec2::new(f64::from(clip.x / clip.w), f64::from(-clip.y / clip.w));
        size * (0.5 + 0.5 * ndc) - 0.5
    }

    proptest! {
        /// Wherever it stands and however it is turned, whichever axis is up.
        #[test]
        fn sensor_pixels_match_the_pixels_of_its_view(
            turn in (-3.0..3.0_f64, -3.0..3.0_f64, -3.0..3.0_f64),
            from in prop::array::uniform3(-5.0..5.0_f64),
            pixel in (0.0..639.0_f64, 0.0..479.0_f64),
            depth in 0.3..8.0_f64,
            up in 0..6_usize,
        ) {
            let pinhole = pinhole();
            let rotation = DQuat::from_euler(glam::EulerRot::YXZ, turn.0, turn.1, turn.2);
            let pose = DAffine3::from_rotation_translation(rotation, from.into());
            let camera = Camera::of_pinhole(&pinhole, pose, 2.0, UpAxis::ALL[up].1);
            prop_assert!((camera.eye_in_world() - pose.translation).length() < 1e-9);
            let pixel = DVec2::new(pixel.0, pixel.1);
            let place = pose.transform_point3(depth * pinhole.ray(pixel).unwrap());
            // Within single precision.
            let shaded = shaded_px(&camera, place, [640, 480]);
            prop_assert!((shaded - pixel).length() < 0.01, "{} {}", shaded, pixel);
            let marked = camera.to_px(place, [640, 480]).unwrap() - 0.5;
            prop_assert!((marked - pixel).length() < 1e-6, "{} {}", marked, pixel);
        }
    }

    #[test]
    fn other_image_sizes_have_the_same_rays_about_the_same_center() {
        let camera = Camera::of_pinhole(&pinhole(), DAffine3::IDENTITY, 1.5, UpAxis::NegY);
        let place = DVec3::new(0.21, -0.3, 1.7);
        let own = camera.to_px(place, [640, 480]).unwrap();
        for (size, scale, aside) in [
            ([1280, 960], 2.0, 0.0),
            ([1920, 960], 2.0, 320.0),
            ([320, 480], 1.0, -160.0),
        ] {
            let expected = own * scale + DVec2::new(aside, 0.0);
            let found = camera.to_px(place, size).unwrap();
            assert!((found - expected).length() < 1e-9, "{size:?}: {found} {expected}");
            let shaded = shaded_px(&camera, place, size) + 0.5;
            assert!((shaded - expected).length() < 0.01, "{size:?}: {shaded} {expected}");
        }
    }

    #[test]
    fn a_camera_that_looks_along_z_with_y_down_is_upright_where_y_is_down() {
        let camera = Camera::of_pinhole(&pinhole(), DAffine3::IDENTITY, 2.0, UpAxis::NegY);
        assert_eq!(
            [camera.azimuth_deg, camera.elevation_deg, camera.plane.roll_deg],
            [0.0; 3]
        );
        let over_head = Camera::of_pinhole(&pinhole(), DAffine3::IDENTITY, 2.0, UpAxis::Y);
        assert!((over_head.plane.roll_deg.abs() - 180.0).abs() < 1e-9);
        assert_eq!(camera.target_in_world, DVec3::new(0.0, 0.0, 2.0));
    }

    #[test]
    fn image_parts_have_the_rays_of_the_full_image() {
        let camera = Camera::of_pinhole(&pinhole(), DAffine3::IDENTITY, 1.5, UpAxis::NegY);
        let whole = camera.transform(DVec3::ZERO, [640, 480]);
        let part = whole.of_part([640, 480], [400, 120], [240, 90]);
        let place = Vec3::new(0.5, -0.1, 1.5);
        let clip = part.clip_from_view() * part.to_view(place).extend(1.0);
        let found = DVec2::new(
            120.0 * (1.0 + f64::from(clip.x / clip.w)) + 400.0,
            45.0 * (1.0 - f64::from(clip.y / clip.w)) + 120.0,
        );
        let expected = camera.to_px(place.as_dvec3(), [640, 480]).unwrap();
        assert!((found - expected).length() < 0.01, "{found} {expected}");
        assert_eq!(whole.of_part([640, 480], [0, 0], [640, 480]), whole);
    }

    #[test]
    fn framing_and_looking_along_an_axis_leave_the_sensor_view() {
        let pose = DAffine3::from_rotation_z(0.4);
        let mut camera = Camera::of_pinhole(&pinhole(), pose, 1.5, UpAxis::NegY);
        assert!((camera.plane.roll_deg.abs() - 0.4_f64.to_degrees()).abs() < 1e-9);
        let bounds = Aabb::from_points(&[Vec3::NEG_ONE, Vec3::ONE]);
        camera.frame_bounds(&bounds, DVec3::ZERO);
        assert_eq!(camera.plane, camera.plane.centered());
        camera.look_from(crate::scene::ViewPreset::Front);
        assert_eq!(camera.plane, PicturePlane::CENTERED);
    }

    #[test]
    fn the_target_is_at_the_depth_of_the_points() {
        let pose = DAffine3::from_translation(DVec3::new(0.0, 0.0, -1.0));
        let distance = |center: [f64; 3]| sensor_target_distance(&pose, center.into(), 0.7);
        assert_eq!(distance([9.0, 4.0, 2.0]), 3.0);
        assert_eq!(distance([0.0, 0.0, -2.0]), 0.7);
    }
}
