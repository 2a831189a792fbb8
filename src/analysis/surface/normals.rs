//! Normal estimation by principal component analysis of the neighbours.
//!
//! How it works: the normal is the direction in which a point and its neighbours spread least, the eigenvector of the
//! smallest eigenvalue of their covariance (Hoppe et al. 1992). Offsets are taken from the point itself, which is exact
//! in f32 for near neighbours wherever the cloud lies, and added up in f64. Their mean is no larger than they are, so
//! subtracting its square loses nothing that f32 coordinates had. Four points are summed up and solved side by side
//! ([`super::four_matrices`]).
//!
//! A plane is defined where the points spread in a second direction by more than the rounding of their coordinates can
//! make of a line or of a single place. Where it is not, the normal is perpendicular to the points there are, and the
//! point is reported.
//!
//! The sign is arbitrary here; [`super::orientation`] decides it.

use super::four_matrices::{FOUR, FourMatrices, widened};
use super::wide_planes::Neighbourhood;
use crate::analysis::search::lanes::axes_of_four;
use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{PointTree, SlotPoint};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x4, f64x4};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// The planes around consecutive points.
#[derive(Debug)]
pub(in crate::analysis) struct SlotPlanes {
    /// Unit normals in the order of the slots.
    pub(in crate::analysis) normals: Vec<Vec3>,
    /// Slots of the points whose neighbours define no plane, ascending.
    pub(in crate::analysis) without_plane: Vec<u32>,
}

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 9;

/// Fits planes to consecutive points and their neighbours.
pub(in crate::analysis) fn fit_planes(tree: &PointTree, neighbours: &Neighbours, slots: Range<usize>) -> SlotPlanes {
    let level = Level::new();
    let mut normals = vec![Vec3::Z; slots.len()];
    let without_plane: Vec<Vec<u32>> = normals
        .par_chunks_mut(POINTS_PER_TASK)
        .enumerate()
        .map(|(task, normals)| {
            let mut without_plane = Vec::new();
            let first_slot = slots.start + POINTS_PER_TASK * task;
            dispatch!(level, simd => {
                fit_all(simd, tree.points(), neighbours, first_slot, normals, &mut without_plane);
            });
            without_plane
        })
        .collect();
    SlotPlanes {
        normals,
        without_plane: without_plane.concat(),
    }
}

/// [`fit_planes`] of all points, and the neighbourhoods the planes were fitted to.
pub(in crate::analysis) fn fit_neighbourhoods(
    tree: &PointTree,
    neighbours: &Neighbours,
) -> (SlotPlanes, Vec<Neighbourhood>) {
    let level = Level::new();
    let mut normals = vec![Vec3::Z; tree.len()];
    let mut neighbourhoods = vec![Neighbourhood::default(); tree.len()];
    let without_plane: Vec<Vec<u32>> = normals
        .par_chunks_mut(POINTS_PER_TASK)
        .zip(neighbourhoods.par_chunks_mut(POINTS_PER_TASK))
        .enumerate()
        .map(|(task, (normals, neighbourhoods))| {
            let mut without_plane = Vec::new();
            dispatch!(level, simd => {
                let first_slot = POINTS_PER_TASK * task;
                let slots = (first_slot..).step_by(FOUR);
                let fours = normals.chunks_mut(FOUR).zip(neighbourhoods.chunks_mut(FOUR));
                for ((normals, neighbourhoods), slot) in fours.zip(slots) {
                    let sums = sum_four(simd, tree.points(), slot, neighbours);
                    let fitted = sums.normals(simd);
                    let four = sums.neighbourhoods(simd, &fitted);
                    neighbourhoods.copy_from_slice(&four[..neighbourhoods.len()]);
                    take_four(normals, &fitted, slot, &mut without_plane);
                }
            });
            without_plane
        })
        .collect();
    let planes = SlotPlanes {
        normals,
        without_plane: without_plane.concat(),
    };
    (planes, neighbourhoods)
}

