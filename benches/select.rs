//! Traversing the octree of one frame into its visible set (paper 000, Table III, column *traverse*).
//!
//! Measured: `Octree::select` on all cores into a `Vec` that has its memory, for a tree seen whole, filling the image, and
//! from within, at LOD thresholds of 0 (all leaves), 1 and 4 pixels at 1280 pixels of height; 88,000 points at δ = 2 % and
//! 1,000,000 at δ = 2 %. The throughput is visited nodes: tested ones and those emitted with a whole subtree.
//!
//! Not measured: the build, the upload, drawing.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Mat4, Vec3, Vec4};
use pointreel::{
    math::Frustum,
    octree::{Octree, SelectView, StopCriterion},
};

mod shapes;

fn select(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    for count in [88_000, 1_000_000] {
        let (positions, colors) = shapes::bumpy_torus(count);
        let tree = Octree::build(&positions, &colors, StopCriterion::Loss(0.02));
        let mut group = criterion.benchmark_group(format!("select/{count}"));
        for (place, distance) in [("whole", 4.0), ("filling", 2.0), ("within", 0.6)] {
            for lod_px in [0.0, 1.0, 4.0] {
                let view = view_from(Vec3::new(0.3, 0.5, 0.81) * distance, lod_px);
                let mut out = Vec::new();
                let stats = tree.select(&view, &mut out);
                group.throughput(Throughput::Elements(stats.visited_nodes as u64));
                group.bench_function(
                    BenchmarkId::new(
                        place,
                        format!("{lod_px}px, {} of {}", stats.emitted, tree.leaf_count()),
                    ),
                    |bencher| bencher.iter(|| tree.select(&view, &mut out)),
                );
            }
        }
        group.finish();
    }
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
        deepest_level: SelectView::ALL_LEVELS,
    }
}

criterion_group!(benches, select);
criterion_main!(benches);
