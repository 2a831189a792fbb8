//! Normals against surfaces with a formula. Visible points against all pairs of points in `hidden.rs`, and on surfaces
//! that are seen from the side in `grazing.rs`, and normals of neighbours in `lent.rs`.

mod grazing;
mod hidden;
mod lent;

use super::*;
use crate::cloud::oct_decode;
use glam::{DVec3, Mat3, Vec3};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;

/// A camera at the origin that looks along −z.
fn view(size_px: [u32; 2], px_per_slope: f32) -> ScreenView {
    ScreenView {
        rotation: Mat3::IDENTITY,
        eye_high: Vec3::ZERO,
        eye_low: Vec3::ZERO,
        near: 0.01,
        size_px,
        px_per_slope: [px_per_slope, -px_per_slope],
        center_px: size_px.map(|edge| 0.5 * edge as f32),
    }
}

/// The camera of a depth image of 640×480 pixels.
fn sensor() -> ScreenView {
    view([640, 480], 525.0)
}

fn records(places: impl IntoIterator<Item = Vec3>) -> Vec<PointRecord> {
    let record = |place: Vec3| PointRecord {
        position: place.to_array(),
        color: [255; 4],
    };
    places.into_iter().map(record).collect()
}

/// One point a pixel of the sensor, where `depth_along` knows the depth along a ray with z = −1.
fn depth_image(depth_along: impl Fn(DVec3) -> Option<f64>) -> Vec<PointRecord> {
    let mut places = Vec::new();
    for row in 0..480 {
        for column in 0..640 {
            let [x, y] = [f64::from(column) - 319.5, f64::from(row) - 239.5].map(|px| px / 525.0);
            let ray = DVec3::new(x, -y, -1.0);
            places.extend(depth_along(ray).map(|depth| (depth * ray).as_vec3()));
        }
    }
    records(places)
}

struct Estimated {
    visible: Visible,
    shapes: Vec<ShapeRecord>,
}

fn estimate(view: &ScreenView, points: &[PointRecord], spacing: f32, search: Search) -> Estimated {
    let cloud = ScreenCloud {
        spacing,
        closing: 1.0,
        sensor: None,
    };
    let mut estimator = ScreenEstimator::default();
    let visible = estimator.cull(view, points, &cloud);
    let shapes = estimator.surface(&visible, &cloud, search);
    Estimated { visible, shapes }
}

impl Estimated {
    /// Angles to true normals at the points, ascending, degrees.
    fn errors(&self, points: &[PointRecord], normal_at: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
        let errors = self.visible.slots.iter().zip(&self.shapes).map(|(&slot, shape)| {
            let place = Vec3::from_array(points[slot as usize].position).as_dvec3();
            let normal = oct_decode(shape.normal).as_dvec3();
            normal.cross(normal_at(place)).length().asin().to_degrees()
        });
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        errors
    }
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share) as usize]
}

#[test]
fn a_tilted_plane_without_noise_has_its_normal_at_every_point() {
    for normal in [
        DVec3::Z,
        DVec3::new(0.3, -0.4, 1.0),
        DVec3::new(-1.2, 0.1, 0.9),
        DVec3::new(0.0, 1.4, 1.0),
    ] {
        let normal = normal.normalize();
        // Intersects the view axis at two metres.
        let plane = |ray: DVec3| Some(-2.0 * normal.z / normal.dot(ray)).filter(|depth| (1.0..4.0).contains(depth));
        let points = depth_image(plane);
        let found = estimate(&sensor(), &points, 2.0 / 525.0, Search::Fixed);
        assert!(
            found.visible.len() * 100 > points.len() * 99,
            "{normal}: {}",
            found.visible.len()
        );
        let errors = found.errors(&points, |_| normal);
        assert!(
            errors[errors.len() - 1] < 0.01,
            "{normal}: {}",
            errors[errors.len() - 1]
        );
        for (&slot, shape) in found.visible.slots.iter().zip(&found.shapes) {
            let to_eye = -Vec3::from_array(points[slot as usize].position);
            assert!(oct_decode(shape.normal).dot(to_eye) > 0.0, "turned to the eye");
        }
    }
}

