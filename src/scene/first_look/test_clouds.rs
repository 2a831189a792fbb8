//! Clouds for tests of first looks.

use super::sample::CloudSample;
use crate::math::Aabb;
use crate::scene::UpAxis;
use glam::Vec3;

/// The sample of some points, and their box.
pub(super) fn sample(points: Vec<Vec3>) -> (CloudSample, Aabb) {
    let bounds = Aabb::from_points(&points);
    let spacing = vec![0.1; points.len()];
    let sample = CloudSample {
        positions: points,
        spacing,
        ..CloudSample::default()
    };
    (sample, bounds)
}

/// Numbers from 0 to 1 that look random, the same each time.
pub(super) fn numbers(count: usize) -> impl Iterator<Item = [f32; 3]> {
    let fraction = |value: f64| value.fract() as f32;
    let step = |index: usize| index as f64 + 0.5;
    (0..count).map(move |index| [0.618_034, 0.754_878, 0.569_840].map(|ratio| fraction(ratio * step(index))))
}

/// Returns the points with Z as the up axis, and the same with Y.
pub(super) fn turned(points: &[Vec3]) -> [(UpAxis, Vec<Vec3>); 2] {
    let along_y = points.iter().map(|p| Vec3::new(p.x, p.z, -p.y)).collect();
    [(UpAxis::Z, points.to_vec()), (UpAxis::Y, along_y)]
}
