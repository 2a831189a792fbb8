//! Robust planes, and planes of less than all points.

use super::test_shapes::{self, Random};
use super::tests::angles;
use super::*;
use crate::cloud::{Frame, Positions, RawCloud};
use glam::DVec3;

/// Mean angle of normals to the truth, either sign, in degrees.
fn mean_error(positions: &[Vec3], truth: &[Vec3], k: usize, fit: PlaneFit) -> f32 {
    let found = estimate_planes(positions, k, fit).normals;
    let toward: Vec<Vec3> = found
        .iter()
        .zip(truth)
        .map(|(found, truth)| found * found.dot(*truth).signum())
        .collect();
    angles(&toward, truth).0
}

#[test]
fn robust_planes_pass_by_outliers_and_edges() {
    let mut random = Random(18);
    let errors = |positions: &[Vec3], truth: &[Vec3], k| {
        PlaneFit::ALL.map(|fit| mean_error(positions, truth, k, fit))
    };
    let sphere = test_shapes::sphere(10_000, &mut random);
    let cube = test_shapes::cuboid(10_000, Vec3::ONE, &mut random);
    for k in [16, 32] {
        // Clean and smooth: hardly worse. Beside edges: better.
        let [plain, robust] = errors(&sphere.positions, &sphere.normals, k);
        assert!(robust < 1.2 * plain, "{robust} for {plain} degrees, {k}");
        let [plain, robust] = errors(&cube.positions, &cube.normals, k);
        assert!(robust < 0.9 * plain, "{robust} for {plain} degrees, {k}");
        // One in twenty points is off by several spacings.
        let mut scattered = sphere.positions.clone();
        for position in scattered.iter_mut().step_by(20) {
            *position += 0.1 * random.cube();
        }
        let [plain, robust] = errors(&scattered, &sphere.normals, k);
        assert!(robust < 0.6 * plain, "{robust} for {plain} degrees, {k}");
    }
}

#[test]
fn robust_planes_are_defined_where_plain_ones_are() {
    let mut random = Random(19);
    let line: Vec<Vec3> = (0..50)
        .map(|i| Vec3::new(1.0, 2.0, 0.5) * i as f32)
        .collect();
    let lattice: Vec<Vec3> = (0..400)
        .map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0))
        .collect();
    let cube: Vec<Vec3> = (0..500).map(|_| random.cube()).collect();
    for cloud in [
        &[][..],
        &[Vec3::ONE],
        &[Vec3::ONE; 40],
        &line,
        &lattice,
        &cube,
    ] {
        let [plain, robust] = PlaneFit::ALL.map(|fit| estimate_planes(cloud, 12, fit));
        assert_eq!(plain.without_plane, robust.without_plane);
        assert!(robust.normals.iter().all(|normal| normal.is_normalized()));
    }
    let on_plane = estimate_planes(&lattice, 12, PlaneFit::Robust).normals;
    assert!(
        on_plane
            .iter()
            .all(|normal| normal.abs().abs_diff_eq(Vec3::Z, 1e-6))
    );
}

#[test]
fn planes_asked_for_are_those_of_the_whole_and_no_others_are_estimated() {
    let torus = test_shapes::torus(30_000, 0.4, &mut Random(20));
    let raw = RawCloud::from_positions(Positions::F64(
        torus
            .positions
            .iter()
            .map(|p| p.as_dvec3().to_array())
            .collect(),
    ));
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let positions = frame.positions();
    let sensor = Vec3::new(3.0, -1.0, 2.0);
    let whole = estimate_planes(positions, 16, PlaneFit::LeastSquares);
    let facing = estimate_surface(positions, Some(sensor)).normals;
    let lazy = LazyPlanes::new(positions, 16, None);
    let lazy_facing = LazyPlanes::new(positions, DEFAULT_NEIGHBOURS, Some(sensor));
    assert_eq!(lazy.estimated_points(), 0);
    // Three hundredths of the points, asked for from two threads and again.
    let some = 12_000..12_900;
    let (first, second) = rayon::join(|| lazy.of(some.clone()), || lazy.of(some.clone()));
    assert_eq!(first, second);
    assert!(first.normals == whole.normals[some.clone()]);
    assert!(lazy_facing.of(some.clone()).normals == facing[some.clone()]);
    let estimated = lazy.estimated_points();
    assert!((900..9_000).contains(&estimated), "{estimated} of 30,000");
    assert_eq!(lazy.of(some).normals.len(), 900);
    assert_eq!(lazy.estimated_points(), estimated, "each block once");
    assert!(lazy.of(0..30_000) == whole);
    assert_eq!(lazy.estimated_points(), 30_000);
    assert!(lazy.of(0..0).normals.is_empty());
}

#[test]
fn planes_asked_for_of_any_cloud_are_those_of_the_whole() {
    let mut random = Random(21);
    let row: Vec<Vec3> = (0..700).map(|i| Vec3::X * i as f32).collect();
    let equal = vec![Vec3::ONE; 600];
    let cube: Vec<Vec3> = (0..1037).map(|_| random.cube()).collect();
    for cloud in [&[][..], &cube[..1], &cube[..3], &row, &equal, &cube] {
        let whole = estimate_planes(cloud, 12, PlaneFit::LeastSquares);
        let lazy = LazyPlanes::new(cloud, 12, None);
        // From the back, a third at a time.
        let third = cloud.len().div_ceil(3).max(1);
        for start in (0..cloud.len()).step_by(third).rev() {
            let points = start..cloud.len().min(start + third);
            let found = lazy.of(points.clone());
            assert!(found.normals == whole.normals[points.clone()]);
            let without = whole.without_plane.iter().copied();
            assert!(
                found
                    .without_plane
                    .into_iter()
                    .eq(without.filter(|&p| points.contains(&(p as usize))))
            );
        }
        assert_eq!(lazy.estimated_points(), cloud.len());
    }
}