#[test]
fn radii_close_a_square_grid_and_are_at_most_twice_as_large() {
    // A grid that faces the eye, from nearby and from far away.
    for px_per_spacing in [0.3, 0.8, 1.0, 1.7, 2.5, 3.4, 6.0, 11.0, 40.0] {
        let spacing = 0.01;
        let points = records((0..160 * 120).map(|index| {
            let (column, row) = ((index % 160) as f32, (index / 160) as f32);
            Vec3::new((column - 79.5) * spacing, (row - 59.5) * spacing, -1.0)
        }));
        let found = estimate(
            &view([640, 480], px_per_spacing / spacing),
            &points,
            spacing,
            Search::Fixed,
        );
        let mut radii: Vec<f64> = found
            .shapes
            .iter()
            .map(|shape| f64::from(shape.radius / spacing.max(spacing / px_per_spacing)))
            .collect();
        radii.sort_by(f64::total_cmp);
        // Half a diagonal closes it (of a pixel where pixels are larger); at the edge of the grid half of the
        // neighbourhood is empty.
        let (min, median) = (radii[0], quantile(&radii, 0.5));
        assert!(min > 0.7, "{px_per_spacing}: {min}");
        assert!((0.75..1.5).contains(&median), "{px_per_spacing}: {median}");
    }
}

/// A ball of a quarter of a metre, a metre away.
fn ball(ray: DVec3) -> Option<f64> {
    let center = DVec3::new(0.0, 0.0, -1.0);
    let (square, along) = (ray.length_squared(), ray.dot(center));
    let under_root = along * along - square * (1.0 - 0.25 * 0.25);
    (under_root > 0.0).then(|| (along - under_root.sqrt()) / square)
}

const TUBE: [f64; 2] = [0.25, 0.1];

/// Distance of a place to a torus a metre away, whose axis is tilted.
fn torus_distance(place: DVec3) -> f64 {
    let axis = DVec3::new(0.0, 0.5, 1.0).normalize();
    let from_center = place + DVec3::Z;
    let along = from_center.dot(axis);
    let around = (from_center - along * axis).length();
    (around - TUBE[0]).hypot(along) - TUBE[1]
}

fn torus_normal(place: DVec3) -> DVec3 {
    let step = 1e-5;
    let slope = |axis: DVec3| torus_distance(place + step * axis) - torus_distance(place - step * axis);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize()
}

/// By sphere tracing.
fn torus(ray: DVec3) -> Option<f64> {
    let mut depth = 0.3;
    for _ in 0..400 {
        let distance = torus_distance(depth * ray);
        if distance < 1e-9 {
            return Some(depth);
        }
        depth += distance / ray.length();
        if depth > 2.0 {
            return None;
        }
    }
    None
}

#[test]
fn curved_surfaces_have_their_normals_but_at_their_rims() {
    let ball_normal = |place: DVec3| (place + DVec3::Z).normalize();
    let spacing = 1.0 / 525.0;
    for search in [Search::Fixed, Search::Bisected] {
        let points = depth_image(ball);
        // For the ball, this is the mean spacing of its front.
        let errors = estimate(&sensor(), &points, spacing, search).errors(&points, ball_normal);
        let [median, max] = [0.5, 0.95].map(|share| quantile(&errors, share));
        assert!(median < 0.3 && max < 5.0, "ball {search:?}: {median} {max}");
        let points = depth_image(torus);
        assert!(points.len() > 20_000);
        let errors = estimate(&sensor(), &points, spacing, search).errors(&points, torus_normal);
        let [median, max] = [0.5, 0.95].map(|share| quantile(&errors, share));
        assert!(median < 0.6 && max < 8.0, "torus {search:?}: {median} {max}");
    }
}

#[test]
fn normals_face_the_sensor_where_one_is_known() {
    let points = depth_image(|_| Some(1.5));
    let (view, mut estimator) = (sensor(), ScreenEstimator::default());
    let cloud = ScreenCloud {
        spacing: 1.5 / 525.0,
        closing: 1.0,
        sensor: Some(Vec3::new(0.0, 0.0, -9.0)),
    };
    let visible = estimator.cull(&view, &points, &cloud);
    let shapes = estimator.surface(&visible, &cloud, Search::Fixed);
    assert!(shapes.iter().all(|shape| oct_decode(shape.normal).z < -0.99));
}

