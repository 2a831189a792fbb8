//! Building the octree of one frame (paper 000, Table III, column *build*).
//!
//! Measured: `Octree::build` from positions and colours in memory, on one and two threads, at δ = 2, 10 and 50 % and with at
//! most eight points a leaf, with everything it allocates; of points that are in Morton order already, as those of frames are; `Octree::with_stop` when δ changes; the most memory that a build
//! holds; and beside it, in the same run, a textbook radix sort of the same 63-bit Morton codes (eight passes of eight
//! bits), alone and with the point indices that a build needs. Times vary between machines; the ratio to the sort does not.
//!
//! Not measured: decoding the frame, making the codes (for the bare sorts), handing the memory back to the system.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pointreel::math::{Cube, order_of_codes};
use pointreel::octree::{Octree, StopCriterion};
use std::hint::black_box;

mod shapes;

use shapes::{memory, threads};

#[expect(clippy::print_stdout, reason = "criterion measures time alone")]
fn build(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    for count in [88_000, 1_000_000] {
        let (positions, colors) = shapes::bumpy_torus(count);
        let cube = Cube::around(&positions).expect("there are points");
        let codes = cube.codes(&positions);
        let in_order: (Vec<_>, Vec<_>) = order_of_codes(&codes)
            .into_iter()
            .map(|index| (positions[index as usize], colors[index as usize]))
            .unzip();
        let mut group = criterion.benchmark_group(format!("octree/{count}"));
        group.throughput(Throughput::Elements(count as u64));
        group.sample_size(if count > 500_000 { 10 } else { 50 });
        for (threads, pool) in threads::pools([1, 2]) {
            let build = |stop| {
                pool.install(|| Octree::build(black_box(&positions), black_box(&colors), stop))
            };
            for delta in [0.02, 0.1, 0.5] {
                let id = BenchmarkId::new(format!("build, {threads} threads"), delta);
                group.bench_function(id, |bencher| {
                    bencher.iter(|| build(StopCriterion::Loss(delta)));
                });
            }
            let id = BenchmarkId::new(format!("build in Morton order, {threads} threads"), 0.02);
            group.bench_function(id, |bencher| {
                let stop = StopCriterion::Loss(0.02);
                let (positions, colors) = &in_order;
                bencher.iter(|| pool.install(|| Octree::build(positions, colors, stop)));
            });
            for (from, to) in [(0.02, 0.1), (0.1, 0.02)] {
                let tree = build(StopCriterion::Loss(from));
                let id = BenchmarkId::new(
                    format!("δ changed, {threads} threads"),
                    format!("{from} to {to}"),
                );
                group.bench_function(id, |bencher| {
                    bencher.iter(|| pool.install(|| tree.with_stop(StopCriterion::Loss(to))));
                });
            }
            let by_points = BenchmarkId::new(format!("build, {threads} threads"), "8 points");
            group.bench_function(by_points, |bencher| {
                bencher.iter(|| build(StopCriterion::PointsPerOctant(8)));
            });
            let before = memory::peak_from_here();
            let tree = build(StopCriterion::Loss(0.02));
            let per_point = |bytes: usize| bytes as f64 / count as f64;
            println!(
                "{count} points, {threads} threads: {:.1} bytes a point at peak while building, {:.1} after",
                per_point(memory::peak() - before),
                per_point(tree.byte_size()),
            );
        }
        let pairs: Vec<(u64, u32)> = codes.iter().copied().zip(0..).collect();
        group.bench_function("bare radix sort, codes", |bencher| {
            bencher.iter_batched_ref(
                || (codes.clone(), codes.clone()),
                |(items, scratch)| radix_sort(items, scratch, |&code| code),
                BatchSize::LargeInput,
            );
        });
        group.bench_function("bare radix sort, codes and indices", |bencher| {
            bencher.iter_batched_ref(
                || (pairs.clone(), pairs.clone()),
                |(items, scratch)| radix_sort(items, scratch, |&(code, _)| code),
                BatchSize::LargeInput,
            );
        });
        group.finish();
    }
}

/// Eight stable passes over eight bits each; the result is in `items`.
fn radix_sort<T: Copy>(items: &mut [T], scratch: &mut [T], code: impl Fn(&T) -> u64) {
    let digit = |item: &T, pass: usize| (code(item) >> (8 * pass)) as usize & 0xff;
    let mut counts = [[0u32; 256]; 8];
    for item in &*items {
        for (pass, counts) in counts.iter_mut().enumerate() {
            counts[digit(item, pass)] += 1;
        }
    }
    let (mut from, mut to) = (items, scratch);
    for (pass, counts) in counts.iter_mut().enumerate() {
        let mut next = 0;
        for count in counts.iter_mut() {
            next += std::mem::replace(count, next);
        }
        for item in &*from {
            let place = &mut counts[digit(item, pass)];
            to[*place as usize] = *item;
            *place += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
}

criterion_group!(benches, build);
criterion_main!(benches);
