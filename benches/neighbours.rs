//! The neighbours and normals of a large cloud, compared with the k-d tree of the crate kiddo.
//!
//! Measured: 1,000,000 points in random order, k = 16, on one thread and on two, from positions to the answer, with
//! everything allocated. *neighbours* are lists in the order of the file, nearest first; *planes* the normals of
//! [`estimate_planes`], which needs no such order; *tree* the tree alone (no neighbours asked for). *kiddo* builds its
//! tree (on all threads) and asks it for the exact neighbours of all points into lists of the same form; *kiddo, Morton
//! order* does so for points that were sorted along a Morton curve before, which is the order it likes best, the sort
//! included.
//!
//! Before that, the mean angle between estimated and true normals is printed, of ours and of principal components of
//! kiddo's neighbours: the same neighbours make the same normals.
//!
//! Not measured: kiddo's `simd` feature, which needs a nightly compiler.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use pointreel::analysis::{PlaneFit, estimate_planes, nearest_neighbours};
use pointreel::math::{Cube, SymmetricMat3, order_of_codes};
use pointreel::measure::{AngularError, Orientation};
use rayon::prelude::*;
use std::num::NonZero;

mod shapes;

use shapes::threads::bench_on_threads;

const POINTS: usize = 1_000_000;

const NEIGHBOURS: usize = 16;

fn neighbours(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let (positions, _) = shapes::bumpy_torus(POINTS);
    compare_normals(&positions);
    let mut group = criterion.benchmark_group("neighbours/1000000");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.sample_size(10);
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 5] = [
        ("tree", &|| nearest_neighbours(&positions, 0).per_point()),
        ("neighbours", &|| nearest_neighbours(&positions, NEIGHBOURS).per_point()),
        ("planes", &|| {
            estimate_planes(&positions, NEIGHBOURS, PlaneFit::Plain).normals.len()
        }),
        ("kiddo", &|| by_kiddo(&positions).len()),
        ("kiddo, Morton order", &|| by_kiddo(&in_morton_order(&positions)).len()),
    ];
    bench_on_threads(&mut group, [1, 2], &functions);
    group.finish();
}

/// The neighbours of all points, nearest first, one list after the other.
fn by_kiddo(positions: &[Vec3]) -> Vec<u32> {
    let points: &[[f32; 3]] = bytemuck::cast_slice(positions);
    let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice_parallel(points).expect("positions are finite");
    // A point is its own nearest neighbour, or one of several at distance 0.
    let with_self = NonZero::new(NEIGHBOURS + 1).expect("it is not 0");
    let mut lists = vec![0; NEIGHBOURS * points.len()];
    lists
        .par_chunks_mut(NEIGHBOURS)
        .zip(points)
        .enumerate()
        .with_min_len(1 << 9)
        .for_each(|(index, (list, point))| {
            let found = tree
                .query(point)
                .nearest_n::<SquaredEuclidean<f32>>(with_self)
                .execute();
            let others = found.iter().filter(|found| found.item != index as u32);
            for (place, found) in list.iter_mut().zip(others) {
                *place = found.item;
            }
        });
    lists
}

/// The points sorted along a Morton curve.
fn in_morton_order(positions: &[Vec3]) -> Vec<Vec3> {
    let cube = Cube::around(positions).expect("there are points");
    let order = order_of_codes(&cube.codes(positions));
    order.par_iter().map(|&index| positions[index as usize]).collect()
}

/// Prints the errors of both kinds of normals.
#[expect(clippy::print_stdout, reason = "part of the result")]
fn compare_normals(positions: &[Vec3]) {
    let truth = shapes::bumpy_torus_normals(POINTS);
    let ours = estimate_planes(positions, NEIGHBOURS, PlaneFit::Plain).normals;
    let lists = by_kiddo(positions);
    let theirs: Vec<Vec3> = lists
        .par_chunks(NEIGHBOURS)
        .enumerate()
        .map(|(index, list)| principal_normal(positions, index, list))
        .collect();
    println!(
        "mean angle to the true normals, {NEIGHBOURS} neighbours of {POINTS} points: {:.4} degrees, of kiddo's \
         neighbours {:.4}",
        mean_degrees(&ours, &truth),
        mean_degrees(&theirs, &truth),
    );
}

/// The direction of least spread, straight from the definition.
fn principal_normal(positions: &[Vec3], index: usize, list: &[u32]) -> Vec3 {
    let places = || {
        let others = list.iter().map(|&other| positions[other as usize]);
        others.chain([positions[index]]).map(Vec3::as_dvec3)
    };
    let mean = places().sum::<DVec3>() / (list.len() + 1) as f64;
    let covariance = places().fold(SymmetricMat3::default(), |sum, place| {
        let d = place - mean;
        SymmetricMat3 {
            xx: sum.xx + d.x * d.x,
            xy: sum.xy + d.x * d.y,
            xz: sum.xz + d.x * d.z,
            yy: sum.yy + d.y * d.y,
            yz: sum.yz + d.y * d.z,
            zz: sum.zz + d.z * d.z,
        }
    });
    covariance.eigen().vectors[0].as_vec3()
}

/// Regardless of the normals' signs.
fn mean_degrees(found: &[Vec3], truth: &[Vec3]) -> f64 {
    AngularError::of(found, truth, Orientation::Ignored)
        .expect("there are normals")
        .mean_deg
}

criterion_group!(benches, neighbours);
criterion_main!(benches);
