//! Depth images of a scene that is made here: a ball of half a metre before a wall, with the noise, the steps, the
//! outliers and the holes of a sensor.

use crate::bench::BenchError;
use crate::cloud::{Positions, RawCloud};
use crate::rgbd::{Camera, DepthImage, Distortion};
use glam::{DAffine3, DMat3, DVec2, DVec3};

/// Size of an image, as of most depth cameras.
pub(super) const MADE_PX: [u32; 2] = [640, 480];

const FOCAL_PX: f64 = 525.0;
const PRINCIPAL_PX: [f64; 2] = [319.5, 239.5];

/// Centre of the ball.
pub(super) const SCENE_CENTER: DVec3 = DVec3::new(0.0, 0.0, 1.5);

const BALL_RADIUS: f64 = 0.5;

/// The image from the position of the first sensor, which looks along z.
pub(super) fn made() -> Option<DepthImage> {
    let metres = (0..MADE_PX[0] * MADE_PX[1]).map(|at| measured_z(&DAffine3::IDENTITY, at, 0));
    DepthImage::new(MADE_PX, metres.map(|z| z as f32).collect())
}

/// Its camera, or one with another number of pixels.
pub(super) fn pinhole(size_px: [u32; 2]) -> Result<Camera, BenchError> {
    let camera = Camera::new(size_px, DVec2::splat(FOCAL_PX), PRINCIPAL_PX.into(), Distortion::None);
    camera.map_err(|error| BenchError::Nothing(error.to_string()))
}

/// About `points` points of the scene: every pixel of several images, or some pixels of one.
pub(super) fn made_cloud(points: usize) -> RawCloud {
    let pixels = (MADE_PX[0] * MADE_PX[1]) as usize;
    // Nine of ten pixels have a measurement.
    let views = (points as f64 / (0.92 * pixels as f64)).ceil().max(1.0) as u32;
    let step = (0.92 * pixels as f64 / points as f64).sqrt().round().max(1.0) as u32;
    let mut positions = Vec::new();
    for view in 0..views {
        let pose = pose(view);
        for row in (0..MADE_PX[1]).step_by(step as usize) {
            for column in (0..MADE_PX[0]).step_by(step as usize) {
                let z = measured_z(&pose, row * MADE_PX[0] + column, view);
                if z > 0.0 {
                    let place = pose.transform_point3(z * ray(column, row));
                    positions.push(place.as_vec3().to_array());
                }
            }
        }
    }
    RawCloud::from_positions(Positions::F32(positions))
}

/// Returns the sensor pose of a view: around the first, all look at the ball.
fn pose(view: u32) -> DAffine3 {
    if view == 0 {
        return DAffine3::IDENTITY;
    }
    // Evenly distributed by the golden ratio.
    let (across, up) = (f64::from(view) * 0.618_034, f64::from(view) * 0.754_878);
    let place = DVec3::new(0.6 * (across.fract() - 0.5), 0.4 * (up.fract() - 0.5), 0.0);
    let forward = (SCENE_CENTER - place).normalize();
    let right = DVec3::Y.cross(forward).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(right, forward.cross(right), forward), place)
}

/// The ray of a pixel in the frame of the camera: x right, y down, z 1.
fn ray(column: u32, row: u32) -> DVec3 {
    let [x, y] = [f64::from(column) - PRINCIPAL_PX[0], f64::from(row) - PRINCIPAL_PX[1]];
    DVec3::new(x / FOCAL_PX, y / FOCAL_PX, 1.0)
}

/// Returns the depth that a sensor measures at a pixel, metres; 0 where it measures nothing.
fn measured_z(pose: &DAffine3, at: u32, view: u32) -> f64 {
    let z = true_z(pose, ray(at % MADE_PX[0], at / MADE_PX[0]));
    let seed = at.wrapping_add(view.wrapping_mul(0x9e37_79b9));
    let random = |turn: u32| f64::from(seed.wrapping_mul(2_654_435_761).rotate_left(turn) >> 8) / f64::from(1 << 24);
    let noise = (0.0012 + 0.0019 * (z - 0.4).powi(2)) * (random(0) + random(7) + random(13) - 1.5) * 2.0;
    match random(19) {
        share if share < 0.08 => 0.0,
        share if share < 0.085 => z + 0.5,
        _ => ((z + noise) * 1000.0).round() / 1000.0,
    }
}

/// The depth of the scene along a ray of a sensor.
fn true_z(pose: &DAffine3, ray: DVec3) -> f64 {
    let (from, along) = (pose.translation, pose.transform_vector3(ray));
    // |from + t·along − centre|² = radius².
    let to_center = SCENE_CENTER - from;
    let (square, center) = (along.length_squared(), along.dot(to_center));
    let under_root = center * center - square * (to_center.length_squared() - BALL_RADIUS * BALL_RADIUS);
    if under_root > 0.0 {
        return (center - under_root.sqrt()) / square;
    }
    // The wall: z − 0.15 x = 2.
    let wall = DVec3::new(-0.15, 0.0, 1.0);
    (2.0 - wall.dot(from)) / wall.dot(along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn synthetic_images_have_the_holes_and_range_of_a_sensor() {
        let image = made().unwrap();
        let valid = image.valid_count() as f64 / image.metres().len() as f64;
        assert!((0.90..0.94).contains(&valid), "{valid}");
        let center = image.metres()[640 * 240 + 322];
        assert!(center == 0.0 || (0.95..1.6).contains(&center), "{center}");
        assert_eq!(Some(image), made());
    }

    #[test]
    fn merged_views_show_one_scene() {
        let cloud = made_cloud(36_000);
        assert!((30_000..40_000).contains(&cloud.positions.len()));
        for view in [0, 3, 11] {
            let pose = pose(view);
            for (column, row) in [(320, 240), (20, 30), (600, 400)] {
                let ray = ray(column, row);
                let place = pose.transform_point3(true_z(&pose, ray) * ray);
                let off_ball = (place.distance(SCENE_CENTER) - BALL_RADIUS).abs();
                let off_wall = (place.z - 0.15 * place.x - 2.0).abs();
                assert!(off_ball.min(off_wall) < 1e-9, "{view}: {place}");
            }
        }
    }
}
