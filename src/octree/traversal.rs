//! Traversal: which nodes stand for the cloud in one view (paper 000 §VI-B).
//!
//! How it works: from the root down, a node is dropped when its bounding sphere (the diagonal of the cell is its diameter)
//! is outside the frustum, and emitted when it is a leaf or its edge covers less than the LOD threshold on screen.
//! Three things keep most nodes from being looked at, and time short:
//!
//! - *Inside mask.* A plane that a sphere is entirely inside of is not tested again below that node.
//! - *Uniform cuts.* Once no plane is left, the nearest and the farthest distance of a cell bound where all of its
//!   descendants would stop. When both name the same level, the answer for the whole subtree is all of its nodes on that
//!   level: the points of the cell, emitted at once. Only cells that straddle the border of the frustum or of two levels of
//!   detail are descended into.
//! - *Subtrees in parallel.* The octants of the root, and theirs, are gone through by as many threads as there are.
//!
//! The eight octants of the root, and those below, come nearest first, so that what is drawn early hides what follows.
//!
//! When it wins: always; at worst (every cell straddles something) it visits what a plain traversal does.
//!
//! Distances are to the nearest point of a cell, so a projected edge is never underestimated, and an eye inside a cell
//! always descends. The output depends on tree and view alone.

use super::{NodeRange, Octree, select::SelectView, stop::Leaves};
use crate::math::{Frustum, morton::LEVELS};
use glam::Vec3;
use rayon::prelude::*;

/// The nodes that stand for the cloud in a view.
#[derive(Debug, Default)]
pub(super) struct Cut {
    /// Each level's nodes in Morton order within every octant of the root's octants, those nearest first.
    pub(super) ranges: Vec<NodeRange>,
    /// Nodes that were tested.
    tested: usize,
    /// Nodes emitted that were tested.
    tested_and_emitted: usize,
}

impl Cut {
    /// Nodes that were tested or emitted, if so many are emitted.
    pub(super) fn visited_nodes(&self, emitted: usize) -> usize {
        self.tested + emitted - self.tested_and_emitted
    }

    /// Emits nodes; those that follow upon the last emitted ones join them.
    fn emit(&mut self, nodes: NodeRange) {
        match self.ranges.last_mut() {
            Some(last) if last.level == nodes.level && last.points.end == nodes.points.start => {
                last.points.end = nodes.points.end;
            }
            _ => self.ranges.push(nodes),
        }
    }

    fn append(&mut self, other: Self) {
        let mut ranges = other.ranges.into_iter();
        if let Some(first) = ranges.next() {
            self.emit(first);
        }
        self.ranges.extend(ranges);
        self.tested += other.tested;
        self.tested_and_emitted += other.tested_and_emitted;
    }
}

impl Octree {
    /// The nodes that stand for the cloud in `view`: they cover every leaf that can be seen, none twice.
    pub(super) fn traverse(&self, view: &SelectView) -> Cut {
        let mut cut = Cut::default();
        if self.point_count() > 0 {
            let traversal = Traversal {
                tree: self,
                view: *view,
                levels: self.level_limits(view),
                slack: self.distance_slack(view.eye),
            };
            let root = Visit {
                node: NodeRange {
                    level: 0,
                    points: self.all_points(),
                },
                cell: [0; 3],
                planes: ALL_PLANES,
            };
            traversal.visit(root, &mut cut);
        }
        cut
    }

    fn level_limits(&self, view: &SelectView) -> [LevelLimits; LEVELS as usize + 1] {
        std::array::from_fn(|level| {
            let edge = self.cube.cell_edge(level as u32);
            LevelLimits {
                edge,
                sphere_radius: 0.5 * 3f32.sqrt() * edge,
                stop_beyond_squared: if level as u32 >= view.deepest_level {
                    ALWAYS
                } else {
                    stop_distance_squared(edge, view)
                },
            }
        })
    }

    /// A bound for the rounding of distances between `eye` and anything in the cube.
    fn distance_slack(&self, eye: Vec3) -> f32 {
        let reach = self.cube.min.abs().max_element() + self.cube.edge + eye.abs().max_element();
        4.0 * f32::EPSILON * reach
    }
}

/// Every squared distance is beyond it.
const ALWAYS: f32 = -1.0;

/// A cell with this edge is not divided when the square of its distance is above this; infinite when it always is.
fn stop_distance_squared(edge: f32, view: &SelectView) -> f32 {
    let lod_px = f64::from(view.lod_px);
    if lod_px > 0.0 {
        (f64::from(edge) * f64::from(view.pixels_per_unit_at_1) / lod_px).powi(2) as f32
    } else {
        f32::INFINITY
    }
}

