//! Splat radii that close the surface.
//!
//! How it works: every place on the surface is nearest to some point, in whose Voronoi cell it is; if each disk covers the
//! Voronoi cell of its own point, the disks cover the surface. So the neighbours are projected onto the tangent plane, and
//! the cell is measured along 32 directions. The line midway to a neighbour at `q` is `|q|² / 2 q·d` away in direction `d`;
//! the cell ends at the nearest of these lines, which is the largest of the `w·d` with `w = 2 q / |q|²`. That needs neither
//! branches nor sorting, and eight directions are one SIMD operation. Where the cell reaches farthest there is a corner; the
//! radius is the distance to the farthest corner, with some overlap for those between two directions. This is about the
//! smallest radius with which a point need not rely on the disks of others.
//!
//! Where the cell is open (the rim of a surface, a line of points) it has no farthest place; there, only corners between two
//! neighbours count, and the lines midway to neighbours.
//!
//! Outliers would get disks that hide the scene: a radius is at most a few times the median of its neighbours' radii, which
//! are small for a stray point near a dense surface but grow along in regions that are sparse throughout; and far
//! beyond the median of the cloud none may grow.
//!
//! When it wins: over multiples of the mean neighbour distance, which are too small for points at the end of a row and too
//! large for all others.

use super::{neighbours::Neighbours, point_tree::PointTree};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x8};
use glam::Vec3;
use rayon::prelude::*;

/// Radius, in scene units, when no two points are apart: a single point, or points that all coincide.
pub const LONE_RADIUS: f32 = 0.5;

/// Disks would only meet in the corners of Voronoi cells; this much more covers corners that lie between two directions
/// (5.6 degrees at most from one, where the cell is 4 % smaller on average) and the curvature of the surface.
const OVERLAP: f32 = 1.2;

/// Largest radius, as a multiple of the harmonic mean of the neighbours' radii: one small radius among them keeps it small.
const MAX_OF_NEIGHBOURS: f32 = 4.0;

/// Largest radius, as a multiple of the median radius of the cloud.
const MAX_OF_CLOUD: f32 = 32.0;

/// Radii in scene units by slot; positive and finite. `normals` are unit vectors of any sign, by slot.
pub(super) fn closing_radii(
    tree: &PointTree,
    neighbours: &Neighbours,
    normals: &[Vec3],
) -> Vec<f32> {
    let directions = Directions::new();
    let level = Level::new();
    let mut raw = vec![0.0; tree.len()];
    raw.par_chunks_mut(POINTS_PER_TASK)
        .enumerate()
        .for_each(|(task, raw)| {
            let cells = Cells {
                directions: &directions,
                positions: tree.positions(),
                neighbours,
                normals,
            };
            dispatch!(level, simd => cells.measure(simd, POINTS_PER_TASK * task, raw));
        });
    let median = median_of_positive(&raw);
    let inverse: Vec<f32> = raw
        .iter()
        .map(|&radius| if radius > 0.0 { 1.0 / radius } else { 0.0 })
        .collect();
    let largest = MAX_OF_CLOUD * median;
    (0..tree.len())
        .into_par_iter()
        .with_min_len(POINTS_PER_TASK)
        .map(|slot| {
            let own = if raw[slot] > 0.0 { raw[slot] } else { median };
            let of_neighbours = MAX_OF_NEIGHBOURS * harmonic_mean(&inverse, neighbours.of(slot));
            let radius = OVERLAP * own.min(of_neighbours).min(largest) * tree.unit();
            if radius > 0.0 {
                radius.min(f32::MAX)
            } else {
                LONE_RADIUS
            }
        })
        .collect()
}

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 10;

/// Share of the inverse distance to the last neighbour below which the cell is open.
const OPEN: f32 = 0.5;

/// Directions in the tangent plane along which a cell is measured.
const DIRECTIONS: usize = 32;

/// One number for each of eight directions, or of eight neighbours.
type Row = [f32; 8];

/// Rows of directions in one half of the circle. The other half are their opposites, along which everything is as long with
/// the opposite sign.
const HALF: usize = DIRECTIONS / 8 / 2;

/// Cosines and sines of the evenly spaced directions of one half.
struct Directions {
    cosines: [Row; HALF],
    sines: [Row; HALF],
}

impl Directions {
    fn new() -> Self {
        let rows = |f: fn(f64) -> f64| {
            std::array::from_fn(|row| {
                std::array::from_fn(|lane| {
                    let turn = (8 * row + lane) as f64 / DIRECTIONS as f64;
                    f(turn * std::f64::consts::TAU) as f32
                })
            })
        };
        Self {
            cosines: rows(f64::cos),
            sines: rows(f64::sin),
        }
    }
}

/// What the cells of a cloud are measured from.
struct Cells<'a> {
    directions: &'a Directions,
    positions: &'a [Vec3],
    neighbours: &'a Neighbours,
    normals: &'a [Vec3],
}

