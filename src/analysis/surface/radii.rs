//! The splat radius of each point: as large as it takes to close the surface.
//!
//! How it works: every position on the surface is nearest to some point, in whose Voronoi cell it is; if each disk
//! covers the Voronoi cell of its own point, the disks cover the surface. So the neighbours are projected onto the
//! tangent plane, and the cell is measured along 32 directions. The line midway to a neighbour at `q` is `|q|² / 2 q·d`
//! away in direction `d`; the cell ends at the nearest of these lines, that is, the largest of the `w·d` with `w = 2 q
//! / |q|²`. That needs neither branches nor sorting, and eight points are measured in one SIMD register. Where the cell
//! reaches farthest there is a corner; the radius is the distance to the farthest corner, with some overlap for corners
//! between two directions. This is about the smallest radius with which a point need not rely on the disks of others.
//!
//! Where the cell is open (the edge of a surface, a line of points) it has no farthest place; there, only corners
//! between two neighbours count, and the lines midway to neighbours. A gap may be narrower than the angle between
//! directions: the cell of a point in a row is a strip between two parallel lines. So between two directions the lines
//! that end the cell on both sides are continued to where they meet ([`super::holes`]).
//!
//! Outliers would get disks that hide the scene: a radius is at most a few times the harmonic mean of its neighbours'
//! radii, which are small for an outlier near a dense surface but grow along in regions that are sparse throughout; and
//! no radius may grow far beyond the median of the cloud.
//!
//! When it wins: over multiples of the mean neighbour distance, which are too small for points at the end of a row and
//! too large for all others.

use super::directions::{DIRECTIONS, QUARTER, quarter_circle};
use super::holes;
use crate::analysis::search::lanes::axes;
use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{LANES, LaneRow, PointTree, SlotPoint};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, SimdMask, dispatch, f32x8, mask32x8};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Radius, in scene units, when no two points are apart: a single point, or points that all coincide.
pub const LONE_RADIUS: f32 = 0.5;

/// Disks would only meet in the corners of Voronoi cells; this much more covers corners that lie between two directions
/// (5.6 degrees at most from one, where the cell is 4 % smaller on average) and the curvature of the surface.
const OVERLAP: f32 = 1.2;

/// Largest radius, as a multiple of the harmonic mean of the neighbours' radii: one small radius among them keeps it
/// small.
const MAX_OF_NEIGHBOURS: f32 = 4.0;

/// Largest radius, as a multiple of the median radius of the cloud.
const MAX_OF_CLOUD: f32 = 32.0;

/// Radii in scene units by slot; positive and finite. `normals` are unit vectors of any sign, by slot.
pub(in crate::analysis) fn closing_radii(tree: &PointTree, neighbours: &Neighbours, normals: &[Vec3]) -> Vec<f32> {
    let cells = cell_radii(tree, neighbours, normals, 0..tree.len());
    let limits = Limits::new(tree, sample(tree.len()).map(|slot| cells[slot]));
    let inverse: Vec<f32> = cells.iter().map(|&radius| inverse_of(radius)).collect();
    let mut radii = cells;
    radii
        .par_chunks_mut(POINTS_PER_TASK)
        .enumerate()
        .for_each(|(task, radii)| {
            let slots = POINTS_PER_TASK * task..;
            for (radii, first_slot) in radii.chunks_mut(LANES).zip(slots.step_by(LANES)) {
                let sums = inverse_sums(&inverse, neighbours, first_slot, radii.len());
                for (radius, sum) in radii.iter_mut().zip(sums) {
                    *radius = limits.radius(*radius, neighbours.per_point(), sum);
                }
            }
        });
    radii
}

/// Distances from consecutive points to the farthest corners of their cells, in units of the tree; 0 without distinct
/// neighbours. `normals` belong to these points. Precondition: the first slot begins a bucket, and the last one ends
/// one or is the last of all.
pub(super) fn cell_radii(tree: &PointTree, neighbours: &Neighbours, normals: &[Vec3], slots: Range<usize>) -> Vec<f32> {
    let level = Level::new();
    let mut radii = vec![0.0; slots.len()];
    let cells = VoronoiCells {
        directions: quarter_circle(),
        points: tree.points(),
        neighbours,
        normals,
        first_slot: slots.start,
    };
    radii
        .par_chunks_mut(POINTS_PER_TASK)
        .enumerate()
        .for_each(|(task, radii)| {
            let first = slots.start + POINTS_PER_TASK * task;
            dispatch!(level, simd => cells.measure(simd, first, radii));
        });
    radii
}

/// One over the radius of a cell; 0 if it is 0.
pub(super) fn inverse_of(radius: f32) -> f32 {
    if radius > 0.0 { 1.0 / radius } else { 0.0 }
}

/// The sum of the inverse radii of a point's neighbours: from zero and in their order, for another sum may differ in
/// its last bit.
pub(super) fn sum_in_order(inverse: impl Iterator<Item = f32>) -> f32 {
    inverse.fold(0.0, |sum, inverse| sum + inverse)
}

