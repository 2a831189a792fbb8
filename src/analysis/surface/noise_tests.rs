//! Noisy shapes with known normals: the estimated noise, and the results of widened neighbourhoods and smoothing.

use crate::analysis::test_shapes::{Random, Sampled, cuboid, sphere, torus};
use crate::analysis::{
    DEFAULT_NEIGHBOURS, PlaneFit, SurfaceOptions, WIDENED_NEIGHBOURS, estimate_planes, estimate_planes_with,
    estimate_surface, estimate_surface_observed, smooth,
};
use crate::progress::Progress;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// A normal deviate along each axis.
fn deviates(random: &mut Random) -> Vec3 {
    let mut deviate = || (-2.0 * random.unit().max(1e-9).ln()).sqrt() * (TAU * random.unit()).cos();
    Vec3::new(deviate(), deviate(), deviate())
}

/// Moves the points by Gaussian noise with this standard deviation along each axis.
fn with_noise(mut shape: Sampled, deviation: f32, random: &mut Random) -> Sampled {
    for position in &mut shape.positions {
        *position += deviation * deviates(random);
    }
    shape
}

fn spacing(area: f32, count: usize) -> f32 {
    (area / count as f32).sqrt()
}

/// Angles in degrees between normals of any sign, of the points that are `chosen`; ascending.
fn angles(found: &[Vec3], shape: &Sampled, chosen: &[bool]) -> Vec<f32> {
    let pairs = found
        .iter()
        .zip(&shape.normals)
        .zip(chosen)
        .filter(|(_, chosen)| **chosen);
    let mut angles: Vec<f32> = pairs
        .map(|((found, truth), _)| found.dot(*truth).abs().min(1.0).acos().to_degrees())
        .collect();
    angles.sort_by(f32::total_cmp);
    angles
}

fn median(found: &[Vec3], shape: &Sampled) -> f32 {
    let angles = angles(found, shape, &vec![true; found.len()]);
    angles[angles.len() / 2]
}

/// A torus has curvature, which is not noise; a coarse one has more of it in each neighbourhood.
#[test]
fn the_noise_is_found_whatever_the_curvature() {
    let mut random = Random(31);
    let area = 4.0 * PI * PI * 0.4;
    for (count, tolerance) in [(800, 0.25), (8000, 0.12)] {
        let exact = torus(count, 0.4, &mut random);
        let found = estimate_planes_with(&exact.positions, SurfaceOptions::AUTO).basis;
        assert!(found.noise < 0.03 && !found.is_widened, "{found:?}");
        for noise in [0.1, 0.3, 0.5, 0.7] {
            let shape = with_noise(exact.clone(), noise * spacing(area, count), &mut random);
            let found = estimate_planes_with(&shape.positions, SurfaceOptions::AUTO).basis.noise;
            assert!(
                (found / noise - 1.0).abs() < tolerance,
                "{found}, {noise} spacings of {count}"
            );
        }
    }
}

/// At 0.5 spacings of noise 5 degrees are required; twelve neighbours are off by more than twice that.
#[test]
fn normals_of_noisy_shapes_are_those_of_the_shape() {
    let mut random = Random(32);
    let count = 12_000;
    for (shape, area) in [
        (sphere(count, &mut random), 4.0 * PI),
        (torus(count, 0.4, &mut random), 4.0 * PI * PI * 0.4),
        (cuboid(count, Vec3::ONE, &mut random), 24.0),
    ] {
        let shape = with_noise(shape, 0.5 * spacing(area, count), &mut random);
        let twelve = estimate_planes(&shape.positions, DEFAULT_NEIGHBOURS, PlaneFit::Plain);
        let widened = estimate_planes_with(&shape.positions, SurfaceOptions::AUTO);
        assert_eq!(
            (widened.basis.is_widened, widened.basis.reach()),
            (true, WIDENED_NEIGHBOURS)
        );
        let (before, after) = (median(&twelve.normals, &shape), median(&widened.normals, &shape));
        assert!(after < 5.0 && before > 10.0, "{before} before, {after} degrees after");
        assert!(widened.normals.iter().all(|normal| normal.is_normalized()));
    }
}

