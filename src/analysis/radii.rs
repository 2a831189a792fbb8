//! Splat radii that close the surface.
//!
//! How it works: every place on the surface is nearest to some point, in whose Voronoi cell it is; if each disk covers the
//! Voronoi cell of its own point, the disks cover the surface. So the neighbours are projected onto the tangent plane and a
//! polygon is cut down by the lines midway to each of them, nearest first; its farthest corner is the radius. This
//! is the smallest radius with which a point need not rely on the disks of others.
//!
//! Where the cell is open (the rim of a surface, a line of points) only corners between two neighbours count, and the
//! lines midway to the neighbours that took part.
//!
//! Outliers would get disks that hide the scene: a radius is at most a few times the median of its neighbours' radii, which
//! are small for a stray point near a dense surface but grow along in regions that are sparse throughout; and far
//! beyond the median of the cloud none may grow.
//!
//! When it wins: over multiples of the mean neighbour distance, which are too small for points at the end of a row and too
//! large for all others.

use super::{neighbours::Neighbours, point_tree::PointTree};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Radius, in scene units, when no two points are apart: a single point, or points that all coincide.
pub const LONE_RADIUS: f32 = 0.5;

/// Disks meet in corners of Voronoi cells; this much more lets them overlap there, for curvature and rounding.
const OVERLAP: f32 = 1.15;

/// Largest radius, as a multiple of the distance to the last neighbour: corners beyond it are not known to be corners.
const MAX_OF_REACH: f32 = 1.0;

/// Largest radius, as a multiple of the median radius of the neighbours.
const MAX_OF_NEIGHBOURS: f32 = 3.0;

/// Largest radius, as a multiple of the median radius of the cloud.
const MAX_OF_CLOUD: f32 = 32.0;

/// Radii in scene units by slot; positive and finite. `normals` are unit vectors of any sign, by slot.
pub(super) fn closing_radii(
    tree: &PointTree,
    neighbours: &Neighbours,
    normals: &[Vec3],
) -> Vec<f32> {
    let raw: Vec<f32> = (0..tree.len())
        .into_par_iter()
        .with_min_len(1 << 9)
        .map(|slot| cell_radius(tree.positions(), slot, neighbours.of(slot), normals[slot]))
        .collect();
    let median = median_of_positive(&raw);
    (0..tree.len())
        .into_par_iter()
        .with_min_len(1 << 9)
        .map(|slot| {
            let own = if raw[slot] > 0.0 { raw[slot] } else { median };
            let capped = own
                .min(MAX_OF_NEIGHBOURS * median_of_neighbours(&raw, neighbours.of(slot), own))
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

/// Distance from a point to the farthest corner of its Voronoi cell in its tangent plane; 0 without neighbours apart.
fn cell_radius(positions: &[Vec3], slot: usize, neighbours: &[u32], normal: Vec3) -> f32 {
    let point = positions[slot];
    let Some(&last) = neighbours.last() else {
        return 0.0;
    };
    let reach = (positions[last as usize] - point).length();
    if reach == 0.0 {
        return 0.0;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let mut cell = Cell::square(reach);
    let mut half_of_cutting: f32 = 0.0;
    for &neighbour in neighbours {
        let offset = positions[neighbour as usize] - point;
        let projected = Vec2::new(offset.dot(u), offset.dot(v));
        let half_squared = 0.25 * projected.length_squared();
        if half_squared < cell.farthest_squared && cell.cut(projected) {
            half_of_cutting = half_of_cutting.max(half_squared);
        }
    }
    let corners = cell.farthest_inner_corner_squared();
    corners
        .max(half_of_cutting)
        .sqrt()
        .min(MAX_OF_REACH * reach)
}

/// Most corners a cell can have: those of the square and one for each cut.
const MAX_CORNERS: usize = 4 + super::DEFAULT_NEIGHBOURS;

/// A convex polygon around the origin, shrinking from a square.
struct Cell {
    corners: [Vec2; MAX_CORNERS],
    count: usize,
    half_edge: f32,
    farthest_squared: f32,
}

impl Cell {
    fn square(half_edge: f32) -> Self {
        let mut corners = [Vec2::ZERO; MAX_CORNERS];
        for (corner, (x, y)) in
            corners
                .iter_mut()
                .zip([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
        {
            *corner = Vec2::new(x, y) * half_edge;
        }
        Self {
            corners,
            count: 4,
            half_edge,
            farthest_squared: 2.0 * half_edge * half_edge,
        }
    }

    /// Keeps what is nearer to the origin than to `other`; whether that took anything away.
    fn cut(&mut self, other: Vec2) -> bool {
        let middle = 0.5 * other.length_squared();
        // Positive beyond the line midway.
        let beyond = |corner: Vec2| corner.dot(other) - middle;
        let old = self.corners;
        let mut count = 0;
        let mut keep = |corner: Vec2, corners: &mut [Vec2; MAX_CORNERS]| {
            // A cut adds one corner; rounding could add another, which is left out.
            if let Some(place) = corners.get_mut(count) {
                *place = corner;
                count += 1;
            }
        };
        let mut changed = false;
        let mut from = old[self.count - 1];
        let mut from_beyond = beyond(from);
        for &to in &old[..self.count] {
            let to_beyond = beyond(to);
            if (from_beyond > 0.0) != (to_beyond > 0.0) {
                let share = from_beyond / (from_beyond - to_beyond);
                keep(from + (to - from) * share, &mut self.corners);
            }
            if to_beyond > 0.0 {
                changed = true;
            } else {
                keep(to, &mut self.corners);
            }
            (from, from_beyond) = (to, to_beyond);
        }
        if changed {
            self.count = count;
            self.farthest_squared = self.corners[..count]
                .iter()
                .fold(0.0, |farthest: f32, corner| {
                    farthest.max(corner.length_squared())
                });
        }
        changed
    }

    /// The farthest corner that is not on the square the cell began as; 0 without one.
    fn farthest_inner_corner_squared(&self) -> f32 {
        self.corners[..self.count]
            .iter()
            .filter(|corner| corner.abs().max_element() < self.half_edge)
            .fold(0.0, |farthest: f32, corner| {
                farthest.max(corner.length_squared())
            })
    }
}

fn median_of_neighbours(raw: &[f32], neighbours: &[u32], own: f32) -> f32 {
    let mut radii = [0.0; super::DEFAULT_NEIGHBOURS];
    let mut count = 0;
    for (place, &neighbour) in radii.iter_mut().zip(neighbours) {
        *place = raw[neighbour as usize];
        count += 1;
    }
    if count == 0 {
        return own;
    }
    let (_, median, _) = radii[..count].select_nth_unstable_by(count / 2, f32::total_cmp);
    if *median > 0.0 { *median } else { own }
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
