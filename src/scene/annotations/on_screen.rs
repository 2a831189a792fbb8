//! Projection of world-space positions to the image, in f64: for marks that are painted over it.

use crate::scene::Camera;
use glam::{DVec2, DVec3};

/// Nearest distance of a place that has pixels, as a part of the distance of the target.
const NEAREST_MARK: f64 = 1e-8;

impl Camera {
    /// The position in an image of `viewport_px` in pixels, from its upper left corner; `None` behind the eye.
    pub fn to_px(&self, place_in_world: DVec3, viewport_px: [u32; 2]) -> Option<DVec2> {
        let place = self.in_view_space(place_in_world);
        // Images are drawn from where their content begins, which may be next to the eye.
        (-place.z >= NEAREST_MARK * self.lens().distance).then(|| self.view_to_px(place, viewport_px))
    }

    /// Both ends of the part of a line that is in front of the eye, as [`Camera::to_px`]; `None` if nothing is.
    pub fn line_to_px(&self, ends_in_world: [DVec3; 2], viewport_px: [u32; 2]) -> Option<[DVec2; 2]> {
        let [a, b] = ends_in_world.map(|end| self.in_view_space(end));
        let nearest = NEAREST_MARK * self.lens().distance;
        let in_front = [a, b].map(|end| -end.z).into_iter().filter(|&depth| depth >= nearest);
        // Lines that pass the eye end where coordinates of pixels are not yet huge.
        let near = in_front
            .fold(self.lens().near(), |near, depth| near.min(0.5 * depth))
            .max(nearest);
        let [in_front_a, in_front_b] = [a, b].map(|end| -end.z >= near);
        let on_near_plane = || a.lerp(b, (-near - a.z) / (b.z - a.z));
        let [a, b] = match (in_front_a, in_front_b) {
            (true, true) => [a, b],
            (true, false) => [a, on_near_plane()],
            (false, true) => [on_near_plane(), b],
            (false, false) => return None,
        };
        Some([a, b].map(|end| self.view_to_px(end, viewport_px)))
    }

    /// Returns the distance from `place` along `direction` of the position that is seen nearest to the pixel `px`, in
    /// lengths of `direction`: it follows a pointer that drags it. `None` where the line is seen end on, or not at all.
    pub fn along_line(&self, place: DVec3, direction: DVec3, px: DVec2, viewport_px: [u32; 2]) -> Option<f64> {
        let near = NEAREST_MARK * self.lens().distance;
        let from = self.in_view_space(place);
        let step = self.view_from_world_rotation() * direction;
        let [width, height] = viewport_px.map(f64::from);
        let px_per_slope = 0.5 * height * self.lens().focal;
        let slope = (px - 0.5 * DVec2::new(width, height)) / px_per_slope;
        // A position on the screen is the quotient of these, where the steps are multiplied by their number.
        let (over, over_step) = (DVec2::new(from.x, -from.y), DVec2::new(step.x, -step.y));
        let (under, under_step) = (-from.z, -step.z);
        if under < near {
            return None;
        }
        let on_screen = (over_step * under - over * under_step) / (under * under);
        // A direction that moves less than a pixel per step cannot be dragged.
        let on_screen = (on_screen.length() * px_per_slope > 1e-9).then(|| on_screen.try_normalize())??;
        // Exact, without iteration: numerator and denominator of a projected coordinate are both linear along a line.
        let wanted = on_screen.dot(slope);
        let divisor = on_screen.dot(over_step) - wanted * under_step;
        let steps = (wanted * under - on_screen.dot(over)) / divisor;
        (steps.is_finite() && under + steps * under_step >= near).then_some(steps)
    }

    /// From world space to view space (right, up, backward). Around the target first: near it nothing is lost however
    /// far away the eye is.
    fn in_view_space(&self, place_in_world: DVec3) -> DVec3 {
        let around_target = self.view_from_world_rotation() * (place_in_world - self.target_in_world);
        around_target - DVec3::Z * self.lens().distance
    }

