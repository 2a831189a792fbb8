//! Points without a plane around them: floors seen from the side, whose neighbours are in one row.

use super::*;

/// A floor so far below the sensor, which looks along it.
const FLOOR: f64 = -0.4;

/// The floor as a depth camera sees it, in millimetres: rows whose spacing grows with distance.
fn floor_in_rows() -> Vec<PointRecord> {
    depth_image(|ray| {
        let depth = (1e3 * FLOOR / ray.y).round() / 1e3;
        (ray.y < 0.0 && depth < 3.0).then_some(depth)
    })
}

/// Normals of the visible points.
fn normals(eye: Vec3, points: &[PointRecord], sensor: Option<Vec3>) -> Vec<Vec3> {
    let view = ScreenView {
        eye_high: eye,
        ..view([1280, 720], 900.0)
    };
    let cloud = ScreenCloud {
        spacing: 0.0035,
        closing: 1.0,
        sensor,
    };
    let mut estimator = ScreenEstimator::default();
    let visible = estimator.cull(&view, points, &cloud);
    let shapes = estimator.surface(&visible, &cloud, Search::Fixed);
    shapes.iter().map(|shape| oct_decode(shape.normal)).collect()
}

#[test]
fn points_without_a_plane_use_that_of_a_neighbour() {
    let points = floor_in_rows();
    // A sixth and a seventeenth of them used to face the eye.
    for (above, share) in [(0.3, 10), (0.4, 500)] {
        let eye = Vec3::new(0.0, FLOOR as f32 + above, 0.6);
        let normals = normals(eye, &points, None);
        // Normals that face the eye are farther off.
        let wrong = normals.iter().filter(|normal| normal.y.abs() < 0.7).count();
        assert!(normals.len() > 10_000, "{}", normals.len());
        assert!(
            wrong * share <= normals.len(),
            "{above} above: {wrong} of {}",
            normals.len()
        );
    }
}

#[test]
fn normals_are_not_borrowed_from_beyond_the_search_radius() {
    // A wall, and isolated points in front of it.
    let wall = depth_image(|ray| (ray.x.abs() < 0.3 && ray.y.abs() < 0.3).then_some(2.0 + 0.8 * ray.x));
    let alone = [Vec3::new(0.02, 0.03, -1.0), Vec3::new(-0.1, 0.1, -0.8)];
    let points: Vec<PointRecord> = wall.into_iter().chain(records(alone)).collect();
    let found = estimate(&sensor(), &points, 0.004, Search::Fixed);
    let mut told = 0;
    for (&slot, shape) in found.visible.slots.iter().zip(&found.shapes) {
        let place = Vec3::from_array(points[slot as usize].position);
        if alone.contains(&place) {
            assert!(oct_decode(shape.normal).dot(-place.normalize()) > 0.999_9, "{place}");
            assert!(shape.radius > 0.0);
            told += 1;
        }
    }
    assert_eq!(told, alone.len());
}

#[test]
fn borrowed_normals_face_the_sensor() {
    let points = floor_in_rows();
    // From below the floor, with the sensor above it.
    let eye = Vec3::new(0.0, FLOOR as f32 - 0.4, 0.6);
    let normals = normals(eye, &points, Some(Vec3::ZERO));
    let down = normals.iter().filter(|normal| normal.y < 0.0).count();
    assert!(
        normals.len() > 10_000 && down * 500 <= normals.len(),
        "{down} of {}",
        normals.len()
    );
}