#[test]
fn a_wall_behind_another_is_hidden() {
    let wall = |depth: f64| depth_image(move |_| Some(depth));
    let (front, behind) = (wall(1.0), wall(1.2));
    let points: Vec<PointRecord> = behind.iter().chain(&front).copied().collect();
    // From somewhere between the pixels of the sensor, and nearer than it.
    let view = ScreenView {
        eye_high: Vec3::new(0.013, -0.007, -0.1),
        ..view([1280, 960], 1000.0)
    };
    let visible = estimate(&view, &points, 1.0 / 525.0, Search::Fixed).visible;
    assert!(visible.slots.iter().all(|&slot| slot as usize >= behind.len()));
    // Everything in the image.
    let is_in_picture = |point: &&PointRecord| {
        let place = view.see(point.position).unwrap().place_px;
        place[0] >= 0.0 && place[0] < 1280.0 && place[1] >= 0.0 && place[1] < 960.0
    };
    assert!(visible.len() >= front.iter().filter(is_in_picture).count());
}

#[test]
fn results_are_independent_of_thread_count_and_repeatable() {
    let points: Vec<PointRecord> = depth_image(torus).into_iter().chain(depth_image(ball)).collect();
    let in_pool = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| estimate(&sensor(), &points, 0.002, Search::Fixed))
    };
    let once = in_pool(1);
    for threads in [2, 7] {
        let other = in_pool(threads);
        assert_eq!(once.visible.slots, other.visible.slots);
        assert_eq!(once.shapes, other.shapes);
    }
    // Buffers reused from another image do not affect the result.
    let (view, cloud) = (
        sensor(),
        ScreenCloud {
            spacing: 0.002,
            closing: 1.0,
            sensor: None,
        },
    );
    let mut estimator = ScreenEstimator::default();
    let other = records((0..1000).map(|index| Vec3::new(0.0, index as f32 * 1e-3, -0.5)));
    let visible = estimator.cull(&self::view([1001, 77], 300.0), &other, &cloud);
    estimator.surface(&visible, &cloud, Search::Bisected);
    let visible = estimator.cull(&view, &points, &cloud);
    assert_eq!(visible.slots, once.visible.slots);
    assert_eq!(estimator.surface(&visible, &cloud, Search::Fixed), once.shapes);
}

#[test]
fn a_few_points_and_lines_have_disks_that_face_the_eye() {
    let line = records((0..50).map(|step| Vec3::new(step as f32 * 0.01, 0.0, -1.0)));
    let found = estimate(&sensor(), &line, 0.01, Search::Fixed);
    assert_eq!(found.visible.len(), 50);
    for (point, shape) in line.iter().zip(&found.shapes) {
        let to_eye = -Vec3::from_array(point.position).normalize();
        assert!(oct_decode(shape.normal).dot(to_eye) > 0.999 && shape.radius > 0.005);
    }
    let one = records([Vec3::new(0.1, 0.1, -3.0)]);
    for spacing in [0.0, 0.1, f32::NAN, f32::INFINITY, -1.0] {
        let found = estimate(&sensor(), &one, spacing, Search::Fixed);
        assert_eq!(found.shapes.len(), 1);
    }
    assert!(estimate(&sensor(), &[], 0.1, Search::Bisected).shapes.is_empty());
}

proptest! {
    #[test]
    fn any_numbers_give_finite_disks(
        places in prop::collection::vec(prop::array::uniform3(prop_oneof![
            -2f32..2.0, Just(f32::NAN), Just(f32::INFINITY), Just(f32::MAX), Just(-f32::MAX), Just(1e-40), Just(0.0),
        ]), 0..60),
        spacing in prop_oneof![0f32..1.0, Just(f32::NAN), Just(f32::MAX), Just(-1.0)],
        size in (1u32..40, 1u32..40),
        px_per_slope in prop_oneof![1f32..100.0, Just(1e30), Just(1e-30)],
    ) {
        let points = records(places.into_iter().map(Vec3::from_array));
        for search in [Search::Fixed, Search::Bisected] {
            let found = estimate(&view([size.0, size.1], px_per_slope), &points, spacing, search);
            prop_assert_eq!(found.visible.len(), found.shapes.len());
            for shape in found.shapes {
                prop_assert!(!shape.radius.is_nan() && shape.radius >= 0.0);
            }
        }
    }
}
