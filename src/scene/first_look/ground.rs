//! The up axis if coordinates or normals of the file determine it.
//!
//! **How it works.** Each rule looks at one thing that surveying or a camera makes:
//!
//! - *Map coordinates.* Eastings and northings are large numbers, elevations are not.
//! - *Undersides alone.* Surfaces facing down are seldom all of a scan: a camera that looks along +Z saw them.

use super::sample::CloudSample;
use super::up::{Up, along};
use crate::math::Aabb;
use crate::scene::UpAxis;
use glam::Vec3;

/// The axis with small coordinates if the two others are map coordinates. `zero` is the zero of the file.
pub(super) fn of_map_coordinates(bounds: &Aabb, zero: Vec3) -> Option<Up> {
    /// Eastings have six digits, northings six or seven; no summit is higher than 9 km.
    const MIN_MAP: f32 = 5e4;
    const MAX_ELEVATION: f32 = 9e3;
    let center = bounds.center() - zero;
    let extent = bounds.extent().max_element();
    let is_map = |axis: usize| center[axis].abs() >= MIN_MAP && center[axis].abs() >= 4.0 * extent;
    let is_elevation = |axis: usize| center[axis].abs() <= MAX_ELEVATION;
    let up = (0..3).find(|&axis| is_elevation(axis) && (0..3).all(|other| other == axis || is_map(other)))?;
    Some(Up::by_points(
        along(up, true),
        "the two other axes are coordinates of a map",
    ))
}

/// The axes of a camera, if the normals of the file indicate that everything faces -Z: with Z up that would be a
/// ceiling.
pub(super) fn of_undersides(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Shares of normals within 60° of -Z and of +Z.
    const MIN_BELOW: f32 = 0.6;
    const MAX_ABOVE: f32 = 0.03;
    let share = |is_meant: fn(&Vec3) -> bool| {
        let count = sample.normals.iter().filter(|normal| is_meant(normal)).count();
        count as f32 / sample.normals.len().max(1) as f32
    };
    let faces_camera = share(|normal| normal.z < -0.5) >= MIN_BELOW && share(|normal| normal.z > 0.5) <= MAX_ABOVE;
    // A map with heights counted downwards faces that way as well.
    (faces_camera && !bounds.is_flat_along_z()).then(|| {
        Up::by_points(
            UpAxis::NegY,
            "what was scanned faces -Z, towards a camera that looks along +Z: Y is down",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::test_clouds::{numbers, sample};
    use super::*;

    #[test]
    fn a_wall_that_faces_a_camera_has_y_down() {
        let wall: Vec<Vec3> = numbers(4000)
            .map(|[a, b, c]| Vec3::new(3.0 * a, 2.0 * b, 2.0 + 0.8 * c))
            .collect();
        let (mut sample, bounds) = sample(wall);
        assert_eq!(of_undersides(&sample, &bounds), None, "without normals");
        let up = |sample: &CloudSample| of_undersides(sample, &bounds).map(|up| up.axis);
        let front = |index: usize| if index.is_multiple_of(4) { Vec3::X } else { Vec3::NEG_Z };
        sample.normals = (0..4000).map(front).collect();
        assert_eq!(up(&sample), Some(UpAxis::NegY));
        sample.normals.iter_mut().for_each(|normal| *normal = -*normal);
        assert_eq!(up(&sample), None, "ground seen from above");
        let both = |index: usize| if index.is_multiple_of(8) { Vec3::Z } else { Vec3::NEG_Z };
        sample.normals = (0..4000).map(both).collect();
        assert_eq!(up(&sample), None, "seen from both sides");
    }

    #[test]
    fn the_elevation_axis_is_the_small_one_of_map_coordinates() {
        let bounds = Aabb::from_points(&[Vec3::ZERO, Vec3::new(200.0, 150.0, 30.0)]);
        let up = |zero: Vec3| of_map_coordinates(&bounds, zero).map(|up| up.axis);
        assert_eq!(up(Vec3::new(-431_000.0, -4_581_000.0, -120.0)), Some(UpAxis::Z));
        assert_eq!(up(Vec3::new(-431_000.0, -120.0, 4_581_000.0)), Some(UpAxis::Y));
        assert_eq!(up(Vec3::ZERO), None);
        assert_eq!(up(Vec3::splat(-4e6)), None, "geocentric");
    }
}
