//! Traversal: which voxels stand for the cloud in one view (paper 000 §VI-B).
//!
//! How it works: from the root down, a node is dropped when its bounding sphere (the diagonal of the cell is its diameter)
//! is outside the frustum, and emitted when it is a leaf or its edge covers less than the LOD threshold on screen.
//! Two things keep most nodes from being looked at:
//!
//! - *Inside mask.* A plane that a sphere is entirely inside of is not tested again below that node.
//! - *Uniform cuts.* Once no plane is left, the nearest and the farthest distance of a cell bound where all of its
//!   descendants would stop. When both name the same level, the answer for the whole subtree is all of its nodes on that
//!   level: a contiguous range of the breadth-first array, found by following first children down and emitted at
//!   once. Only cells that straddle the border of the frustum or of two levels of detail are descended into.
//!
//! When it wins: always; at worst (every cell straddles something) it visits what a plain traversal does.
//!
//! Distances are to the nearest point of a cell, so a projected edge is never underestimated, and an eye inside a cell
//! always descends. The output depends on tree and view alone, and a reused `Vec` is not reallocated.

use super::{
    Octree,
    voxels::{NodeRange, count_nodes},
};
use crate::{
    cloud::VoxelRecord,
    math::{Frustum, morton::LEVELS},
};
use glam::Vec3;
use std::ops::Range;

/// What a view needs of the octree. Positions are in the space of the frame (relative to the sequence origin).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectView {
    /// Cells outside are dropped.
    pub frustum: Frustum,
    /// Where distances are measured from.
    pub eye: Vec3,
    /// A length `s` at distance `d` covers about `s * pixels_per_unit_at_1 / d` pixels.
    pub pixels_per_unit_at_1: f32,
    /// A cell whose edge covers less is not divided further; 0 (or less) always descends to the leaves.
    pub lod_px: f32,
    /// Cells of this level are not divided either; [`SelectView::ALL_LEVELS`] divides down to the leaves.
    pub deepest_level: u32,
}

impl SelectView {
    /// No limit to the level.
    pub const ALL_LEVELS: u32 = LEVELS;
}

/// What a traversal did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SelectStats {
    /// Nodes that were tested or emitted.
    pub visited_nodes: usize,
    /// Voxels written.
    pub emitted: usize,
}

impl Octree {
    /// Replaces the contents of `out` by the voxels that stand for the cloud in `view`.
    ///
    /// They cover every leaf that can be seen, none twice: an emitted node stands for all leaves under it.
    pub fn select(&self, view: &SelectView, out: &mut Vec<VoxelRecord>) -> SelectStats {
        let traversal = self.traverse(view);
        self.write_voxels(&traversal.emitted, out);
        SelectStats {
            visited_nodes: traversal.visited_nodes,
            emitted: out.len(),
        }
    }

    /// Replaces the contents of `out` by at most `most_voxels` voxels: those of the smallest LOD threshold from `view.lod_px`
    /// up, in steps of a 32nd of an octave (2 %), that draws no more. Returns that threshold in pixels too.
    ///
    /// Cells that the eye is in are always divided, so that around it some more are drawn than a very small number.
    ///
    /// How it works: a higher threshold never draws more, so thresholds are bisected. Counting is cheap beside writing:
    /// subtrees that end on one level are counted by the range of their nodes.
    pub fn select_at_most(
        &self,
        most_voxels: usize,
        view: &SelectView,
        out: &mut Vec<VoxelRecord>,
    ) -> (SelectStats, f32) {
        let mut visited_nodes = 0;
        let mut traverse_at = |step: u32| {
            let lod_px = threshold_px(view.lod_px, step);
            let traversal = self.traverse(&SelectView { lod_px, ..*view });
            visited_nodes += traversal.visited_nodes;
            (traversal.emitted, lod_px)
        };
        let mut best = traverse_at(0);
        if count_nodes(&best.0) > most_voxels {
            let (mut too_fine, mut coarse_enough) = (0, THRESHOLD_STEPS);
            best = traverse_at(coarse_enough);
            while coarse_enough - too_fine > 1 {
                let step = too_fine.midpoint(coarse_enough);
                let tried = traverse_at(step);
                if count_nodes(&tried.0) > most_voxels {
                    too_fine = step;
                } else {
                    coarse_enough = step;
                    best = tried;
                }
            }
        }
        let (emitted, lod_px) = best;
        self.write_voxels(&emitted, out);
        let stats = SelectStats {
            visited_nodes,
            emitted: out.len(),
        };
        (stats, lod_px)
    }

