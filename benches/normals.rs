//! Completing a frame without normals: what `estimate_surface` does, and its first stage alone.
//!
//! Measured: 100,000 points in random order, k = 12, on one thread and on as many as there are cores, with everything
//! allocated. *surface* is all of it (tree, neighbours, normals, radii, orientation over the spanning tree), *surface to
//! sensor* without the spanning tree, *radii* what a file with normals needs, *neighbours* tree and neighbours with the
//! lists put into file order, *planes* normals alone. *lazy planes* are those of so many percent of the points, consecutive
//! ones in Morton order, the tree over all points included.
//!
//! Not measured: decoding, packing of records.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use pointreel::analysis::{
    DEFAULT_NEIGHBOURS, LazyPlanes, PlaneFit, estimate_planes, estimate_surface,
    nearest_neighbours, splat_ellipses, splat_radii,
};
use pointreel::math::{Cube, order_of_codes};

mod shapes;

const POINTS: usize = 100_000;

fn normals(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let (positions, _) = shapes::bumpy_torus(POINTS);
    let known = estimate_surface(&positions, None).normals;
    let cube = Cube::around(&positions).expect("there are points");
    let order = order_of_codes(cube.codes(&positions));
    let in_morton_order: Vec<Vec3> = order.iter().map(|&i| positions[i as usize]).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut group = criterion.benchmark_group("analysis/100000");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.sample_size(20);
    for threads in [1, cores] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads can be started");
        let mut bench = |name: &str, run: &(dyn Fn() -> usize + Sync)| {
            let id = BenchmarkId::new(name, format!("{threads} threads"));
            group.bench_function(id, |bencher| {
                pool.install(|| bencher.iter(run));
            });
        };
        bench("surface", &|| {
            estimate_surface(&positions, None).normals.len()
        });
        bench("surface to sensor", &|| {
            estimate_surface(&positions, Some(Vec3::splat(9.0)))
                .normals
                .len()
        });
        bench("radii", &|| splat_radii(&positions, &known).len());
        bench("ellipses", &|| splat_ellipses(&positions, &known).len());
        for fit in PlaneFit::ALL {
            bench(&format!("planes, {}", fit.name()), &|| {
                estimate_planes(&in_morton_order, DEFAULT_NEIGHBOURS, fit)
                    .normals
                    .len()
            });
        }
        for percent in [1, 10, 100] {
            bench(&format!("lazy planes, {percent} percent"), &|| {
                let lazy = LazyPlanes::new(&in_morton_order, DEFAULT_NEIGHBOURS, None);
                lazy.of(0..POINTS / 100 * percent).normals.len()
            });
        }
        bench("neighbours", &|| {
            nearest_neighbours(&positions, DEFAULT_NEIGHBOURS).per_point()
        });
    }
    group.finish();
}

criterion_group!(benches, normals);
criterion_main!(benches);
