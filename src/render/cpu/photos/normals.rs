//! Depth-map normals of the surfaces in images (Yang et al. 2006 §4.1, Eqs. 5–7), for relighting.
//!
//! How it works: the four texels around a depth are projected back to positions in camera space, each with its own
//! depth, and the normal is perpendicular to the vectors between opposite ones: `(l − r) × (u − d)`. Depths are along
//! the axis, so planes have exact normals. There is no normal where one of the four is beyond a step, or unknown; nor
//! where the surface is seen at more than 80° from its normal, as at silhouettes the vectors are as long as the surface
//! is curved. Between texels, the normals of the four around a position are blended. Nothing is stored: a rendered
//! frame asks for some 16 normals per pixel, which are fewer than in all maps.
//!
//! The same arithmetic: `shaders/common/photos.wgsl`.

use crate::render::constants::PHOTO_MIN_FACING;
use crate::scene::{DepthMap, PhotoView};
use glam::{Vec3, Vec4};

/// A depth map with the lens that it was seen through, in its own texels.
struct DepthView<'a> {
    map: &'a DepthMap,
    focal: [f32; 2],
    principal: [f32; 2],
}

/// Returns the depth-map normal of the surface in an image, in the view space of the rendered frame, of length 1 and
/// towards its camera; zero where it cannot be determined from the depths. `place` is in texels of the finest level of
/// the image.
#[inline(always)]
pub(super) fn normal(map: &DepthMap, view: &PhotoView, place: [f32; 2]) -> Vec3 {
    let scale = [0, 1].map(|axis| map.size[axis] as f32 / view.size[axis]);
    let seen = DepthView {
        map,
        focal: [0, 1].map(|axis| view.focal[axis] * scale[axis]),
        principal: [0, 1].map(|axis| view.principal[axis] * scale[axis]),
    };
    let in_camera = seen.between_texels([0, 1].map(|axis| place[axis] * scale[axis]));
    let [x, y, z] = view.camera_from_view.map(Vec4::truncate);
    in_camera.x * x + in_camera.y * y + in_camera.z * z
}