/// Writes the normals of consecutive points, and adds the slots of those without a plane.
#[inline(always)]
fn fit_all<S: Simd>(
    simd: S,
    points: &[SlotPoint],
    neighbours: &Neighbours,
    first_slot: usize,
    normals: &mut [Vec3],
    without_plane: &mut Vec<u32>,
) {
    for (normals, slot) in normals.chunks_mut(FOUR).zip((first_slot..).step_by(FOUR)) {
        let fitted = sum_four(simd, points, slot, neighbours).normals(simd);
        take_four(normals, &fitted, slot, without_plane);
    }
}

/// Writes four normals, or fewer at the end, and adds the slots of those without a plane.
#[inline(always)]
fn take_four(normals: &mut [Vec3], fitted: &[(Vec3, bool); FOUR], first_slot: usize, without_plane: &mut Vec<u32>) {
    for ((normal, &(fitted, is_plane)), slot) in normals.iter_mut().zip(fitted).zip(first_slot..) {
        *normal = fitted;
        if !is_plane {
            without_plane.push(slot as u32);
        }
    }
}

/// Estimates those of `normals` (by slot) that are zero.
pub(in crate::analysis) fn fill_missing(tree: &PointTree, neighbours: &Neighbours, normals: &mut [Vec3]) {
    let level = Level::new();
    for (normals, slot) in normals.chunks_mut(FOUR).zip((0..).step_by(FOUR)) {
        if !normals.contains(&Vec3::ZERO) {
            continue;
        }
        let fitted = dispatch!(level, simd => sum_four(simd, tree.points(), slot, neighbours).normals(simd));
        for (normal, (fitted, _)) in normals.iter_mut().zip(fitted) {
            if *normal == Vec3::ZERO {
                *normal = fitted;
            }
        }
    }
}

/// Four consecutive points with their neighbours.
struct FourSums<S: Simd> {
    /// The points.
    centers: [f32x4<S>; 3],
    /// Offsets from the points to the means of their neighbourhoods.
    means: [f64x4<S>; 3],
    /// About the means, not divided by the number of points.
    covariances: FourMatrices<S>,
    /// Points of a neighbourhood.
    count: f64,
}

/// Adds up the neighbourhoods of four consecutive points. Inlined, so that it is compiled for each level of SIMD.
#[inline(always)]
fn sum_four<S: Simd>(simd: S, points: &[SlotPoint], first_slot: usize, neighbours: &Neighbours) -> FourSums<S> {
    // Lanes beyond the last point repeat it. Blocks of slots end at multiples of four, or with it.
    let last = points.len() - 1;
    let slot_of = |lane: usize| (first_slot + lane).min(last);
    let centers = axes_of_four(simd, |lane| points[slot_of(lane)].register());
    let mut lists = [neighbours.of(first_slot); FOUR];
    for (lane, list) in lists.iter_mut().enumerate() {
        *list = neighbours.of(slot_of(lane));
    }
    // The point itself has offset zero and adds nothing.
    let zero = f64x4::splat(simd, 0.0);
    let (mut sums, mut squares, mut products) = ([zero; 3], [zero; 3], [zero; 3]);
    for neighbour in 0..neighbours.per_point() {
        let places = axes_of_four(simd, |lane| points[lists[lane][neighbour] as usize].register());
        // Closures would not be compiled for the SIMD level; loops are.
        let mut offsets = [zero; 3];
        for axis in 0..3 {
            offsets[axis] = widened(simd, places[axis] - centers[axis]);
        }
        for axis in 0..3 {
            let offset = offsets[axis];
            sums[axis] += offset;
            squares[axis] += offset * offset;
            products[axis] += offset * offsets[(axis + 1) % 3];
        }
    }
    let count = (neighbours.per_point() + 1) as f64;
    let mut means = [zero; 3];
    for axis in 0..3 {
        let mean = sums[axis] * (1.0 / count);
        squares[axis] -= sums[axis] * mean;
        products[axis] -= sums[(axis + 1) % 3] * mean;
        means[axis] = mean;
    }
    FourSums {
        centers,
        means,
        covariances: FourMatrices {
            diagonal: squares,
            neighbor: products,
        },
        count,
    }
}

