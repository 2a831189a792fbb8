//! Robust planes.

use crate::analysis::test_shapes::{self, Random};
use crate::analysis::tests::angles;
use crate::analysis::*;

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
fn robust_planes_ignore_outliers_and_edges() {
    let mut random = Random(18);
    let errors = |positions: &[Vec3], truth: &[Vec3], k| PlaneFit::ALL.map(|fit| mean_error(positions, truth, k, fit));
    let sphere = test_shapes::sphere(10_000, &mut random);
    let cube = test_shapes::cuboid(10_000, Vec3::ONE, &mut random);
    for k in [16, 32] {
        // Clean and smooth: hardly worse. Near edges: better.
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
fn robust_planes_are_defined_wherever_least_squares_planes_are() {
    let mut random = Random(19);
    let line: Vec<Vec3> = (0..50).map(|i| Vec3::new(1.0, 2.0, 0.5) * i as f32).collect();
    let lattice: Vec<Vec3> = (0..400)
        .map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0))
        .collect();
    let cube: Vec<Vec3> = (0..500).map(|_| random.cube()).collect();
    for cloud in [&[][..], &[Vec3::ONE], &[Vec3::ONE; 40], &line, &lattice, &cube] {
        let [plain, robust] = PlaneFit::ALL.map(|fit| estimate_planes(cloud, 12, fit));
        assert_eq!(plain.without_plane, robust.without_plane);
        assert!(robust.normals.iter().all(|normal| normal.is_normalized()));
    }
    let on_plane = estimate_planes(&lattice, 12, PlaneFit::Robust).normals;
    assert!(on_plane.iter().all(|normal| normal.abs().abs_diff_eq(Vec3::Z, 1e-6)));
}
