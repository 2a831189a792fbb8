//! Building the octree of one frame (the 4D media paper, Table III, column *build*).
//!
//! Measured: `Octree::build` from positions and colours in memory, on one and two threads, at δ = 2, 10 and 50 % and
//! with at most eight points per leaf, with everything it allocates; of points that are in Morton order already, as
//! those of frames are; `Octree::with_stop` when δ changes; the peak memory of a build; and next to it, in the same
//! run, a textbook radix sort of the same 63-bit Morton codes (eight passes of eight bits), alone and with the point
//! indices that a build needs.
//!
//! First, the bare sort, two of it at once, and a build at δ = 2 % on one and on two threads take turns, so that a
//! machine that slows down slows all of them: medians and their ratios, which hold where times do not. Two sorts at
//! once share no work and no memory, so they show the gain from a second core at all.
//!
//! Not measured: decoding the frame, making the codes (for the bare sorts), handing the memory back to the system.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use pointreel::levels::octree::{Octree, StopCriterion};
use pointreel::math::{Cube, order_of_codes};
use std::hint::black_box;
use std::time::Instant;

mod shapes;
#[path = "shapes/turns.rs"]
mod turns;

use shapes::{memory, threads};
use turns::{median, time_ms};

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
        take_turns(&positions, &colors, &codes);
        let mut group = criterion.benchmark_group(format!("octree/{count}"));
        group.throughput(Throughput::Elements(count as u64));
        group.sample_size(if count > 500_000 { 10 } else { 50 });
        for (threads, pool) in threads::pools([1, 2]) {
            let build = |stop| pool.install(|| Octree::build(black_box(&positions), black_box(&colors), stop));
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
                let id = BenchmarkId::new(format!("δ changed, {threads} threads"), format!("{from} to {to}"));
                group.bench_function(id, |bencher| {
                    bencher.iter(|| pool.install(|| tree.with_stop(StopCriterion::Loss(to))));
                });
            }
            let by_points = BenchmarkId::new(format!("build, {threads} threads"), "8 points");
            group.bench_function(by_points, |bencher| {
                bencher.iter(|| build(StopCriterion::PointsPerOctant(8)));
            });
            let by_spacing = BenchmarkId::new(format!("build, {threads} threads"), "spacing");
            group.bench_function(by_spacing, |bencher| {
                bencher.iter(|| build(StopCriterion::Spacing));
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

/// Rounds of each alternating case.
const ROUNDS: usize = 50;

#[expect(clippy::print_stdout, reason = "what is measured by turns")]
fn take_turns(positions: &[Vec3], colors: &[[u8; 4]], codes: &[u64]) {
    let pools: Vec<_> = threads::pools([1, 2]).map(|(_, pool)| pool).collect();
    let mut sorts = [(); 2].map(|()| (codes.to_vec(), codes.to_vec()));
    let mut times_ms = [const { Vec::new() }; 4];
    for _ in 0..ROUNDS {
        for (items, _) in &mut sorts {
            items.copy_from_slice(codes);
        }
        let sort = |(items, scratch): &mut (Vec<u64>, Vec<u64>)| {
            let begin = Instant::now();
            radix_sort(items, scratch, |&code| code);
            begin.elapsed().as_secs_f64() * 1e3
        };
        times_ms[0].push(sort(&mut sorts[0]));
        sorts[0].0.copy_from_slice(codes);
        let [first, second] = &mut sorts;
        let both_ms = pools[1].join(|| sort(first), || sort(second));
        times_ms[1].push(both_ms.0.max(both_ms.1));
        for (pool, times_ms) in pools.iter().zip(&mut times_ms[2..]) {
            let build = || Octree::build(positions, colors, StopCriterion::Loss(0.02));
            times_ms.push(pool.install(|| time_ms(build)));
        }
    }
    let [sort_ms, both_ms, one_ms, two_ms] = times_ms.map(median);
    println!(
        "{} points, by turns: bare radix sort {sort_ms:.2} ms; build on one thread {one_ms:.2} ms, {:.2} × the sort; \
         on two {two_ms:.2} ms, {:.2} × as fast, where two bare sorts at once are {:.2} × as fast as one after the \
         other",
        codes.len(),
        one_ms / sort_ms,
        one_ms / two_ms,
        2.0 * sort_ms / both_ms,
    );
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
