//! Completing a frame without normals: `estimate_surface`, and its first stage alone.
//!
//! Measured: 100,000 points in random order, k = 12, on one thread and on one per core, with everything
//! allocated. *surface* is all of it (tree, neighbours, normals, radii, orientation over the spanning tree), *surface
//! to sensor* without the spanning tree, *radii* the work for a file with normals, *neighbours* tree and neighbours
//! with the lists put into file order, *planes* normals alone.
//!
//! *noisy surface* is the same of points with noise of half their spacing, next to the time for twelve neighbours.
//!
//! *large* is 4,000,000 points, whose signs are those of representatives: *surface*, *surface to sensor*, and next to
//! them the neighbours alone, as sorted lists, and a plain read of the positions.
//!
//! Not measured: decoding, packing of records.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use pointreel::analysis::{
    DEFAULT_NEIGHBOURS, PlaneFit, SurfaceOptions, estimate_planes, estimate_surface, estimate_surface_observed,
    nearest_neighbours, splat_ellipses, splat_radii,
};
use pointreel::math::{Cube, order_of_codes};
use pointreel::progress::Progress;

mod shapes;

use rayon::prelude::*;
use shapes::threads::bench_on_threads;
use std::hint::black_box;

const POINTS: usize = 100_000;

/// More than are joined over all of their neighbourhood graph.
const LARGE: usize = 4_000_000;

fn normals(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let (positions, _) = shapes::bumpy_torus(POINTS);
    let known = estimate_surface(&positions, None).normals;
    let cube = Cube::around(&positions).expect("there are points");
    let order = order_of_codes(&cube.codes(&positions));
    let in_morton_order: Vec<Vec3> = order.iter().map(|&i| positions[i as usize]).collect();
    let planes = |fit| estimate_planes(&in_morton_order, DEFAULT_NEIGHBOURS, fit).normals.len();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut group = criterion.benchmark_group("analysis/100000");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.sample_size(20);
    let noisy = noisy(&positions);
    let on_noisy = |options, sensor| {
        let never = Progress::default();
        let surface = estimate_surface_observed(&noisy, sensor, options, &never);
        assert_eq!(
            surface.basis.is_widened,
            options == SurfaceOptions::AUTO,
            "noise decides"
        );
        surface.normals.len()
    };
    let sensor = Some(Vec3::splat(9.0));
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 11] = [
        ("noisy surface", &|| on_noisy(SurfaceOptions::AUTO, None)),
        ("noisy surface, k = 12", &|| on_noisy(TWELVE, None)),
        ("noisy surface to sensor", &|| on_noisy(SurfaceOptions::AUTO, sensor)),
        ("noisy surface to sensor, k = 12", &|| on_noisy(TWELVE, sensor)),
        ("surface", &|| surface(&positions, None)),
        ("surface to sensor", &|| surface(&positions, Some(Vec3::splat(9.0)))),
        ("radii", &|| splat_radii(&positions, &known).len()),
        ("ellipses", &|| splat_ellipses(&positions, &known).len()),
        ("planes", &|| planes(PlaneFit::Plain)),
        ("planes, robust", &|| planes(PlaneFit::Robust)),
        ("neighbours", &|| {
            nearest_neighbours(&positions, DEFAULT_NEIGHBOURS).per_point()
        }),
    ];
    bench_on_threads(&mut group, [1, cores], &functions);
    group.finish();
}

/// Normals of noisy clouds without widened neighbourhoods.
const TWELVE: SurfaceOptions = SurfaceOptions {
    neighbours: Some(DEFAULT_NEIGHBOURS as u16),
    ..SurfaceOptions::AUTO
};

/// The points of the torus, moved by about half their spacing: sums of four uniform numbers along each axis.
fn noisy(positions: &[Vec3]) -> Vec<Vec3> {
    let spacing = (16.0 / POINTS as f32).sqrt();
    let mut state = 1u32;
    let mut uniform = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    // Four uniform numbers have a standard deviation of 0.58.
    let mut deviate = || (uniform() + uniform() + uniform() + uniform()) * (0.5 / 0.577);
    let mut moved = |&position: &Vec3| position + spacing * Vec3::new(deviate(), deviate(), deviate());
    positions.iter().map(&mut moved).collect()
}

fn surface(positions: &[Vec3], sensor: Option<Vec3>) -> usize {
    estimate_surface(positions, sensor).normals.len()
}

fn large(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let (positions, _) = shapes::bumpy_torus(LARGE);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut group = criterion.benchmark_group("analysis/4000000");
    group.throughput(Throughput::Elements(LARGE as u64));
    group.sample_size(10);
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 4] = [
        ("surface", &|| surface(&positions, None)),
        ("surface to sensor", &|| surface(&positions, Some(Vec3::splat(9.0)))),
        ("neighbours", &|| {
            nearest_neighbours(&positions, DEFAULT_NEIGHBOURS).per_point()
        }),
        ("plain read", &|| {
            let sum: Vec3 = positions.par_iter().copied().sum();
            usize::from(black_box(sum).is_finite())
        }),
    ];
    bench_on_threads(&mut group, [1, cores], &functions);
    group.finish();
}

criterion_group!(benches, normals, large);
criterion_main!(benches);
