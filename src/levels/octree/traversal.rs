//! Traversal with frustum culling: the nodes that represent the cloud in one view (the 4D media paper §VI-B).
//!
//! How it works: from the root down, a node is dropped when its bounding sphere (the diagonal of the cell is its
//! diameter) is outside the frustum, and emitted when it is a leaf or its edge covers less than the LOD threshold on
//! screen. Five measures spare most nodes a test, and save time:
//!
//! - *Inside mask.* A plane that a sphere is entirely inside of is not tested again below that node.
//! - *Uniform cuts.* Once no plane is left, the nearest and the farthest distance of a cell bound where all of its
//!   descendants would stop. When both name the same level, the result for the whole subtree is all of its nodes on
//!   that level: the points of the cell, emitted at once. Only cells that straddle the border of the frustum or of two
//!   levels of detail are descended into.
//! - *Small subtrees* that straddle one of these are not descended into: their cells are tested eight at a time
//!   (`small_subtrees.rs`).
//! - *Normal cones*, for back-face culling. A node whose points all face away is dropped, if that is requested
//!   ([`LodSurfels`]).
//! - *Subtrees in parallel.* The octants of the root, and theirs, are traversed by all threads.
//!
//! The eight octants of the root, and those below, come nearest first, so that nodes drawn early occlude later ones.
//!
//! Levels of detail do not flicker: given the cut of the previous view, a cell changes sides only when it is a tenth
//! beyond the threshold; and a subtree that was uniform, and may stay so, is emitted at once.
//!
//! When it wins: always; at worst (every cell straddles something) it visits the same nodes as a plain traversal.
//!
//! Distances are to the nearest point of a cell, so a projected edge is never underestimated, and an eye inside a cell
//! always descends. The output depends on tree, view and hints alone.

use super::cut_before::CutByPoints;
use super::small_subtrees::Subtree;
use super::surfels::LodSurfels;
use super::tree::Octree;
use crate::levels::cut::{Cut, NodeRange, SelectView};
use crate::math::{Frustum, morton::LEVELS};
use fearless_simd::Level;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

impl Octree {
    /// Returns the cut of nodes that represent the cloud in `view`, given the cut of the previous view. Nodes whose
    /// points all face away according to `back_faces` are culled.
    pub(super) fn cut_between(&self, view: &SelectView, before: Option<&Cut>, back_faces: Option<&LodSurfels>) -> Cut {
        let mut cut = Cut {
            lod_px: view.lod_px,
            ..Cut::default()
        };
        if self.point_count() > 0 {
            let before = before.map(CutByPoints::new);
            if let Some(surfels) = back_faces {
                surfels.work_out_cones();
            }
            let traversal = Traversal {
                simd: Level::new(),
                tree: self,
                view: *view,
                levels: self.level_limits(view, before.is_some()),
                slack: self.distance_slack(view.eye),
                back_faces,
                before,
            };
            let root = Visit {
                node: self.root(),
                cell: [0; 3],
                planes: ALL_PLANES,
            };
            traversal.visit(root, &mut cut);
            cut.node_count = self.points.count_nodes(&cut.ranges);
        }
        cut
    }

    fn level_limits(&self, view: &SelectView, has_before: bool) -> [LevelLimits; LEVELS as usize + 1] {
        let band = if has_before { HYSTERESIS } else { 0.0 };
        std::array::from_fn(|level| {
            let edge = self.cube.cell_edge(level as u32);
            let beyond_squared = |share: f64| {
                if level as u32 >= view.deepest_level {
                    ALWAYS
                } else {
                    stop_distance_squared(edge, view, share)
                }
            };
            LevelLimits {
                edge,
                sphere_radius: 0.5 * 3f32.sqrt() * edge,
                may_stop_beyond_squared: beyond_squared(1.0 + band),
                stop_beyond_squared: beyond_squared(1.0),
                must_stop_beyond_squared: beyond_squared(1.0 - band),
            }
        })
    }

    /// A bound for the rounding of distances between `eye` and anything in the cube.
    fn distance_slack(&self, eye: Vec3) -> f32 {
        let reach = self.cube.min.as_vec3().abs().max_element() + self.cube.edge + eye.abs().max_element();
        4.0 * f32::EPSILON * reach
    }
}

/// Every squared distance is beyond it.
const ALWAYS: f32 = -1.0;

/// Fraction of the threshold by which a cell must be larger to be divided, or smaller not to be, than the previous view
/// decided. A tenth is more than a hand that holds the mouse still moves the camera, and too little to see.
const HYSTERESIS: f64 = 0.1;