/// One bit for each frustum plane that still has to be tested.
type PlaneMask = u8;
const ALL_PLANES: PlaneMask = (1 << Frustum::PLANES) - 1;

/// Relative margin of squared distances beyond which rounding cannot change a decision.
const MARGIN: f32 = 1e-5;

/// Down to this level octants come nearest first, and may go to several threads.
const ORDERED_LEVELS: u32 = 2;

/// Below this, the octants of a node are not shared out among threads.
const PARALLEL_POINTS: usize = 1 << 15;

/// What only depends on the level of a cell.
#[derive(Debug, Clone, Copy)]
struct LevelLimits {
    edge: f32,
    sphere_radius: f32,
    stop_beyond_squared: f32,
}

struct Traversal<'a> {
    tree: &'a Octree,
    view: SelectView,
    levels: [LevelLimits; LEVELS as usize + 1],
    slack: f32,
}

/// A node to be looked at.
struct Visit {
    node: NodeRange,
    cell: [u32; 3],
    /// The planes that not all of its parent is inside of.
    planes: PlaneMask,
}

impl Traversal<'_> {
    /// Recursion is bounded by the 21 levels.
    fn visit(&self, Visit { node, cell, planes }: Visit, cut: &mut Cut) {
        cut.tested += 1;
        let limits = self.levels[node.level as usize];
        let [x, y, z] = cell.map(|coordinate| coordinate as f32);
        let center = self.tree.cube.min + (Vec3::new(x, y, z) + 0.5) * limits.edge;
        let Some(planes) = self.planes_left(center, limits.sphere_radius, planes) else {
            return;
        };
        let distance = (center - self.view.eye).abs();
        if self.tree.is_leaf(node.level, &node.points)
            || nearest_squared(distance, 0.5 * limits.edge) > limits.stop_beyond_squared
        {
            cut.tested_and_emitted += 1;
            cut.emit(node);
            return;
        }
        let is_ordered = node.level < ORDERED_LEVELS;
        if planes == 0
            && !is_ordered
            && let Leaves::OnLevel(depth) = self.tree.leaves
            && let Some(level) = self.uniform_cut(distance, node.level, depth)
        {
            let points = node.points;
            cut.emit(NodeRange { level, points });
            return;
        }
        let children = self
            .tree
            .points
            .children(&node)
            .map(|(octant, node)| Visit {
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

    /// Visits the children of a node with this middle.
    fn visit_nearest_first(
        &self,
        mut children: Vec<Visit>,
        center: Vec3,
        point_count: usize,
        cut: &mut Cut,
    ) {
        // An octant can only be hidden by those that differ from the eye's along fewer axes, and along no others: they have
        // smaller numbers when the octant of the eye is number 0.
        let of_eye = |visit: &Visit| {
            (0..3).fold(0, |number, axis| {
                let is_upper = visit.cell[axis] & 1 == 1;
                number | u32::from(is_upper != (self.view.eye[axis] > center[axis])) << axis
            })
        };
        children.sort_unstable_by_key(of_eye);
        if point_count < PARALLEL_POINTS {
            children
                .into_iter()
                .for_each(|child| self.visit(child, cut));
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
        cuts.into_iter().for_each(|part| cut.append(part));
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

    /// The one level below `level` on which all descendants stop of a cell whose middle is `distance` from the eye along
    /// each axis; `None` when there may be several. All leaves are on level `depth`.
    fn uniform_cut(&self, distance: Vec3, level: u32, depth: u32) -> Option<u32> {
        let half_edge = 0.5 * self.levels[level as usize].edge;
        let farthest_squared =
            (distance + half_edge + self.slack).length_squared() * (1.0 + MARGIN);
        let nearest_squared = nearest_squared(distance, half_edge + self.slack) * (1.0 - MARGIN);
        let stop_beyond_squared = |level: u32| self.levels[level as usize].stop_beyond_squared;
        // No cell above this level stops, wherever in this cell it is.
        let first_stop = (level + 1..depth)
            .find(|&below| farthest_squared > stop_beyond_squared(below))
            .unwrap_or(depth);
        let all_stop = first_stop == depth || nearest_squared > stop_beyond_squared(first_stop);
        all_stop.then_some(first_stop)
    }
}

/// Square of the distance from the eye to the nearest point of a cell whose middle is `distance` away along each axis.
fn nearest_squared(distance: Vec3, half_edge: f32) -> f32 {
    (distance - half_edge).max(Vec3::ZERO).length_squared()
}