/// Limits of the radii of a cloud.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Median of the radii of cells.
    median: f32,
    /// Unit of the tree, in scene units.
    unit: f32,
}

impl Limits {
    /// Limits of a cloud of whose cells the [`sample`] has these radii.
    pub(in crate::analysis) fn new(tree: &PointTree, sample: impl Iterator<Item = f32>) -> Self {
        Self {
            median: median_of_positive(sample),
            unit: tree.unit(),
        }
    }

    /// The radius, in scene units, of a point whose cell and the inverse radii of whose neighbours' cells, summed up,
    /// are these.
    #[inline(always)]
    pub(in crate::analysis) fn radius(self, cell: f32, neighbours: usize, inverse_sum: f32) -> f32 {
        // Harmonic mean over all neighbours; not finite if none has a cell.
        let mean = neighbours as f32 / inverse_sum;
        let own = if cell > 0.0 { cell } else { self.median };
        let largest = MAX_OF_CLOUD * self.median;
        let limited = OVERLAP * own.min(MAX_OF_NEIGHBOURS * mean).min(largest) * self.unit;
        if limited > 0.0 {
            limited.min(f32::MAX)
        } else {
            LONE_RADIUS
        }
    }
}

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 10;

/// Share of the inverse distance to the last neighbour below which the cell is open.
const OPEN_ALONG: f32 = 0.5;

/// Input of the measurement of a cloud's Voronoi cells.
struct VoronoiCells<'a> {
    directions: [[f32; 2]; QUARTER],
    points: &'a [SlotPoint],
    neighbours: &'a Neighbours,
    /// From the first slot on.
    normals: &'a [Vec3],
    first_slot: usize,
}

impl VoronoiCells<'_> {
    /// Writes the radii of the cells of consecutive points. Inlined, so that it is compiled for each level of SIMD.
    #[inline(always)]
    fn measure<S: Simd>(&self, simd: S, first_slot: usize, radii: &mut [f32]) {
        // Each point needs its own cell: radii shared by the 16 points of a bucket close the surface only when surfels
        // cover 2.8 times the area.
        let mut lines = vec![[[0.0; LANES]; 2]; self.neighbours.per_point()];
        for (radii, slot) in radii.chunks_mut(LANES).zip((first_slot..).step_by(LANES)) {
            let measured = self.cell_radii(simd, slot, &mut lines);
            radii.copy_from_slice(&measured[..radii.len()]);
        }
    }

    /// Distances from eight points to the farthest corners of their Voronoi cells in their tangent planes; 0 without
    /// neighbours apart. `lines` is scratch.
    #[inline(always)]
    fn cell_radii<S: Simd>(&self, simd: S, first_slot: usize, lines: &mut [[LaneRow; 2]]) -> LaneRow {
        let zero = f32x8::splat(simd, 0.0);
        // Lanes beyond the last point repeat it.
        let last = self.first_slot + self.normals.len() - 1;
        let slot_of = |lane: usize| (first_slot + lane).min(last);
        let points = axes(simd, |lane| self.points[slot_of(lane)].register());
        let normals = axes(simd, |lane| self.normals[slot_of(lane) - self.first_slot].extend(0.0));
        let (tangents, bitangents) = orthonormal_pair(simd, normals);
        let mut lists = [self.neighbours.of(first_slot); LANES];
        for (lane, list) in lists.iter_mut().enumerate() {
            *list = self.neighbours.of(slot_of(lane));
        }
        let mut reach_squared = zero;
        for (neighbour, line) in lines.iter_mut().enumerate() {
            let places = axes(simd, |lane| self.points[lists[lane][neighbour] as usize].register());
            let (mut x, mut y) = (zero, zero);
            for axis in 0..3 {
                let offset = places[axis] - points[axis];
                x += offset * tangents[axis];
                y += offset * bitangents[axis];
            }
            let squared = x * x + y * y;
            reach_squared = reach_squared.max(squared);
            // A neighbour directly above or below has no bisector.
            let is_apart = squared.simd_gt(zero);
            let scale = simd.select_f32x8(is_apart, f32x8::splat(simd, 2.0) / squared, zero);
            (x * scale).store_slice(&mut line[0]);
            (y * scale).store_slice(&mut line[1]);
        }
        // The reciprocal of the distance to the end of the cell in each direction.
        let mut inverse = [[0.0; LANES]; DIRECTIONS];
        for (direction, &[cosine, sine]) in self.directions.iter().enumerate() {
            let (mut max, mut min) = (zero, zero);
            let (mut mirrored_max, mut mirrored_min) = (zero, zero);
            for line in &*lines {
                let x = f32x8::from_slice(simd, &line[0]) * cosine;
                let y = f32x8::from_slice(simd, &line[1]) * sine;
                let (along, mirrored) = (x + y, x - y);
                max = max.max(along);
                min = min.min(along);
                mirrored_max = mirrored_max.max(mirrored);
                mirrored_min = mirrored_min.min(mirrored);
            }
            max.store_slice(&mut inverse[direction]);
            (-min).store_slice(&mut inverse[DIRECTIONS / 2 + direction]);
            mirrored_max.store_slice(&mut inverse[(DIRECTIONS - direction) % DIRECTIONS]);
            (-mirrored_min).store_slice(&mut inverse[DIRECTIONS / 2 - direction]);
        }
        // Extrema along the circle are a corner or the centre of a side. Beyond the last neighbour nothing is known, so
        // a corner there is assumed to be no farther than that neighbour, and twice as far out the cell counts as open.
        let known = f32x8::splat(simd, 1.0) / reach_squared.sqrt();
        let (mut smallest, may_open) = smallest_extreme(simd, &inverse, known);
        // Handling gaps between directions costs 2 % of the CPU time of surfaces, radii and planes; it changes the
        // radius of 2 of 100,000 points on a torus.
        if may_open.any_true() {
            holes::set_open(&self.directions, lines, known.into(), &mut inverse);
            (smallest, _) = smallest_extreme(simd, &inverse, known);
        }
        (f32x8::splat(simd, 1.0) / smallest.max(known)).into()
    }
}