/// A cell with this edge is not divided at a fraction of the threshold when the square of its distance is above this;
/// infinite when it always is.
fn stop_distance_squared(edge: f32, view: &SelectView, share: f64) -> f32 {
    let lod_px = f64::from(view.metric.edge_px(view.lod_px)) * share;
    if lod_px > 0.0 {
        (f64::from(edge) * f64::from(view.pixels_per_unit_at_1) / lod_px).powi(2) as f32
    } else {
        f32::INFINITY
    }
}

/// One bit for each frustum plane that still has to be tested.
pub(super) type PlaneMask = u8;
const ALL_PLANES: PlaneMask = (1 << Frustum::PLANES) - 1;

/// Relative margin of squared distances beyond which rounding cannot change a decision.
const MARGIN: f32 = 1e-5;

/// Down to this level octants come nearest first, and may go to several threads.
const ORDERED_LEVELS: u32 = 2;

/// Below this, the octants of a node are not shared out among threads.
const PARALLEL_POINTS: usize = 1 << 15;

/// The cells of a subtree of up to this many points are tested side by side. Twice or half as many take about as long.
const SMALL_SUBTREE: usize = 160;

/// Limits that only depend on the level of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct LevelLimits {
    pub(super) edge: f32,
    pub(super) sphere_radius: f32,
    /// Up to this distance a cell is divided, whatever was before.
    pub(super) may_stop_beyond_squared: f32,
    /// Between the two others, this decides for cells that were not seen before.
    stop_beyond_squared: f32,
    /// Beyond this distance a cell is not divided, whatever was before.
    pub(super) must_stop_beyond_squared: f32,
}

pub(super) struct Traversal<'a> {
    pub(super) simd: Level,
    pub(super) tree: &'a Octree,
    pub(super) view: SelectView,
    pub(super) levels: [LevelLimits; LEVELS as usize + 1],
    slack: f32,
    pub(super) back_faces: Option<&'a LodSurfels>,
    before: Option<CutByPoints<'a>>,
}

/// A node to be tested.
struct Visit {
    node: NodeRange,
    cell: [u32; 3],
    /// The planes that not all of its parent is inside of.
    planes: PlaneMask,
}

