//! Completing a frame without normals: what `estimate_surface` does, and its first stage alone.
//!
//! Measured: 100,000 points in random order, k = 12, on one thread and on as many as there are cores, with everything
//! allocated. *surface* is all of it (tree, neighbours, normals, radii, orientation over the spanning tree), *surface to
//! sensor* without the spanning tree, *radii* what a file with normals needs, *neighbours* tree and neighbours with the
//! lists put into file order, *planes* normals alone. *lazy planes* and *lazy radii* are those of so many percent of the
//! points, consecutive ones in Morton order, with what they depend on: the tree over all points, and for radii the cells around
//! and the sample that limits them.
//!
//! Not measured: decoding, packing of records.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use pointreel::analysis::{
    DEFAULT_NEIGHBOURS, LazySurface, PlaneFit, estimate_planes, estimate_surface,
    nearest_neighbours, splat_ellipses, splat_radii,
};
use pointreel::math::{Cube, order_of_codes};

mod shapes;

use shapes::threads::bench_on_threads;

const POINTS: usize = 100_000;

fn normals(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let (positions, _) = shapes::bumpy_torus(POINTS);
    let known = estimate_surface(&positions, None).normals;
    let cube = Cube::around(&positions).expect("there are points");
    let order = order_of_codes(&cube.codes(&positions));
    let in_morton_order: Vec<Vec3> = order.iter().map(|&i| positions[i as usize]).collect();
    let planes = |fit| {
        estimate_planes(&in_morton_order, DEFAULT_NEIGHBOURS, fit)
            .normals
            .len()
    };
    let lazy = |percent: usize| {
        let lazy = LazySurface::new(&in_morton_order, DEFAULT_NEIGHBOURS, None);
        lazy.planes(0..POINTS / 100 * percent).normals.len()
    };
    let lazy_radii = |percent: usize| {
        let lazy = LazySurface::new(&in_morton_order, DEFAULT_NEIGHBOURS, None);
        lazy.radii(0..POINTS / 100 * percent).len()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut group = criterion.benchmark_group("analysis/100000");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.sample_size(20);
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 13] = [
        ("surface", &|| {
            estimate_surface(&positions, None).normals.len()
        }),
        ("surface to sensor", &|| {
            estimate_surface(&positions, Some(Vec3::splat(9.0)))
                .normals
                .len()
        }),
        ("radii", &|| splat_radii(&positions, &known).len()),
        ("ellipses", &|| splat_ellipses(&positions, &known).len()),
        ("planes", &|| planes(PlaneFit::LeastSquares)),
        ("planes, robust", &|| planes(PlaneFit::Robust)),
        ("lazy planes, 1 percent", &|| lazy(1)),
        ("lazy planes, 10 percent", &|| lazy(10)),
        ("lazy planes, 100 percent", &|| lazy(100)),
        ("lazy radii, 1 percent", &|| lazy_radii(1)),
        ("lazy radii, 10 percent", &|| lazy_radii(10)),
        ("lazy radii, 100 percent", &|| lazy_radii(100)),
        ("neighbours", &|| {
            nearest_neighbours(&positions, DEFAULT_NEIGHBOURS).per_point()
        }),
    ];
    bench_on_threads(&mut group, [1, cores], &functions);
    group.finish();
}

criterion_group!(benches, normals);
criterion_main!(benches);
