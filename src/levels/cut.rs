//! Cuts: the nodes that represent a cloud in a view, and the hints that a traversal may use in addition to the view.

use crate::math::{Frustum, Sphere, morton::LEVELS};
use glam::Vec3;
use std::ops::Range;

/// View parameters for level-of-detail selection. Positions are in the space of the frame (relative to the sequence
/// origin).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectView {
    /// Cells outside are dropped.
    pub frustum: Frustum,
    /// Eye position that distances are measured from.
    pub eye: Vec3,
    /// A length `s` at distance `d` covers about `s * pixels_per_unit_at_1 / d` pixels.
    pub pixels_per_unit_at_1: f32,
    /// A cell that covers less, by [`SelectView::metric`], is not divided further; 0 (or less) always descends to the
    /// leaves.
    pub lod_px: f32,
    /// Metric for the screen coverage of a cell.
    pub metric: LodMetric,
    /// Cells of this level are not divided either; [`SelectView::ALL_LEVELS`] divides down to the leaves.
    pub deepest_level: u32,
}

impl SelectView {
    /// No limit to the level.
    pub const ALL_LEVELS: u32 = LEVELS;
}

/// Metric for the size of a node on the screen, its screen-space error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LodMetric {
    /// By the edge of its cell, in pixels. A sphere counts as the cube that it encloses.
    #[default]
    Edge,
    /// By the area of its disk, `ε = f·A/d²` (Sainz and Pajarola 2004 §4.1), against the square of the LOD threshold in
    /// pixels. A cell's disk is that of its bounding sphere, seen from the front, as cells of most levels have no
    /// normals.
    Area,
}

impl LodMetric {
    /// The edge of a cell at a threshold, pixels.
    pub fn edge_px(self, lod_px: f32) -> f32 {
        match self {
            Self::Edge => lod_px,
            Self::Area => lod_px / ROOT_AREA_OF_EDGE,
        }
    }

    /// The root of the area of a disk at a threshold, pixels.
    pub fn root_area_px(self, lod_px: f32) -> f32 {
        match self {
            Self::Edge => lod_px * ROOT_AREA_OF_EDGE,
            Self::Area => lod_px,
        }
    }
}

/// Root of `A = πr²` where r is half the diagonal of a cube with an edge of 1: √(3π/4).
const ROOT_AREA_OF_EDGE: f32 = 1.534_990_1;

/// Statistics of a traversal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SelectStats {
    /// Nodes that were tested or emitted.
    pub visited_nodes: usize,
    /// Nodes emitted.
    pub emitted: usize,
    /// Number of duplicate nodes among them: those that represent points that another one represents, too.
    pub duplicates: usize,
}

/// Consecutive nodes of one level, by the points under them in the order of the frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct NodeRange {
    pub(super) level: u32,
    pub(super) points: Range<usize>,
}

/// Nodes of a structure that represent the cloud in one view: they cover every leaf that can be seen, none twice.
///
/// Nodes of an octree come in Morton order within every octant of the root's octants, and these nearest first.
#[derive(Debug, Clone, Default)]
pub struct Cut {
    /// Nodes of structures that keep none in memory.
    pub(super) ranges: Vec<NodeRange>,
    /// Nodes of structures that do.
    pub(super) listed: ListedNodes,
    pub(super) tested: Tested,
    pub(super) node_count: usize,
    pub(super) lod_px: f32,
}

/// Nodes by the numbers that their structure gives them.
#[derive(Debug, Clone, Default)]
pub(super) struct ListedNodes {
    pub(super) drawn: Vec<u32>,
    /// The spheres of the drawn nodes, where they are only known on the way from the root.
    pub(super) spheres: Vec<Sphere>,
    /// Those that were divided, for hysteresis.
    pub(super) divided: Vec<u32>,
    /// Number of duplicates: nodes drawn below others that are drawn.
    pub(super) duplicates: usize,
}

impl ListedNodes {
    /// Adds all that another traversal listed.
    pub(super) fn append(&mut self, mut other: Self) {
        self.drawn.append(&mut other.drawn);
        self.spheres.append(&mut other.spheres);
        self.divided.append(&mut other.divided);
        self.duplicates += other.duplicates;
    }

    /// The cut of these nodes, and the number of nodes tested for it.
    pub(super) fn into_cut(self, looked_at: usize, lod_px: f32) -> Cut {
        Cut {
            tested: Tested {
                nodes: looked_at,
                emitted: self.drawn.len(),
            },
            node_count: self.drawn.len(),
            lod_px,
            listed: self,
            ..Cut::default()
        }
    }
}

/// Counts of the nodes that a traversal tested.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tested {
    pub(super) nodes: usize,
    /// Number of tested nodes that were emitted.
    pub(super) emitted: usize,
}

impl Cut {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// The LOD threshold that it was made with, in pixels.
    pub fn lod_px(&self) -> f32 {
        self.lod_px
    }

    /// Returns the traversal statistics of the cut; if one was chosen of several cuts, the nodes visited for all of
    /// them.
    pub fn stats(&self) -> SelectStats {
        SelectStats {
            visited_nodes: self.tested.nodes + self.node_count - self.tested.emitted,
            emitted: self.node_count,
            duplicates: self.listed.duplicates,
        }
    }

    /// Emits nodes; those that follow upon the last emitted ones join them.
    pub(super) fn emit(&mut self, nodes: NodeRange) {
        match self.ranges.last_mut() {
            Some(last) if last.level == nodes.level && last.points.end == nodes.points.start => {
                last.points.end = nodes.points.end;
            }
            _ => self.ranges.push(nodes),
        }
    }

    /// Emits all that another traversal emitted.
    pub(super) fn append(&mut self, other: Self) {
        let mut ranges = other.ranges.into_iter();
        if let Some(first) = ranges.next() {
            self.emit(first);
        }
        self.ranges.extend(ranges);
        self.tested.nodes += other.tested.nodes;
        self.tested.emitted += other.tested.emitted;
    }
}

/// Hints that a traversal may use in addition to the view.
#[derive(Debug, Clone, Copy, Default)]
pub struct CutHints<'a> {
    /// Nodes whose points all face away from the eye may be dropped.
    pub culls_back_faces: bool,
    /// The cut of the previous view, of the same points: near the threshold, divided nodes stay divided, and others
    /// stay whole. Without it a node is divided or not by the threshold alone.
    pub before: Option<&'a Cut>,
}
