//! Splat radii that close the surface.
//!
//! How it works: every place on the surface is nearest to some point, in whose Voronoi cell it is; if each disk covers the
//! Voronoi cell of its own point, the disks cover the surface. So the neighbours are projected onto the tangent plane, and
//! the cell is measured along 32 directions. The line midway to a neighbour at `q` is `|q|² / 2 q·d` away in direction `d`;
//! the cell ends at the nearest of these lines, which is the largest of the `w·d` with `w = 2 q / |q|²`. That needs neither
//! branches nor sorting, and four directions are one SIMD operation. Where the cell reaches farthest there is a corner; the
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
use glam::{Vec3, Vec4};
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
    let raw: Vec<f32> = (0..tree.len())
        .into_par_iter()
        .with_min_len(1 << 9)
        .map(|slot| {
            directions.cell_radius(tree.positions(), slot, neighbours.of(slot), normals[slot])
        })
        .collect();
    let median = median_of_positive(&raw);
    (0..tree.len())
        .into_par_iter()
        .with_min_len(1 << 10)
        .map(|slot| {
            let own = if raw[slot] > 0.0 { raw[slot] } else { median };
            let capped = own
                .min(MAX_OF_NEIGHBOURS * harmonic_mean(&raw, neighbours.of(slot)))
                .min(MAX_OF_CLOUD * median);
            let radius = OVERLAP * capped * tree.unit();
            if radius > 0.0 {
                radius.min(f32::MAX)
            } else {
                LONE_RADIUS
            }
        })
        .collect()
}

/// Share of the inverse distance to the last neighbour below which the cell is open.
const OPEN: f32 = 0.5;

/// Directions in the tangent plane along which a cell is measured.
const DIRECTIONS: usize = 32;

/// Cosines and sines of evenly spaced directions.
struct Directions {
    cosines: [Vec4; DIRECTIONS / 4],
    sines: [Vec4; DIRECTIONS / 4],
}

impl Directions {
    fn new() -> Self {
        let registers = |f: fn(f64) -> f64| {
            std::array::from_fn(|register| {
                Vec4::from_array(std::array::from_fn(|lane| {
                    let turn = (4 * register + lane) as f64 / DIRECTIONS as f64;
                    f(turn * std::f64::consts::TAU) as f32
                }))
            })
        };
        Self {
            cosines: registers(f64::cos),
            sines: registers(f64::sin),
        }
    }

    /// Distance from a point to the farthest corner of its Voronoi cell in its tangent plane; 0 without neighbours apart.
    fn cell_radius(
        &self,
        positions: &[Vec3],
        slot: usize,
        neighbours: &[u32],
        normal: Vec3,
    ) -> f32 {
        let point = positions[slot];
        let (u, v) = normal.any_orthonormal_pair();
        // One over the distance to the end of the cell in each direction.
        let mut inverse = [Vec4::ZERO; DIRECTIONS / 4];
        let mut reach_squared: f32 = 0.0;
        for &neighbour in neighbours {
            let offset = positions[neighbour as usize] - point;
            let (x, y) = (offset.dot(u), offset.dot(v));
            let squared = x * x + y * y;
            reach_squared = reach_squared.max(squared);
            // A neighbour right above or below has no line midway.
            let scale = if squared > 0.0 { 2.0 / squared } else { 0.0 };
            let (wx, wy) = (Vec4::splat(x * scale), Vec4::splat(y * scale));
            for (inverse, (cosine, sine)) in
                inverse.iter_mut().zip(self.cosines.iter().zip(&self.sines))
            {
                *inverse = inverse.max(wx * *cosine + wy * *sine);
            }
        }
        // What is extreme along the circle is a corner or the middle of a side. Beyond the last neighbour nothing is
        // known, so a corner there is taken to be no farther than it, and twice as far out the cell counts as open.
        let known = 1.0 / reach_squared.sqrt();
        let open = OPEN * known;
        let inverse: [f32; DIRECTIONS] = bytemuck::cast(inverse);
        let mut smallest = f32::INFINITY;
        for place in 0..DIRECTIONS {
            let before = inverse[(place + DIRECTIONS - 1) % DIRECTIONS];
            let after = inverse[(place + 1) % DIRECTIONS];
            let here = inverse[place];
            let is_extreme = (here - before) * (here - after) >= 0.0;
            let counts = is_extreme && here >= open;
            smallest = smallest.min(if counts { here } else { f32::INFINITY });
        }
        1.0 / smallest.max(known)
    }
}

/// The harmonic mean of the neighbours' radii as far as they are positive; not finite if none is.
fn harmonic_mean(raw: &[f32], neighbours: &[u32]) -> f32 {
    let inverse_sum: f32 = neighbours
        .iter()
        .map(|&neighbour| raw[neighbour as usize])
        .map(|radius| if radius > 0.0 { 1.0 / radius } else { 0.0 })
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
