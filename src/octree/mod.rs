//! The sparse voxel octree of paper 000 §VI: built from sorted Morton codes, stored breadth-first, traversed into the set
//! of visible voxels.
//!
//! # Counting nodes
//! The column *nodes* of the paper's Table III counts internal nodes only: at δ = 50 % it is smaller than the column
//! *leaves*, and from one depth to the next it grows by exactly the leaves of the shallower tree (baseball: 47,638 + 59,523 =
//! 107,161). That is [`Octree::internal_count`], and the number of bytes of [`Octree::masks`]; [`Octree::node_count`]
//! adds the leaves.

mod build;
mod byte_code;
mod children;
mod select;
mod sorted_points;
mod stop;
pub mod stored;
#[cfg(test)]
mod tests;
mod uneven;
mod voxels;

pub use byte_code::OctreeError;
pub use select::{SelectStats, SelectView};
pub use stop::StopCriterion;
pub use stored::{StoredOctree, StoredOctreeError};

use crate::math::Cube;
use children::Children;
use sorted_points::SortedPoints;
use std::sync::Arc;

/// A sparse voxel octree.
///
/// The nodes of a level are numbered in Morton order, siblings by octant (x is bit 0, y bit 1, z bit 2), so that the children
/// of a node, and its descendants on any one level, are each a contiguous range. The points of a node are a contiguous
/// range in Morton order, and all that is drawn for it follows from them.
///
/// Clones share everything; so do trees that differ in their depth ([`Octree::with_stop`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Octree {
    cube: Cube,
    points: Arc<SortedPoints>,
    /// From the root's to the deepest; empty without points.
    levels: Vec<NodeLevel>,
    leaf_count: usize,
    /// True when all leaves are on the deepest level.
    is_even: bool,
}

/// The nodes of one level.
#[derive(Debug, Clone, PartialEq)]
struct NodeLevel {
    /// First point of each node, and at the end the number of points. Where all nodes above are divided, the points of a
    /// node end where the next one's begin.
    first_point: Arc<Vec<u32>>,
    /// Where the points of each node end, if some node above is not divided.
    point_end: Option<Arc<Vec<u32>>>,
    /// `None` on the deepest level.
    children: Option<Arc<Children>>,
}

impl NodeLevel {
    fn node_count(&self) -> usize {
        self.first_point.len() - 1
    }

    /// The same nodes as leaves.
    fn undivided(&self) -> Self {
        Self {
            children: None,
            ..self.clone()
        }
    }

    /// The octants of a node that are occupied; 0 for a leaf.
    fn mask(&self, node: usize) -> u8 {
        self.children
            .as_ref()
            .map_or(0, |children| children.mask(node))
    }

    fn byte_size(&self) -> usize {
        let children = self
            .children
            .as_ref()
            .map_or(0, |children| children.byte_size());
        let ends = self.point_end.as_ref();
        size_of_val(self.first_point.as_slice())
            + ends.map_or(0, |ends| size_of_val(ends.as_slice()))
            + children
    }
}

impl Octree {
    /// Level of the deepest leaves; 0 when the root is the only node, and for no points.
    pub fn depth(&self) -> u32 {
        self.levels.len().saturating_sub(1) as u32
    }

    /// Nodes on all levels, leaves included.
    pub fn node_count(&self) -> usize {
        self.levels.iter().map(NodeLevel::node_count).sum()
    }

    /// Nodes with children: *nodes* in the paper's Table III.
    pub fn internal_count(&self) -> usize {
        self.node_count() - self.leaf_count
    }

    /// Nodes without children.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count
    }

    /// Number of points it was built from.
    pub fn point_count(&self) -> usize {
        self.points.codes.len()
    }

    /// Share of the points that have no leaf of their own, `1 − leaves/n`; 0 without points. Where all leaves are on level h
    /// this is the paper's `1 − oct(h)/n`.
    ///
    /// It can exceed the δ asked for when points share a cell even at level 21: n points that all coincide are one
    /// occupied cell and a loss of `1 − 1/n`.
    pub fn loss(&self) -> f32 {
        if self.levels.is_empty() {
            return 0.0;
        }
        (1.0 - self.leaf_count as f64 / self.point_count() as f64) as f32
    }

    /// The cube that the root stands for.
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// Nodes of each level, from the root's to the deepest; empty without points.
    pub fn level_counts(&self) -> Vec<usize> {
        self.levels.iter().map(NodeLevel::node_count).collect()
    }

    /// One byte for each node above the deepest level, breadth-first; bit `o` is set when octant `o` is occupied, none is for a
    /// leaf. Together with the depth it is the whole shape of the tree (000 §VI-A): see [`Octree::cells_from_masks`].
    pub fn masks(&self) -> Vec<u8> {
        let children = self
            .levels
            .iter()
            .filter_map(|level| level.children.as_ref());
        children
            .flat_map(|children| children.masks().iter().copied())
            .collect()
    }

    /// Bytes held in memory, those that are shared with other trees included.
    pub fn byte_size(&self) -> usize {
        size_of::<Self>()
            + self.points.byte_size()
            + self.levels.iter().map(NodeLevel::byte_size).sum::<usize>()
    }
}