impl Traversal<'_> {
    /// Recursion is bounded by the 21 levels.
    fn visit(&self, Visit { node, cell, planes }: Visit, cut: &mut Cut) {
        cut.tested.nodes += 1;
        let limits = self.levels[node.level as usize];
        let [x, y, z] = cell.map(|coordinate| coordinate as f32);
        let center = self.tree.cube.min.as_vec3() + (Vec3::new(x, y, z) + 0.5) * limits.edge;
        let Some(planes) = self.planes_left(center, limits.sphere_radius, planes) else {
            return;
        };
        if let Some(surfels) = self.back_faces
            && surfels.all_face_away(&node, self.view.eye, center, limits.sphere_radius)
        {
            return;
        }
        let distance = (center - self.view.eye).abs();
        if self.tree.is_leaf(node.level, &node.points) || self.stops(&node, distance) {
            cut.tested.emitted += 1;
            cut.emit(node);
            return;
        }
        let is_ordered = node.level < ORDERED_LEVELS;
        let cone_level = self.back_faces.and_then(|surfels| surfels.cone_level_below(node.level));
        if planes == 0
            && !is_ordered
            && cone_level.is_none()
            && let Some(level) = self.uniform_cut(&node, distance)
        {
            let points = node.points;
            cut.emit(NodeRange { level, points });
            return;
        }
        if !is_ordered
            && node.points.len() <= SMALL_SUBTREE
            && let Some(depth) = self.tree.leaves.only_level(&node.points)
        {
            let first_stop = self.first_stop(&node, distance, depth);
            let subtree = Subtree {
                planes,
                first_stop,
                depth,
            };
            let level = cone_level.unwrap_or(first_stop).min(first_stop);
            self.sift(level, node.points, &subtree, cut);
            return;
        }
        let children = self.tree.points.children(&node).map(|(octant, node)| Visit {
            node,
            cell: std::array::from_fn(|axis| 2 * cell[axis] + (octant >> axis & 1)),
            planes,
        });
        if is_ordered {
            self.visit_nearest_first(children.collect(), center, node.points.len(), cut);
        } else {
            children.for_each(|child| self.visit(child, cut));
        }
    }

    /// Visits the children of a node with this centre.
    fn visit_nearest_first(&self, mut children: Vec<Visit>, center: Vec3, point_count: usize, cut: &mut Cut) {
        // An octant can only be occluded by octants that differ from the eye's along a proper subset of its axes: they
        // have smaller numbers when the octant of the eye is number 0.
        let of_eye = |visit: &Visit| {
            (0..3).fold(0, |number, axis| {
                let is_upper = visit.cell[axis] & 1 == 1;
                number | u32::from(is_upper != (self.view.eye[axis] > center[axis])) << axis
            })
        };
        children.sort_unstable_by_key(of_eye);
        if point_count < PARALLEL_POINTS {
            for child in children {
                self.visit(child, cut);
            }
            return;
        }
        let cuts: Vec<Cut> = children
            .into_par_iter()
            .map(|child| {
                let mut cut = Cut::default();
                self.visit(child, &mut cut);
                cut
            })
            .collect();
        for part in cuts {
            cut.append(part);
        }
    }

    /// The planes that the sphere is not entirely inside of; `None` when it is outside of one.
    fn planes_left(&self, center: Vec3, radius: f32, planes: PlaneMask) -> Option<PlaneMask> {
        let mut left = planes;
        let mut untested = planes;
        while untested != 0 {
            let index = untested.trailing_zeros();
            untested &= untested - 1;
            let plane = self.view.frustum.planes()[index as usize];
            let distance = plane.truncate().dot(center) + plane.w;
            if distance < -radius {
                return None;
            }
            if distance >= radius {
                left &= !(1 << index);
            }
        }
        Some(left)
    }

    /// Returns true if a node that is not a leaf is not divided. Its centre is `distance` from the eye along each axis.
    pub(super) fn stops(&self, node: &NodeRange, distance: Vec3) -> bool {
        let limits = &self.levels[node.level as usize];
        let nearest_squared = nearest_squared(distance, 0.5 * limits.edge);
        if nearest_squared <= limits.may_stop_beyond_squared {
            return false;
        }
        if nearest_squared > limits.must_stop_beyond_squared {
            return true;
        }
        let before = self.before.as_ref();
        match before.and_then(|before| before.at(node.points.start)) {
            Some(before) => before.level <= node.level,
            None => nearest_squared > limits.stop_beyond_squared,
        }
    }

    /// Returns the one level below `node` on which all descendants stop; `None` if there may be several. Its
    /// centre is `distance` from the eye along each axis.
    fn uniform_cut(&self, node: &NodeRange, distance: Vec3) -> Option<u32> {
        let half_edge = 0.5 * self.levels[node.level as usize].edge;
        let farthest_squared = self.farthest_squared(node, distance);
        let nearest_squared = nearest_squared(distance, half_edge + self.slack) * (1.0 - MARGIN);
        let limits = |level: u32| &self.levels[level as usize];
        // If all were on this level, would they stop there? None above it stops, and all at it do.
        let before = self.before.as_ref();
        let before = before.and_then(|before| before.at(node.points.start));
        if let Some(before) = before
            && before.level > node.level
            && before.points.end >= node.points.end
            && farthest_squared <= limits(before.level - 1).must_stop_beyond_squared
            && (self.is_leaf_level(before.level, &node.points)
                || nearest_squared > limits(before.level).may_stop_beyond_squared)
        {
            return Some(before.level);
        }
        let depth = self.tree.leaves.only_level(&node.points)?;
        let first_stop = self.first_stop(node, distance, depth);
        let all_stop = first_stop == depth || nearest_squared > limits(first_stop).must_stop_beyond_squared;
        all_stop.then_some(first_stop)
    }

    /// The first level below `node` on which a descendant may stop, wherever in it; `depth` is the level of the leaves.
    fn first_stop(&self, node: &NodeRange, distance: Vec3, depth: u32) -> u32 {
        let farthest_squared = self.farthest_squared(node, distance);
        (node.level + 1..depth)
            .find(|&below| farthest_squared > self.levels[below as usize].may_stop_beyond_squared)
            .unwrap_or(depth)
    }

    /// Returns an upper bound of the squared distance from the eye to anything in a cell whose centre is `distance`
    /// away along each axis.
    fn farthest_squared(&self, node: &NodeRange, distance: Vec3) -> f32 {
        let half_edge = 0.5 * self.levels[node.level as usize].edge;
        (distance + half_edge + self.slack).length_squared() * (1.0 + MARGIN)
    }

    /// Returns true if all nodes of a level that have any of the given points are leaves.
    fn is_leaf_level(&self, level: u32, points: &Range<usize>) -> bool {
        self.tree.leaves.only_level(points) == Some(level)
    }
}

/// Returns the squared distance from the eye to the nearest point of a cell whose centre is `distance` away along each
/// axis.
fn nearest_squared(distance: Vec3, half_edge: f32) -> f32 {
    // The nearest point, not the centre, so a projected size is never underestimated.
    (distance - half_edge).max(Vec3::ZERO).length_squared()
}