    fn traverse(&self, view: &SelectView) -> Traversal<'_> {
        let mut traversal = Traversal {
            tree: self,
            view: *view,
            levels: self.level_limits(view),
            slack: self.distance_slack(view.eye),
            emitted: Vec::new(),
            visited_nodes: 0,
        };
        if !self.levels.is_empty() {
            traversal.visit(0, 0, [0; 3], ALL_PLANES);
        }
        traversal
    }

    fn level_limits(&self, view: &SelectView) -> [LevelLimits; LEVELS as usize + 1] {
        std::array::from_fn(|level| {
            let edge = self.cube.cell_edge(level as u32);
            LevelLimits {
                half_edge: 0.5 * edge,
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

/// Thresholds that [`Octree::select_at_most`] chooses from: up to 16,384 pixels.
const THRESHOLD_STEPS: u32 = STEPS_PER_OCTAVE * 16;
const STEPS_PER_OCTAVE: u32 = 32;

/// The threshold some steps above the lowest, which is taken as it is.
fn threshold_px(lowest_px: f32, step: u32) -> f32 {
    match step {
        0 => lowest_px,
        _ => lowest_px.max(0.25) * (step as f32 / STEPS_PER_OCTAVE as f32).exp2(),
    }
}

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

/// What only depends on the level of a cell.
#[derive(Debug, Clone, Copy)]
struct LevelLimits {
    half_edge: f32,
    sphere_radius: f32,
    stop_beyond_squared: f32,
}

struct Traversal<'a> {
    tree: &'a Octree,
    view: SelectView,
    levels: [LevelLimits; LEVELS as usize + 1],
    slack: f32,
    emitted: Vec<NodeRange>,
    visited_nodes: usize,
}

impl Traversal<'_> {
    /// Recursion is bounded by the 21 levels.
    fn visit(&mut self, node: usize, level: usize, cell: [u32; 3], planes: PlaneMask) {
        self.visited_nodes += 1;
        let center = self.tree.cube.cell_center(level as u32, cell);
        let limits = self.levels[level];
        let Some(planes) = self.planes_left(center, limits.sphere_radius, planes) else {
            return;
        };
        let distance = (center - self.view.eye).abs();
        let children = self.tree.levels[level].children.as_deref();
        let mut octants = children.map_or(0, |children| children.mask(node));
        if octants == 0 || nearest_squared(distance, limits.half_edge) > limits.stop_beyond_squared
        {
            self.emit(level, node..node + 1);
        } else if planes == 0
            && self.tree.is_even
            && let Some(cut) = self.uniform_cut(distance, level)
        {
            self.emit_level_below(node, level, cut);
        } else {
            let mut child = children.map_or(0, |children| children.first_child(node));
            while octants != 0 {
                let octant = octants.trailing_zeros();
                let cell_of_child =
                    std::array::from_fn(|axis| 2 * cell[axis] + (octant >> axis & 1));
                self.visit(child, level + 1, cell_of_child, planes);
                octants &= octants - 1;
                child += 1;
            }
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

    /// The one level below `level` on which all descendants stop of a cell whose middle is `distance` from the eye along
    /// each axis; `None` when there may be several.
    fn uniform_cut(&self, distance: Vec3, level: usize) -> Option<usize> {
        let half_edge = self.levels[level].half_edge;
        let farthest_squared =
            (distance + half_edge + self.slack).length_squared() * (1.0 + MARGIN);
        let nearest_squared = nearest_squared(distance, half_edge + self.slack) * (1.0 - MARGIN);
        let depth = self.tree.depth() as usize;
        // No cell above this level stops, wherever in this cell it is.
        let first_stop = (level + 1..depth)
            .find(|&below| farthest_squared > self.levels[below].stop_beyond_squared)
            .unwrap_or(depth);
        let all_stop =
            first_stop == depth || nearest_squared > self.levels[first_stop].stop_beyond_squared;
        all_stop.then_some(first_stop)
    }

    /// Emits all descendants of `node` on level `cut`.
    fn emit_level_below(&mut self, node: usize, level: usize, cut: usize) {
        let mut range = [node, node + 1];
        for level in &self.tree.levels[level..cut] {
            if let Some(children) = &level.children {
                range = range.map(|node| children.first_child(node));
            }
        }
        self.visited_nodes += range[1] - range[0];
        self.emit(cut, range[0]..range[1]);
    }

    /// Emits nodes of `level`; those that follow upon the last emitted ones join them.
    fn emit(&mut self, level: usize, nodes: Range<usize>) {
        match self.emitted.last_mut() {
            Some(last) if last.level == level as u32 && last.nodes.end == nodes.start => {
                last.nodes.end = nodes.end;
            }
            _ => self.emitted.push(NodeRange {
                level: level as u32,
                nodes,
            }),
        }
    }
}

/// Square of the distance from the eye to the nearest point of a cell whose middle is `distance` away along each axis.
fn nearest_squared(distance: Vec3, half_edge: f32) -> f32 {
    (distance - half_edge).max(Vec3::ZERO).length_squared()
}
