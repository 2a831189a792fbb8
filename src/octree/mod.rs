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
mod select;
mod stop;
#[cfg(test)]
mod tests;
mod voxels;

pub use byte_code::OctreeError;
pub use select::{SelectStats, SelectView};
pub use stop::StopCriterion;

use crate::math::Cube;
use voxels::ColorSum;

/// A sparse voxel octree with all leaves at one level.
///
/// Nodes are numbered breadth-first, siblings by octant (x is bit 0, y bit 1, z bit 2), so that every level, the children
/// of a node, and the descendants of a node at any one level are each a contiguous range. The points of a node are a
/// contiguous range in Morton order, and all that is drawn for it follows from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Octree {
    cube: Cube,
    /// Codes of the points, ascending.
    codes: Vec<u64>,
    /// Colours summed over the points before each, and over all of them.
    colors_before: Vec<ColorSum>,
    /// Occupied cells of levels 0 to the depth; empty without points.
    level_counts: Vec<usize>,
    /// First point of each node, and one 0. The next node's is where its points end; 0 ends a level.
    first_point: Vec<u32>,
    /// Which octants of each internal node are occupied.
    masks: Vec<u8>,
    /// First child of each internal node, and the number of nodes at the end: `first_child[i]..first_child[i + 1]` are
    /// the children of node `i`.
    first_child: Vec<u32>,
}

impl Octree {
    /// Level of the leaves; 0 when the root is the only node, and for no points.
    pub fn depth(&self) -> u32 {
        self.level_counts.len().saturating_sub(1) as u32
    }

    /// Nodes on all levels, leaves included.
    pub fn node_count(&self) -> usize {
        self.first_point.len() - 1
    }

    /// Nodes with children: *nodes* in the paper's Table III.
    pub fn internal_count(&self) -> usize {
        self.masks.len()
    }

    /// Occupied cells at the deepest level.
    pub fn leaf_count(&self) -> usize {
        self.level_counts.last().copied().unwrap_or(0)
    }

    /// Number of points it was built from.
    pub fn point_count(&self) -> usize {
        self.codes.len()
    }

    /// Share of the points that have no leaf of their own, `1 − oct(h)/n` at the deepest level h; 0 without points.
    ///
    /// It can exceed the δ asked for when points share a cell even at level 21: n points that all coincide are one
    /// occupied cell and a loss of `1 − 1/n`.
    pub fn loss(&self) -> f32 {
        if self.codes.is_empty() {
            return 0.0;
        }
        (1.0 - self.leaf_count() as f64 / self.point_count() as f64) as f32
    }

    /// The cube that the root stands for.
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// Occupied cells of each level, from the root's to the leaves'; empty without points.
    pub fn level_counts(&self) -> &[usize] {
        &self.level_counts
    }

    /// One byte for each internal node, breadth-first; bit `o` is set when octant `o` is occupied. Together with the depth
    /// it is the whole shape of the tree (000 §VI-A): see [`Octree::cells_from_masks`].
    pub fn masks(&self) -> &[u8] {
        &self.masks
    }

    /// Bytes held in memory.
    pub fn byte_size(&self) -> usize {
        size_of::<Self>()
            + size_of_val(self.level_counts.as_slice())
            + size_of_val(self.masks.as_slice())
            + size_of_val(self.first_child.as_slice())
            + size_of_val(self.first_point.as_slice())
            + size_of_val(self.codes.as_slice())
            + size_of_val(self.colors_before.as_slice())
    }
}