/// The smallest inverse distances that count, and which cells may be open between two directions.
#[inline(always)]
fn smallest_extreme<S: Simd>(simd: S, inverse: &[LaneRow; DIRECTIONS], known: f32x8<S>) -> (f32x8<S>, mask32x8<S>) {
    let zero = f32x8::splat(simd, 0.0);
    let nowhere = f32x8::splat(simd, f32::INFINITY);
    let open = known * OPEN_ALONG;
    let open_between = known * holes::OPEN_BETWEEN;
    let mut smallest = nowhere;
    let mut min_meeting = nowhere;
    let mut before = f32x8::from_slice(simd, &inverse[DIRECTIONS - 1]);
    let mut here = f32x8::from_slice(simd, &inverse[0]);
    let mut surplus_before = zero;
    for direction in 0..=DIRECTIONS {
        let after = f32x8::from_slice(simd, &inverse[(direction + 1) % DIRECTIONS]);
        let turns = (here - before) * (here - after);
        let counts = simd.select_f32x8(turns.simd_ge(zero), here, nowhere);
        let counts = simd.select_f32x8(here.simd_ge(open), counts, nowhere);
        smallest = smallest.min(counts);
        // See `holes`; rounding makes surpluses negative.
        let surplus = (before - here * holes::TWICE_COSINE + after).max(zero);
        let meeting = surplus_before * (before - open_between) + surplus * (here - open_between - surplus_before);
        let is_between = before.min(here).simd_ge(open);
        let meeting = simd.select_f32x8(is_between, meeting, nowhere);
        min_meeting = min_meeting.min(meeting);
        surplus_before = surplus;
        before = here;
        here = after;
    }
    (smallest, min_meeting.simd_lt(zero))
}

/// Two unit vectors across each of eight and across each other (Duff et al. 2017, *Building an Orthonormal Basis,
/// Revisited*).
#[inline(always)]
fn orthonormal_pair<S: Simd>(simd: S, [x, y, z]: [f32x8<S>; 3]) -> ([f32x8<S>; 3], [f32x8<S>; 3]) {
    let one = f32x8::splat(simd, 1.0);
    let sign = one.copysign(z);
    let a = -one / (sign + z);
    let b = x * y * a;
    ([one + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y])
}

/// The inverse radii of the neighbours' cells, summed up for each of up to eight consecutive points. Eight sums side by
/// side, for each waits for its last term.
fn inverse_sums(inverse: &[f32], neighbours: &Neighbours, first_slot: usize, count: usize) -> LaneRow {
    let lists: [&[u32]; LANES] = std::array::from_fn(|lane| neighbours.of(first_slot + lane.min(count - 1)));
    let mut sums = [0.0; LANES];
    for neighbour in 0..neighbours.per_point() {
        for (sum, list) in sums.iter_mut().zip(lists) {
            *sum += inverse[list[neighbour] as usize];
        }
    }
    sums
}

/// Values that a median is taken of: it is off by four percent of the ranks at most times, which limits of many times
/// the median do not feel.
const SAMPLE: usize = 1 << 9;

/// Evenly spaced slots of a cloud, of whose cells the median is taken; all where there are few.
pub(in crate::analysis) fn sample(count: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(count.div_ceil(SAMPLE).max(1))
}

/// The median of those that are positive; 0 without one.
fn median_of_positive(values: impl Iterator<Item = f32>) -> f32 {
    let mut positive: Vec<f32> = values.filter(|&value| value > 0.0).collect();
    if positive.is_empty() {
        return 0.0;
    }
    let center = positive.len() / 2;
    *positive.select_nth_unstable_by(center, f32::total_cmp).1
}