impl Cells<'_> {
    /// Writes the radii of the cells of consecutive points. Inlined, so that it is compiled for each level of SIMD.
    #[inline(always)]
    fn measure<S: Simd>(&self, simd: S, first_slot: usize, radii: &mut [f32]) {
        for (radius, slot) in radii.iter_mut().zip(first_slot..) {
            *radius = self.cell_radius(simd, slot);
        }
    }

    /// Distance from a point to the farthest corner of its Voronoi cell in its tangent plane; 0 without neighbours apart.
    #[inline(always)]
    fn cell_radius<S: Simd>(&self, simd: S, slot: usize) -> f32 {
        let point = self.positions[slot];
        let (u, v) = self.normals[slot].any_orthonormal_pair();
        let zero = f32x8::splat(simd, 0.0);
        // One over the distance to the end of the cell in each direction of one half, and minus that in the opposite ones.
        let mut most = [zero; HALF];
        let mut least = [zero; HALF];
        let mut reach_squared = f32x8::splat(simd, 0.0);
        for chunk in self.neighbours.of(slot).chunks(8) {
            // Lanes without a neighbour have the point itself, whose offset is zero.
            let mut places = [[point.x; 8], [point.y; 8], [point.z; 8]];
            for (lane, &neighbour) in chunk.iter().enumerate() {
                let place = self.positions[neighbour as usize];
                places[0][lane] = place.x;
                places[1][lane] = place.y;
                places[2][lane] = place.z;
            }
            let dx = f32x8::from_slice(simd, &places[0]) - point.x;
            let dy = f32x8::from_slice(simd, &places[1]) - point.y;
            let dz = f32x8::from_slice(simd, &places[2]) - point.z;
            let x = dx * u.x + dy * u.y + dz * u.z;
            let y = dx * v.x + dy * v.y + dz * v.z;
            let squared = x * x + y * y;
            reach_squared = reach_squared.max(squared);
            // A neighbour right above or below has no line midway.
            let is_apart = squared.simd_gt(zero);
            let scale = simd.select_f32x8(is_apart, f32x8::splat(simd, 2.0) / squared, zero);
            let (wx, wy): (Row, Row) = ((x * scale).into(), (y * scale).into());
            for lane in 0..chunk.len() {
                let (wx, wy) = (f32x8::splat(simd, wx[lane]), f32x8::splat(simd, wy[lane]));
                for row in 0..HALF {
                    let cosines = f32x8::from_slice(simd, &self.directions.cosines[row]);
                    let sines = f32x8::from_slice(simd, &self.directions.sines[row]);
                    let along = wx * cosines + wy * sines;
                    most[row] = most[row].max(along);
                    least[row] = least[row].min(along);
                }
            }
        }
        let mut inverse = [zero; 2 * HALF];
        for row in 0..HALF {
            inverse[row] = most[row];
            inverse[HALF + row] = -least[row];
        }
        // What is extreme along the circle is a corner or the middle of a side. Beyond the last neighbour nothing is
        // known, so a corner there is taken to be no farther than it, and twice as far out the cell counts as open.
        let known = 1.0 / largest_of(reach_squared.into()).sqrt();
        let open = f32x8::splat(simd, OPEN * known);
        let nowhere = f32x8::splat(simd, f32::INFINITY);
        let mut smallest = nowhere;
        for row in 0..inverse.len() {
            let here = inverse[row];
            let before = inverse[(row + inverse.len() - 1) % inverse.len()].slide::<7>(here);
            let after = here.slide::<1>(inverse[(row + 1) % inverse.len()]);
            let turns = (here - before) * (here - after);
            let is_extreme = turns.simd_ge(f32x8::splat(simd, 0.0));
            let counts = simd.select_f32x8(is_extreme, here, nowhere);
            let counts = simd.select_f32x8(here.simd_ge(open), counts, nowhere);
            smallest = smallest.min(counts);
        }
        1.0 / smallest_of(smallest.into()).max(known)
    }
}

fn largest_of(row: Row) -> f32 {
    row.into_iter().fold(0.0, f32::max)
}

fn smallest_of(row: Row) -> f32 {
    row.into_iter().fold(f32::INFINITY, f32::min)
}

/// The harmonic mean of the neighbours' radii as far as they are positive, from their inverses (0 for those that are not);
/// not finite if none is.
fn harmonic_mean(inverse: &[f32], neighbours: &[u32]) -> f32 {
    let inverse_sum: f32 = neighbours
        .iter()
        .map(|&neighbour| inverse[neighbour as usize])
        .sum();
    neighbours.len() as f32 / inverse_sum
}

/// The median of all positive values; 0 without one.
fn median_of_positive(values: &[f32]) -> f32 {
    let mut positive: Vec<f32> = values
        .iter()
        .copied()
        .filter(|&value| value > 0.0)
        .collect();
    if positive.is_empty() {
        return 0.0;
    }
    let middle = positive.len() / 2;
    *positive.select_nth_unstable_by(middle, f32::total_cmp).1
}
