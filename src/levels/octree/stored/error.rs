//! Why bytes are not a stored octree.

use super::{MAGIC, VERSION};
use crate::levels::octree::OctreeError;
use crate::math::morton::LEVELS;

/// Why bytes are not a stored octree.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoredOctreeError {
    /// Another kind of file.
    #[error("stored octree: it begins with {found:?} instead of {MAGIC:?}")]
    Magic {
        /// Its first bytes.
        found: Vec<u8>,
    },
    /// A layout that this program does not know.
    #[error("stored octree: its layout is version {found}, known is {VERSION}")]
    Version {
        /// The version.
        found: u32,
    },
    /// The bytes are not those that were written.
    #[error("stored octree: its checksum is {found:#010x}, that of its bytes {expected:#010x}")]
    Checksum {
        /// CRC-32 of the bytes that are there.
        expected: u32,
        /// CRC-32 at their end.
        found: u32,
    },
    /// The bytes end within a part.
    #[error("stored octree: {part} take {expected} bytes or more, but {found} are left")]
    Truncated {
        /// What is missing.
        part: &'static str,
        /// Least number of bytes that it takes.
        expected: usize,
        /// Bytes left for it.
        found: usize,
    },
    /// More bytes than the tree has.
    #[error("stored octree: {trailing} bytes follow the last attribute")]
    TrailingBytes {
        /// Bytes too many.
        trailing: usize,
    },
    /// Flags that nothing is known of.
    #[error("stored octree: flags {found:#010b}, known are bits 0 and 1")]
    Flags {
        /// All flags.
        found: u8,
    },
    /// A cube that is not finite or has no extent.
    #[error("stored octree: a cube with the corner {min:?} and the edge {edge}")]
    Cube {
        /// Smallest corner, scene units.
        min: [f32; 3],
        /// Edge, scene units.
        edge: f32,
    },
    /// More points than a tree can have.
    #[error("stored octree: {found} points, at most 2^31 can be")]
    TooManyPoints {
        /// Number of points.
        found: u32,
    },
    /// Nodes of a tree that has none.
    #[error("stored octree: depth {depth} and {mask_bytes} mask bytes, but no points (deepest possible: {LEVELS})")]
    NodesWithoutPoints {
        /// Level of the deepest leaves.
        depth: u32,
        /// Number of mask bytes.
        mask_bytes: usize,
    },
    /// The byte code is not that of an octree.
    #[error("stored octree: {0}")]
    Shape(#[from] OctreeError),
    /// A leaf holds more points than there are.
    #[error("stored octree: leaf {leaf} holds {found} points, but {left} are left")]
    LeafTooLarge {
        /// Place of the leaf in Morton order.
        leaf: usize,
        /// Points it is said to hold.
        found: usize,
        /// Points not yet in a leaf.
        left: usize,
    },
    /// The leaves hold fewer points than there are.
    #[error("stored octree: {expected} points, but the leaves hold {found}")]
    TooFewInLeaves {
        /// Number of points.
        expected: usize,
        /// Points in all leaves.
        found: usize,
    },
    /// The points of a leaf do not ascend.
    #[error("stored octree: point {point} stands before the one before it in Morton order")]
    OutOfOrder {
        /// Place of the point.
        point: usize,
    },
    /// Bits that should fill up a byte with zeros.
    #[error("stored octree: the bits after the last point are not zeros")]
    Padding,
    /// A column that is neither one value nor a value a point.
    #[error("stored octree: {part} begin with {found}, known are 0 and 1")]
    ColumnKind {
        /// Which column.
        part: &'static str,
        /// Its first byte.
        found: u8,
    },
    /// Not a finite number, or a radius below zero.
    #[error("stored octree: {part} of point {point} are not a number that can be drawn")]
    InvalidNumber {
        /// Which column.
        part: &'static str,
        /// Place of the point.
        point: usize,
    },
}
