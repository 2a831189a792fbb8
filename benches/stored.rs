//! An octree written to memory and read back, beside building it.
//!
//! Measured: 88,000 points, δ = 2 %, on one thread and on two: `Octree::build` from positions and colours,
//! `Octree::write_to` and `StoredOctree::read_from`, without and with shapes (normals, radii and scalars that differ
//! from point to point), all with everything they allocate. Printed: bytes a point of the masks alone and of the whole,
//! for several stop criteria, and the most memory that reading holds, there and for bytes that ask for more than usual.
//!
//! Not measured: a disk.

use bytemuck::Zeroable;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use pointreel::cloud::{ShapeRecord, oct_encode};
use pointreel::levels::octree::{Octree, StopCriterion, StoredOctree};

mod shapes;

use shapes::{memory, threads};

const POINTS: usize = 88_000;

fn stored(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let (positions, colors) = shapes::bumpy_torus(POINTS);
    let shapes = shapes_of(&positions);
    let build = |stop| Octree::build(&positions, &colors, stop);
    for stop in [
        StopCriterion::Loss(0.02),
        StopCriterion::Loss(0.1),
        StopCriterion::Loss(0.5),
        StopCriterion::PointsPerOctant(8),
    ] {
        print_size(stop, &build(stop), &shapes);
    }
    print_dense();

    let tree = build(StopCriterion::Loss(0.02));
    let [bare, whole] = [None, Some(&*shapes)].map(|shapes| written(&tree, shapes));
    let read = |bytes| StoredOctree::read_from(bytes).expect("it was just written");
    let mut group = criterion.benchmark_group(format!("stored/{POINTS}"));
    group.throughput(Throughput::Elements(POINTS as u64));
    for (threads, pool) in threads::pools([1, 2]) {
        let mut bench = |name: &str, run: &(dyn Fn() -> usize + Sync)| {
            let id = BenchmarkId::new(name, format!("{threads} threads"));
            group.bench_function(id, |bencher| {
                pool.install(|| bencher.iter(run));
            });
        };
        bench("build", &|| build(StopCriterion::Loss(0.02)).leaf_count());
        bench("write", &|| written(&tree, None).len());
        bench("write with shapes", &|| written(&tree, Some(&shapes)).len());
        bench("read", &|| read(&bare).octree.leaf_count());
        bench("read with shapes", &|| read(&whole).octree.leaf_count());
    }
    group.finish();
}

/// Shapes that differ from point to point, save for the ellipse.
fn shapes_of(positions: &[Vec3]) -> Vec<ShapeRecord> {
    let shape = |position: &Vec3| ShapeRecord {
        normal: oct_encode(position.normalize()),
        radius: 0.01 * position.length(),
        ellipse: 0,
        scalar: position.z,
    };
    positions.iter().map(shape).collect()
}

/// The bytes that ask for the most memory beside their number: finest cells that all hold a point, so that nothing is
/// left to say of it, each a leaf of a tree of leaves on several levels, with one shape for all.
#[expect(clippy::print_stdout, reason = "criterion measures time alone")]
fn print_dense() {
    const EDGE: u32 = 64;
    let cell = 2f32.powi(-21);
    let mut positions: Vec<Vec3> = (0..EDGE.pow(3))
        .map(|index| [index % EDGE, index / EDGE % EDGE, index / EDGE / EDGE])
        .map(|cells| Vec3::from_array(cells.map(|along| along as f32 * cell)))
        .collect();
    positions.push(Vec3::ONE);
    let count = positions.len();
    let tree = Octree::build(&positions, &vec![[0; 4]; count], StopCriterion::PointsPerOctant(1));
    let bytes = written(&tree, Some(&vec![ShapeRecord::zeroed(); count]));
    let before = memory::peak_from_here();
    let read = StoredOctree::read_from(&bytes).expect("it was just written");
    let peak = memory::peak() - before;
    assert!(read.octree == tree, "what is read is what was written");
    println!(
        "{count} points in neighbouring finest cells: {:.2} bytes a point, {:.1} times as many at peak while reading",
        bytes.len() as f64 / count as f64,
        peak as f64 / bytes.len() as f64,
    );
}

fn written(tree: &Octree, shapes: Option<&[ShapeRecord]>) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.write_to(shapes, &mut bytes).expect("memory can be written");
    bytes
}

#[expect(clippy::print_stdout, reason = "criterion measures time alone")]
fn print_size(stop: StopCriterion, tree: &Octree, shapes: &[ShapeRecord]) {
    let per_point = |bytes: usize| bytes as f64 / POINTS as f64;
    let bare = written(tree, None);
    let before = memory::peak_from_here();
    let read = StoredOctree::read_from(&bare).expect("it was just written");
    let peak = memory::peak() - before;
    assert!(read.octree == *tree, "what is read is what was written");
    println!(
        "{stop:?}: {:.2} bytes a point of masks, {:.2} in all, {:.2} with shapes; {:.1} in memory, {:.1} at peak while \
         reading",
        per_point(tree.masks().len()),
        per_point(bare.len()),
        per_point(written(tree, Some(shapes)).len()),
        per_point(tree.byte_size()),
        per_point(peak),
    );
}

criterion_group!(benches, stored);
criterion_main!(benches);