/// Within two spacings of an edge, where half of a wide neighbourhood is on another face.
#[test]
fn edges_stay_as_sharp_as_without_widening() {
    let mut random = Random(33);
    let count = 12_000;
    let width = 2.0 * spacing(24.0, count);
    let exact = cuboid(count, Vec3::ONE, &mut random);
    let points = exact.positions.iter().zip(&exact.normals);
    let at_edge: Vec<bool> = points
        .map(|(position, normal)| (0..3).any(|axis| normal[axis] == 0.0 && 1.0 - position[axis].abs() < width))
        .collect();
    for noise in [0.2, 0.3, 0.5, 0.7] {
        let shape = with_noise(exact.clone(), noise * spacing(24.0, count), &mut random);
        let mean_of = |normals: &[Vec3]| {
            let angles = angles(normals, &shape, &at_edge);
            angles.iter().sum::<f32>() / angles.len() as f32
        };
        let twelve = estimate_planes(&shape.positions, DEFAULT_NEIGHBOURS, PlaneFit::Plain);
        let widened = estimate_planes_with(&shape.positions, SurfaceOptions::AUTO);
        assert!(widened.basis.is_widened);
        let (before, after) = (mean_of(&twelve.normals), mean_of(&widened.normals));
        assert!(
            after < before - 2.0,
            "{before} before, {after} degrees after, noise {noise}"
        );
    }
}

#[test]
fn clouds_without_noise_keep_the_normals_of_twelve_neighbours() {
    let mut random = Random(34);
    let twelve = SurfaceOptions {
        neighbours: Some(DEFAULT_NEIGHBOURS as u16),
        ..SurfaceOptions::AUTO
    };
    let slight = with_noise(sphere(3000, &mut random), 0.1 * spacing(4.0 * PI, 3000), &mut random);
    for shape in [
        slight,
        torus(3000, 0.4, &mut random),
        cuboid(3000, Vec3::ONE, &mut random),
    ] {
        for sensor in [None, Some(Vec3::Z * 9.0)] {
            let asked = estimate_surface_observed(&shape.positions, sensor, twelve, &Progress::default());
            let automatic = estimate_surface(&shape.positions, sensor);
            assert!(asked.normals == automatic.normals && asked.radii == automatic.radii);
        }
    }
}