impl<S: Simd> FourSums<S> {
    /// The normals, and whether the neighbours define a plane. The normal of a single place is +Z.
    #[inline(always)]
    fn normals(&self, simd: S) -> [(Vec3, bool); FOUR] {
        let is_plane = covers_a_plane(simd, &self.covariances, self.centers, self.count);
        // Four side by side, as a single matrix mostly waits for its own roots and quotients: normals of 100,000 points
        // take 6 ms of one thread, 19 one at a time.
        let vectors = self.covariances.smallest_eigenvectors(simd);
        let traces = self.covariances.traces();
        let mut fitted = [(Vec3::Z, false); FOUR];
        for (lane, fitted) in fitted.iter_mut().enumerate() {
            if traces[lane] > 0.0 {
                *fitted = (vectors[lane].as_vec3(), is_plane[lane]);
            }
        }
        fitted
    }

    /// The neighbourhoods with these normals.
    #[inline(always)]
    fn neighbourhoods(&self, simd: S, fitted: &[(Vec3, bool); FOUR]) -> [Neighbourhood; FOUR] {
        let share = f64x4::splat(simd, 1.0 / self.count);
        let mut vectors = [[Vec3::ZERO; 3]; FOUR];
        // Closures would not be compiled for the level of SIMD; loops are.
        for axis in 0..3 {
            let centers: [f32; FOUR] = self.centers[axis].into();
            let means: [f64; FOUR] = self.means[axis].into();
            let diagonal: [f64; FOUR] = (self.covariances.diagonal[axis] * share).into();
            let neighbor: [f64; FOUR] = (self.covariances.neighbor[axis] * share).into();
            for (lane, vectors) in vectors.iter_mut().enumerate() {
                vectors[0][axis] = centers[lane] + means[lane] as f32;
                vectors[1][axis] = diagonal[lane] as f32;
                vectors[2][axis] = neighbor[lane] as f32;
            }
        }
        let mut neighbourhoods = [Neighbourhood::default(); FOUR];
        for (neighbourhood, (vectors, (normal, _))) in neighbourhoods.iter_mut().zip(vectors.into_iter().zip(fitted)) {
            *neighbourhood = Neighbourhood::new(vectors, *normal);
        }
        neighbourhoods
    }
}

/// Returns, per lane, true if points (their covariances not divided by their number, `count`) spread in a second
/// direction and so span a plane.
///
/// Rounding moves a coordinate by 2⁻²⁴ of itself at most, and so moves a point off its line by at most √3 · 2⁻²⁴ of its
/// largest coordinate. The two smaller eigenvalues of a rounded line sum up to no more than that squared, for each
/// point; over the largest eigenvalue, which is nearly the trace, they are the pairwise products.
#[inline(always)]
fn covers_a_plane<S: Simd>(simd: S, covariances: &FourMatrices<S>, centers: [f32x4<S>; 3], count: f64) -> [bool; FOUR] {
    const ROUNDING: f64 = 1.0 / (1u64 << 24) as f64;
    let [x, y, z] = centers;
    let center_squared = widened(simd, x * x + y * y + z * z);
    let traces = covariances.traces();
    // At least the square of the largest coordinate: of the point, and of its neighbours' offsets.
    let reach_squared = center_squared + traces;
    let line = traces * reach_squared * (4.0 * count * ROUNDING * ROUNDING);
    let is_plane = covariances.pairwise_products().simd_gt(line);
    let lanes = simd.select_f64x4(is_plane, f64x4::splat(simd, 1.0), f64x4::splat(simd, 0.0));
    let lanes: [f64; FOUR] = lanes.into();
    lanes.map(|lane| lane > 0.0)
}
