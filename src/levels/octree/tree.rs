//! The tree itself: points in Morton order and where its leaves are.

use super::gap::Gap;
use super::sorted_points::SortedPoints;
use super::stop::Leaves;
use crate::levels::cut::NodeRange;
use crate::math::Cube;
use std::ops::Range;
use std::sync::Arc;

/// A sparse voxel octree.
///
/// Nodes of a level come in Morton order, siblings by octant (x is bit 0, y bit 1, z bit 2). The points of a node are a
/// contiguous range in Morton order, and all else about it follows from them.
///
/// Clones share everything; so do trees of the same points that end on different levels ([`Octree::with_stop`]).
#[derive(Debug, Clone)]
pub struct Octree {
    pub(super) cube: Cube,
    pub(super) points: Arc<SortedPoints>,
    pub(super) leaves: Leaves,
    /// Nodes of each level from the root's to the deepest; empty without points.
    pub(super) level_counts: Vec<usize>,
    pub(super) leaf_count: usize,
    /// Cells that are drawn between leaves by the spacing of points.
    pub(super) gaps: Arc<[Gap]>,
}

impl PartialEq for Octree {
    /// Trees of the same points are equal when they have the same nodes, whatever was requested.
    fn eq(&self, other: &Self) -> bool {
        self.cube == other.cube
            && self.points == other.points
            && self.level_counts == other.level_counts
            && self.leaf_count == other.leaf_count
            && self.has_same_leaves(other)
    }
}

impl Octree {
    /// Level of the deepest leaves; 0 when the root is the only node, and for no points.
    pub fn depth(&self) -> u32 {
        self.level_counts.len().saturating_sub(1) as u32
    }

    /// Nodes on all levels, leaves included.
    pub fn node_count(&self) -> usize {
        self.level_counts.iter().sum()
    }

    /// Nodes with children: *nodes* in the paper's Table III.
    pub fn internal_count(&self) -> usize {
        // Internal nodes only: this is the only way the rows of Table III add up.
        self.node_count() - self.leaf_count
    }

    /// Nodes without children.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count
    }

    /// Number of points it was built from.
    pub fn point_count(&self) -> usize {
        self.points.cells.len()
    }

    /// Fraction of the points without a leaf of their own, `1 − leaves/n`; 0 without points. Where all leaves are on
    /// level h this is the paper's `1 − oct(h)/n`.
    ///
    /// It can exceed the δ asked for when points share a cell even at level 21: n points that all coincide are one
    /// occupied cell and a loss of `1 − 1/n`.
    pub fn loss(&self) -> f32 {
        if self.point_count() == 0 {
            return 0.0;
        }
        (1.0 - self.leaf_count as f64 / self.point_count() as f64) as f32
    }

    /// The cube of the root.
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// Nodes of each level, from the root's to the deepest; empty without points.
    pub fn level_counts(&self) -> &[usize] {
        &self.level_counts
    }

    /// Maximum number of bytes held in memory, voxels that may be cached and data shared with other trees included.
    pub fn byte_size(&self) -> usize {
        size_of::<Self>()
            + self.points.byte_size()
            + size_of_val(self.level_counts.as_slice())
            + size_of_val(&*self.gaps)
    }

    /// Returns true if trees of the same points that have the same number of nodes have the same leaves. Of two that
    /// were divided by a rule for all nodes, one is the other with some nodes divided further, and so the same.
    fn has_same_leaves(&self, other: &Self) -> bool {
        let are_in_runs = |tree: &Self| matches!(tree.leaves, Leaves::InRuns(_));
        self.leaves == other.leaves || !(are_in_runs(self) || are_in_runs(other)) || self.masks() == other.masks()
    }

    /// The root, which has all points.
    pub(super) fn root(&self) -> NodeRange {
        NodeRange {
            level: 0,
            points: 0..self.point_count(),
        }
    }

    /// Returns true if the node of `level` with these points is a leaf, i.e. not divided.
    #[inline]
    pub(super) fn is_leaf(&self, level: u32, points: &Range<usize>) -> bool {
        self.points.is_leaf(&self.leaves, level, points)
    }
}