/// Whole or by blocks, with the default or another number of neighbours: normals come from planes, and radii close the
/// surface.
#[test]
fn options_hold_with_and_without_a_sensor() {
    let mut random = Random(35);
    let exact = sphere(17_000, &mut random);
    let noisy = with_noise(exact.clone(), 0.5 * spacing(4.0 * PI, 17_000), &mut random);
    for shape in [exact, noisy] {
        for neighbours in [None, Some(5), Some(30)] {
            for fit in PlaneFit::ALL {
                let options = SurfaceOptions { neighbours, fit };
                let planes = estimate_planes_with(&shape.positions, options).normals;
                for sensor in [None, Some(Vec3::X * 7.0)] {
                    let surface = estimate_surface_observed(&shape.positions, sensor, options, &Progress::default());
                    let pairs = surface.normals.iter().zip(&planes);
                    assert!(pairs.into_iter().all(|(a, b)| *a == *b || *a == -*b), "{options:?}");
                    let mut radii = surface.radii;
                    radii.sort_by(f32::total_cmp);
                    let median = radii[radii.len() / 2] / spacing(4.0 * PI, 17_000);
                    assert!(
                        (0.9..1.4).contains(&median),
                        "a median radius of {median} spacings, {options:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn noisy_surfaces_are_the_same_on_any_number_of_threads() {
    let mut random = Random(36);
    let shape = with_noise(torus(20_000, 0.4, &mut random), 0.02, &mut random);
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| {
            let surface = estimate_surface(&shape.positions, None);
            assert!(surface.basis.is_widened);
            (surface, smooth(&shape.positions, 3.0, &Progress::default()))
        })
    };
    assert!(with_threads(1) == with_threads(3));
}

/// Points that coincide, lie in rows or are few have no noise, and are handled by both as any others.
#[test]
fn degenerate_clouds_are_defined() {
    let mut random = Random(37);
    let volume: Vec<Vec3> = (0..2000).map(|_| random.cube()).collect();
    let with_row = |scale: f32| {
        let row = (0..300).map(|at| Vec3::new(at as f32, 0.0, 0.0));
        volume.iter().copied().chain(row).map(move |position| position * scale)
    };
    let clouds = [
        Vec::new(),
        vec![Vec3::ONE],
        vec![Vec3::ONE; 600],
        (0..600).map(|at| Vec3::X * at as f32).collect(),
        volume.clone(),
        with_row(1.0).collect(),
        with_row(1e30).collect(),
        with_row(1e-30).collect(),
        volume.iter().copied().chain([Vec3::splat(1e20)]).collect(),
    ];
    for cloud in clouds {
        let surface = estimate_surface(&cloud, None);
        assert!(surface.normals.iter().all(|normal| normal.is_normalized()));
        assert!(surface.radii.iter().all(|radius| radius.is_finite() && *radius > 0.0));
        let smoothed = smooth(&cloud, 3.0, &Progress::default());
        assert!(smoothed.positions.iter().all(|position| position.is_finite()));
        assert_eq!(smoothed.positions.len(), cloud.len());
    }
    let row: Vec<Vec3> = (0..600).map(|at| Vec3::new(1.0, 2.0, 0.5) * at as f32).collect();
    assert_eq!(smooth(&row, 3.0, &Progress::default()).positions, row);
}

/// The residual noise of smoothed points is less than half of theirs, and points on a quadric stay.
#[test]
fn smoothing_moves_points_onto_the_surface() {
    let mut random = Random(38);
    let count = 8000;
    let spacing = spacing(4.0 * PI, count);
    let exact = sphere(count, &mut random);
    let off = |positions: &[Vec3]| {
        let mut off: Vec<f32> = positions
            .iter()
            .map(|position| (position.length() - 1.0).abs())
            .collect();
        off.sort_by(f32::total_cmp);
        off[count / 2] / spacing
    };
    let still = smooth(&exact.positions, 3.0, &Progress::default());
    assert!(still.max_distance < 0.01 * spacing, "{}", still.max_distance / spacing);
    for noise in [0.1, 0.3, 0.7] {
        let noisy = with_noise(exact.clone(), noise * spacing, &mut random);
        let smoothed = smooth(&noisy.positions, 3.0, &Progress::default());
        let (before, after) = (off(&noisy.positions), off(&smoothed.positions));
        assert!(after < 0.5 * before, "{before} spacings before, {after} after");
        let distances = noisy.positions.iter().zip(&smoothed.positions);
        let max_distance = distances.map(|(from, to)| from.distance(*to)).fold(0.0, f32::max);
        assert_eq!(smoothed.max_distance, max_distance);
        assert!((0.3 * noise..noise).contains(&(smoothed.median_distance / spacing)));
    }
}

#[test]
fn saddles_stay_and_a_cancelled_smoothing_ends() {
    let mut random = Random(39);
    let saddle: Vec<Vec3> = (0..3000)
        .map(|_| {
            let [x, y] = [random.unit() * 2.0 - 1.0, random.unit() * 2.0 - 1.0];
            Vec3::new(x, y, 0.3 * (x * x - y * y))
        })
        .collect();
    let progress = Progress::default();
    let smoothed = smooth(&saddle, 3.0, &progress);
    assert!(smoothed.max_distance < 2e-3, "{}", smoothed.max_distance);
    assert_eq!(progress.done(), saddle.len());
    let cancelled = Progress::default();
    cancelled.cancel();
    assert_eq!(smooth(&saddle, 3.0, &cancelled).positions, saddle);
}