impl DepthView<'_> {
    /// Between the four texels around a place.
    #[inline(always)]
    fn between_texels(&self, place: [f32; 2]) -> Vec3 {
        let [(left, right, across), (top, bottom, down)] = [0, 1].map(|axis| {
            let last = self.map.size[axis] as i32 - 1;
            // Not `clamp`: NaN has to end up at the border.
            let at = (place[axis] - 0.5).max(0.0).min(last as f32);
            let before = at as i32;
            (before, (before + 1).min(last), at - before as f32)
        });
        // Computed where needed, about 16 per pixel: normal maps would take three times the memory of the depths.
        let sum = self.at(left, top) * ((1.0 - across) * (1.0 - down))
            + self.at(right, top) * (across * (1.0 - down))
            + self.at(left, bottom) * ((1.0 - across) * down)
            + self.at(right, bottom) * (across * down);
        sum.normalize_or_zero()
    }

    /// The normal of a texel in the space of the camera.
    #[inline(always)]
    fn at(&self, column: i32, row: i32) -> Vec3 {
        let midpoint = self.place(column, row);
        let [left, right] = [self.place(column - 1, row), self.place(column + 1, row)];
        let [up, down] = [self.place(column, row - 1), self.place(column, row + 1)];
        let tolerance = self.map.tolerance;
        let is_near = |other: Vec3| other.z > 0.0 && (other.z - midpoint.z).abs() <= tolerance;
        if !(midpoint.z > 0.0 && is_near(left) && is_near(right) && is_near(up) && is_near(down)) {
            return Vec3::ZERO;
        }
        let normal = (left - right).cross(up - down).normalize_or_zero();
        let facing = -normal.dot(midpoint) / midpoint.length();
        if facing.abs() < PHOTO_MIN_FACING {
            Vec3::ZERO
        } else {
            normal * facing.signum()
        }
    }

    /// Returns the position at a texel, in camera space; at the camera if unknown. Texels beyond the border are clamped
    /// to it.
    #[inline(always)]
    fn place(&self, column: i32, row: i32) -> Vec3 {
        let [width, height] = self.map.size.map(|edge| edge as i32);
        let [column, row] = [column.max(0).min(width - 1), row.max(0).min(height - 1)];
        let distance = self.map.distances[(width * row + column) as usize].abs();
        let slope = |axis: usize, texel: i32| (texel as f32 + 0.5 - self.principal[axis]) / self.focal[axis];
        distance * Vec3::new(slope(0, column), slope(1, row), 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EDGE: u32 = 256;

    /// The camera is where the eye is, and looks as it does.
    fn view(edge_px: u32) -> PhotoView {
        PhotoView {
            camera_from_view: [
                Vec4::new(1.0, 0.0, 0.0, 0.0),
                Vec4::new(0.0, -1.0, 0.0, 0.0),
                Vec4::new(0.0, 0.0, -1.0, 0.0),
            ],
            center: Vec3::ZERO,
            focal: [1.2 * edge_px as f32, 1.3 * edge_px as f32],
            principal: [0.52 * edge_px as f32, 0.47 * edge_px as f32],
            size: [edge_px as f32; 2],
            gain: Vec3::ONE,
        }
    }

    /// The ray through a place, in the space of the camera.
    fn ray(view: &PhotoView, place: [f32; 2]) -> Vec3 {
        let slope = |axis: usize| (place[axis] - view.principal[axis]) / view.focal[axis];
        Vec3::new(slope(0), slope(1), 1.0)
    }

    /// The map of a surface by its intersection with each ray: a factor on it, 0 for nothing.
    fn map(edge_px: u32, view: &PhotoView, along: impl Fn(Vec3) -> f32) -> DepthMap {
        let per_texel = view.size[0] / edge_px as f32;
        let midpoints = (0..edge_px * edge_px).map(|at| [at % edge_px, at / edge_px]);
        let distances = midpoints.map(|texel| along(ray(view, texel.map(|at| (at as f32 + 0.5) * per_texel))));
        DepthMap::new([edge_px; 2], distances.collect(), 1.0, true)
    }

    fn degrees_between(a: Vec3, b: Vec3) -> f32 {
        // Not by the cosine, which has no precision for small angles.
        a.cross(b).length().atan2(a.dot(b)).to_degrees()
    }

    fn in_view(in_camera: Vec3) -> Vec3 {
        Vec3::new(in_camera.x, -in_camera.y, -in_camera.z)
    }

    const CENTER: Vec3 = Vec3::new(0.05, -0.03, 3.0);
    const RADIUS: f32 = 0.9;

    /// Intersection of a ray with a ball around [`CENTER`].
    fn on_ball(ray: Vec3) -> f32 {
        let (a, b) = (ray.length_squared(), ray.dot(CENTER));
        let below = b * b - a * (CENTER.length_squared() - RADIUS * RADIUS);
        if below < 0.0 { 0.0 } else { (b - below.sqrt()) / a }
    }

    proptest! {
        // Each case renders a map.
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn planes_have_exact_normals(
            [tilt, turn] in [-1.2_f32..1.2, -1.2_f32..1.2],
            [x, y] in [8.0_f32..248.0, 8.0_f32..248.0],
        ) {
            let view = view(EDGE);
            let expected = Vec3::new(turn.sin(), tilt.sin() * turn.cos(), -(tilt.cos() * turn.cos()));
            let through = Vec3::new(0.0, 0.0, 3.0);
            let map = map(EDGE, &view, |ray| expected.dot(through) / expected.dot(ray));
            let facing = -expected.dot(ray(&view, [x, y]).normalize());
            // Skips planes seen edge-on, from behind, or beyond the tolerance from texel to texel.
            prop_assume!(facing > 0.3);
            let found = normal(&map, &view, [x, y]);
            prop_assert!(degrees_between(found, in_view(expected)) < 0.1, "{found} {expected}");
        }
    }

    #[test]
    fn spheres_have_exact_normals() {
        let view = view(512);
        let map = map(512, &view, on_ball);
        let mut compared = 0;
        for at in 0..64 * 64 {
            // Between texels, at all fractions.
            let place = [at % 64, at / 64].map(|step| 8.13 * step as f32);
            let ray = ray(&view, place);
            let expected = (on_ball(ray) * ray - CENTER) / RADIUS;
            let facing = -expected.dot(ray.normalize());
            if on_ball(ray) > 0.0 && facing > 70.0_f32.to_radians().cos() {
                let found = normal(&map, &view, place);
                assert!(
                    degrees_between(found, in_view(expected)) < 0.1,
                    "{place:?}: {found} {expected}"
                );
                compared += 1;
            }
        }
        assert!(compared > 500, "{compared} places");
    }

    /// A map of a quarter of the texels gives the same, less exactly.
    #[test]
    fn depth_maps_coarser_than_images_are_sampled_in_their_own_texels() {
        let view = view(512);
        let map = map(256, &view, on_ball);
        for place in [[270.0, 230.0], [301.25, 199.0], [200.5, 260.75]] {
            let ray = ray(&view, place);
            let expected = (on_ball(ray) * ray - CENTER) / RADIUS;
            let found = normal(&map, &view, place);
            assert!(
                degrees_between(found, in_view(expected)) < 0.2,
                "{place:?}: {found} {expected}"
            );
        }
    }

    #[test]
    fn there_are_no_normals_next_to_steps_or_at_grazing_angles() {
        let view = view(EDGE);
        let neighbor = |place: [f32; 2]| {
            let step = map(EDGE, &view, |ray| if ray.x < 0.0 { 3.0 } else { 5.0 });
            normal(&step, &view, place)
        };
        // Rays to the left of the principal point end at the nearer wall.
        let edge = view.principal[0].round();
        assert_eq!(neighbor([edge, 100.0]), Vec3::ZERO);
        assert_eq!(neighbor([edge - 5.0, 100.0]), Vec3::Z);
        assert_eq!(neighbor([edge + 5.0, 100.0]), Vec3::Z);
        let hole = map(EDGE, &view, |ray| if ray.x.hypot(ray.y) < 0.002 { 0.0 } else { 3.0 });
        let at_hole = [0, 1].map(|axis| view.principal[axis].floor() + 0.5);
        assert_eq!(normal(&hole, &view, at_hole), Vec3::ZERO);
        let slanted = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let slope = map(EDGE, &view, |ray| 3.0 * cos / (cos * ray.z + sin * ray.x));
            normal(&slope, &view, view.principal)
        };
        assert!(slanted(78.0) != Vec3::ZERO);
        assert_eq!(slanted(82.0), Vec3::ZERO);
    }

    #[test]
    fn nan_places_and_single_texel_maps_have_no_normals() {
        let view = view(EDGE);
        let map = map(EDGE, &view, |_| 3.0);
        for place in [[f32::NAN, 2.0], [f32::INFINITY, -4.0], [-1e30, 1e30]] {
            assert!(normal(&map, &view, place).is_finite());
        }
        let one = DepthMap::new([1, 1], vec![3.0], 1.0, true);
        assert_eq!(normal(&one, &view, [3.0, 3.0]), Vec3::ZERO);
    }
}