    fn view_to_px(&self, place: DVec3, viewport_px: [u32; 2]) -> DVec2 {
        let (px_per_slope, axis) = self.px_per_slope(viewport_px);
        let DVec2 { x, y } = axis + place.truncate() / -place.z * px_per_slope;
        DVec2::new(x, f64::from(viewport_px[1]) - y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::{Projection, UpAxis};
    use glam::Vec3;
    use proptest::prelude::*;

    const SIZE: [u32; 2] = [640, 480];

    fn camera(projection: Projection, origin: DVec3) -> Camera {
        let bounds = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        Camera {
            azimuth_deg: 33.0,
            elevation_deg: -20.0,
            projection,
            ..Camera::framing(&bounds, origin, UpAxis::Z)
        }
    }

    proptest! {
        #[test]
        fn positions_match_the_projection_of_the_shaders(
            place in prop::array::uniform3(-1.5f64..1.5),
            is_orthographic: bool,
        ) {
            let projection = if is_orthographic { Projection::Orthographic } else { Projection::Perspective };
            let origin = DVec3::new(4e6, -3e6, 5e6);
            let camera = camera(projection, origin);
            let transform = camera.transform(origin, SIZE);
            let place = DVec3::from_array(place);
            let clip = transform.clip_from_view() * transform.to_view(place.as_vec3()).extend(1.0);
            let expected = DVec2::new(
                f64::from(SIZE[0]) * (0.5 + 0.5 * f64::from(clip.x / clip.w)),
                f64::from(SIZE[1]) * (0.5 - 0.5 * f64::from(clip.y / clip.w)),
            );
            let found = camera.to_px(origin + place, SIZE).unwrap();
            // The precision that f32 has with a telephoto lens.
            prop_assert!((found - expected).length() < 0.1, "{} {}", found, expected);
        }
    }

    proptest! {
        /// A position on the line is found from its pixel, and a pixel next to the line gives its foot.
        #[test]
        fn the_pointer_is_projected_onto_a_line(
            place in prop::array::uniform3(-1f64..1.0),
            direction in prop::array::uniform3(-1f64..1.0),
            steps in -0.8f64..0.8,
            aside in -50f64..50.0,
            is_orthographic: bool,
        ) {
            let projection = if is_orthographic { Projection::Orthographic } else { Projection::Perspective };
            let origin = DVec3::new(4e3, -3e3, 5e3);
            let camera = camera(projection, origin);
            let (place, direction) = (origin + DVec3::from_array(place), DVec3::from_array(direction));
            let ends = [place, place + direction * steps].map(|place| camera.to_px(place, SIZE));
            let [Some(from), Some(to)] = ends else { return Ok(()) };
            let on_screen = to - from;
            prop_assume!(on_screen.length() > 5.0);
            let found = camera.along_line(place, direction, to + aside * on_screen.normalize().perp(), SIZE);
            let found = found.expect("it is in front of the eye");
            prop_assert!((found - steps).abs() < 1e-6, "{} for {}", found, steps);
        }
    }

    #[test]
    fn points_behind_the_eye_have_no_position_and_lines_are_clipped_at_the_near_plane() {
        let camera = camera(Projection::Perspective, DVec3::ZERO);
        let eye = camera.eye_in_world();
        let behind = eye + (eye - camera.target_in_world);
        assert_eq!(camera.to_px(behind, SIZE), None);
        assert_eq!(camera.line_to_px([behind, 2.0 * behind], SIZE), None);
        let center = DVec2::new(320.0, 240.0);
        for ends in [[behind, DVec3::ZERO], [DVec3::ZERO, behind]] {
            let px = camera.line_to_px(ends, SIZE).unwrap();
            assert!(px.iter().all(|px| (*px - center).length() < 1e-6), "{px:?}");
        }
        // Passing the eye, a line leaves the image.
        let aside = camera.view_from_world_rotation().row(0) * 0.5;
        let [first, last] = camera.line_to_px([aside, behind + aside], SIZE).unwrap();
        assert!(first.x < 400.0 && last.x > 1e4, "{first} {last}");
    }
}
