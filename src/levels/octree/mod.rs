//! The sparse voxel octree of the 4D media paper §VI: built from sorted Morton codes, traversed into the set of visible
//! voxels.
//!
//! # A tree without nodes in memory
//!
//! The points of any cell of any level are a contiguous range in Morton order. A cell
//! begins with every point that *parts* from the one before it on that level or above; one byte per point, its parting
//! level, thus determines where the nodes of all levels begin and end. So nothing is stored for a node: it is a level
//! and a range of points, its children are found by looking over the bytes of that range (eight in one word, see
//! `octree/cells.rs`), and its record is computed from its points (`voxels.rs`). A tree for another stop
//! criterion is the same points and another number.
//!
//! When it wins: building is little more than sorting, a tree takes 17 bytes per point however deep it is, and a view
//! reads just the bytes of the points that it draws, in order. An explicit tree of nodes took, in comparison, a third
//! of the building time, and twice the memory, for the same speed of traversal.
//!
//! # Counting nodes
//!
//! The column *nodes* of the paper's Table III counts internal nodes only: at δ = 50 % it is smaller
//! than the column *leaves*, and from one depth to the next it grows by exactly the leaves of the shallower tree
//! (baseball: 47,638 + 59,523 = 107,161). That is [`Octree::internal_count`], and the number of bytes of
//! [`Octree::masks`]; [`Octree::node_count`] adds the leaves.

mod build;
mod byte_code;
mod cached_levels;
mod cells;
mod closing;
pub mod coded;
mod color_sums;
mod cut_before;
#[cfg(test)]
mod cut_tests;
mod gap;
#[cfg(test)]
mod gap_tests;
mod gaps;
mod levels;
mod node_surfel;
#[cfg(test)]
mod order_tests;
mod partings;
mod position_error;
mod selectable;
mod small_subtrees;
mod sorted_points;
mod spacing;
#[cfg(test)]
mod spacing_tests;
mod stop;
#[cfg(test)]
mod surfel_tests;
mod surfels;
#[cfg(test)]
mod tests;
mod traversal;
mod tree;
mod voxel_normals;
mod voxels;
mod write;

pub use byte_code::OctreeError;
pub use coded::CodedCloud;
pub use gap::Gap;
pub use levels::VoxelLevels;
pub use node_surfel::NodeSurfel;
pub use stop::StopCriterion;
pub use surfels::LodSurfels;
pub use tree::Octree;
