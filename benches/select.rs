//! Traversing the octree of one frame into its visible set (the 4D media paper, Table III, column *traverse*).
//!
//! Measured: `Octree::select` on one and two threads into a `Vec` that has its memory, for a tree seen whole, filling
//! the image, and from within, at LOD thresholds of 0 (all leaves), 1 and 4 pixels at 1280 pixels of height; 88,000
//! points at δ = 2 % and 1,000,000 at δ = 2 %. The throughput is visited nodes: tested ones and those emitted with a
//! whole subtree. A view is selected repeatedly, as by a camera in front of one frame, so that voxels of coarse levels
//! are cached; one row has a tree of its own each time.
//!
//! Also, on all cores: `Octree::cut` alone, with the cut of the previous view, and with back-face culling; writing the
//! surfels of a cut, and computing those of a level, which is done once per frame.
//!
//! Not measured: the build, the upload, drawing.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Mat4, Vec3, Vec4};
use pointreel::cloud::{PointRecord, ShapeRecord, oct_encode};
use pointreel::levels::octree::{LodSurfels, Octree, StopCriterion};
use pointreel::levels::{CutHints, Levels, LodMetric, SelectView};
use pointreel::math::{Cube, Frustum, order_of_codes};
use std::sync::Arc;

mod shapes;

use shapes::threads::pools;

fn select(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    for count in [88_000, 1_000_000] {
        let (positions, colors) = shapes::bumpy_torus(count);
        let tree = Octree::build(&positions, &colors, StopCriterion::Loss(0.02));
        let mut group = criterion.benchmark_group(format!("select/{count}"));
        for (threads, pool) in pools([1, 2]) {
            for (place, distance) in [("whole", 4.0), ("filling", 2.0), ("within", 0.6)] {
                for lod_px in [0.0, 1.0, 4.0] {
                    let view = view_from(Vec3::new(0.3, 0.5, 0.81) * distance, lod_px);
                    let mut out = Vec::new();
                    let stats = tree.select(&view, &mut out);
                    group.throughput(Throughput::Elements(stats.visited_nodes as u64));
                    let name = format!("{place}, {threads} threads");
                    let drawn = format!("{lod_px}px, {} of {}", stats.emitted, tree.leaf_count());
                    group.bench_function(BenchmarkId::new(name, drawn), |bencher| {
                        pool.install(|| bencher.iter(|| tree.select(&view, &mut out)));
                    });
                }
            }
        }
        let view = view_from(Vec3::new(0.3, 0.5, 0.81) * 4.0, 4.0);
        let mut out = Vec::new();
        let stats = tree.select(&view, &mut out);
        group.throughput(Throughput::Elements(stats.visited_nodes as u64));
        group.bench_function("whole, 4px, a frame that is seen once", |bencher| {
            let fresh = || Octree::build(&positions, &colors, StopCriterion::Loss(0.02));
            let mut select = |tree: Octree| tree.select(&view, &mut out);
            bencher.iter_batched(fresh, &mut select, BatchSize::PerIteration);
        });
        group.finish();
    }
}

/// A camera that has moved by a hundredth, with and without the cut of the previous view; and surfels of cells instead
/// of voxels, with and without back faces.
fn cut(criterion: &mut Criterion) {
    const POINTS: usize = 1_000_000;
    let surfels = lod_surfels(POINTS);
    let tree = surfels.octree();
    let mut group = criterion.benchmark_group(format!("cut/{POINTS}"));
    for lod_px in [1.0, 4.0] {
        let at = |distance| view_from(Vec3::new(0.3, 0.5, 0.81) * distance, lod_px);
        let before = tree.cut(&at(2.0), CutHints::default());
        let view = at(2.02);
        let remembering = CutHints {
            before: Some(&before),
            culls_back_faces: false,
        };
        let facing = CutHints {
            before: None,
            culls_back_faces: true,
        };
        let ways: [(_, &dyn Levels, _); 3] = [
            ("voxels", &**tree, CutHints::default()),
            ("voxels, remembering", &**tree, remembering),
            ("facing the eye", &surfels, facing),
        ];
        for (name, levels, hints) in ways {
            let cut = levels.cut(&view, hints);
            let id = BenchmarkId::new(name, format!("{lod_px}px, {}", cut.node_count()));
            group.bench_function(id, |bencher| bencher.iter(|| levels.cut(&view, hints)));
            let (mut points, mut shapes) = (Vec::new(), Vec::new());
            surfels.write_surfels(&cut, &mut points, &mut shapes);
            let id = BenchmarkId::new(format!("writing surfels, {name}"), format!("{lod_px}px"));
            group.bench_function(id, |bencher| {
                bencher.iter(|| surfels.write_surfels(&cut, &mut points, &mut shapes));
            });
        }
    }
    group.bench_function("surfels of a level, worked out", |bencher| {
        let level = tree.depth() - 2;
        bencher.iter_batched(
            || surfels.fresh(),
            |surfels| surfels.level(level).len(),
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

/// The surfels of a torus of this many points.
fn lod_surfels(count: usize) -> LodSurfels {
    let (positions, colors) = shapes::bumpy_torus(count);
    let normals = shapes::bumpy_torus_normals(count);
    let cube = Cube::around(&positions).expect("there are points");
    let order = order_of_codes(&cube.codes(&positions));
    let at = order.iter().map(|&index| index as usize);
    let sorted: Vec<Vec3> = at.clone().map(|index| positions[index]).collect();
    let sorted_colors: Vec<[u8; 4]> = at.clone().map(|index| colors[index]).collect();
    let points = at.clone().map(|index| PointRecord {
        position: positions[index].to_array(),
        color: colors[index],
    });
    let shapes = at.clone().map(|index| ShapeRecord {
        normal: oct_encode(normals[index]),
        radius: 0.003,
        ellipse: 0,
        scalar: 0.0,
    });
    let tree = Octree::build(&sorted, &sorted_colors, StopCriterion::Loss(0.02));
    LodSurfels::new(Arc::new(tree), Arc::new(points.collect()), Arc::new(shapes.collect()))
}

/// Looking at the origin over 1920×1280 pixels.
fn view_from(eye: Vec3, lod_px: f32) -> SelectView {
    let focal = 2.0;
    let forward = -eye.normalize();
    let right = forward.any_orthonormal_vector();
    let space_from_view = Mat4::from_cols(
        right.extend(0.0),
        right.cross(forward).extend(0.0),
        (-forward).extend(0.0),
        eye.extend(1.0),
    );
    let clip_from_view = Mat4::from_cols(
        Vec4::new(focal / 1.5, 0.0, 0.0, 0.0),
        Vec4::new(0.0, focal, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, 0.01, 0.0),
    );
    SelectView {
        frustum: Frustum::from_clip_matrix(&(clip_from_view * space_from_view.inverse())),
        eye,
        pixels_per_unit_at_1: focal * 640.0,
        lod_px,
        metric: LodMetric::default(),
        deepest_level: SelectView::ALL_LEVELS,
    }
}

criterion_group!(benches, select, cut);
criterion_main!(benches);
