//! The byte code of an octree: one mask byte for each internal node, breadth-first (the 4D media paper §VI-A).
//!
//! The bytes of a level say how many bytes the next level has, so the code needs no lengths, and any byte lost, added
//! or emptied is noticed. An octant moved within its byte cannot be noticed.
//!
//! How it works: level by level, cells as *location codes*: a one, and below it the Morton code of the cell, three bits
//! per level (the keys of Warren & Salmon 1993, A Parallel Hashed Oct-Tree N-Body Algorithm, §3.1). They name a cell of
//! any level in one word: the root is 1, and a cell of level 21 fills all 64 bits.

use super::{Octree, stop::Leaves};
use crate::math::morton::{self, LEVELS};

/// Reason why a byte code is not valid for an octree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OctreeError {
    /// More levels than Morton codes have.
    #[error("octree byte code: depth {depth} is beyond the deepest level, {LEVELS}")]
    TooDeep {
        /// The depth given.
        depth: u32,
    },
    /// The bytes end within a level.
    #[error("octree byte code: level {level} has {expected} nodes, but the bytes end after {found} of them")]
    Truncated {
        /// Level whose bytes are missing.
        level: u32,
        /// Nodes on that level.
        expected: usize,
        /// Remaining bytes.
        found: usize,
    },
    /// An internal node without children.
    #[error("octree byte code: byte {index} (level {level}) is zero, but every node has a child")]
    EmptyNode {
        /// Position of the byte.
        index: usize,
        /// Level of the node.
        level: u32,
    },
    /// More bytes than nodes.
    #[error("octree byte code: {trailing} bytes follow the last node")]
    TrailingBytes {
        /// Bytes too many.
        trailing: usize,
    },
}

impl Octree {
    /// One byte for each node above the deepest level, breadth-first; bit `o` is set when octant `o` is occupied, none
    /// is for a leaf. Together with the depth it is the whole shape of the tree (the 4D media paper §VI-A): see
    /// [`Octree::cells_from_masks`].
    pub fn masks(&self) -> Vec<u8> {
        match self.leaves {
            Leaves::OnLevel(_) => (0..self.depth())
                .flat_map(|level| self.points.masks_of_level(level))
                .collect(),
            Leaves::InRuns(_) | Leaves::OfPoints(_) => self.masks_by_division(),
        }
    }

    /// Returns the occupancy masks of a tree with leaves on several levels.
    fn masks_by_division(&self) -> Vec<u8> {
        let mut masks = Vec::with_capacity(self.node_count());
        let mut nodes = vec![self.root()];
        for _ in 0..self.depth() {
            let mut below = Vec::new();
            for node in &nodes {
                let mut mask = 0;
                if !self.is_leaf(node.level, &node.points) {
                    for (octant, child) in self.points.children(node) {
                        mask |= 1 << octant;
                        below.push(child);
                    }
                }
                masks.push(mask);
            }
            nodes = below;
        }
        masks
    }

    /// The occupied cells at level `depth` that a byte code encodes, as integer coordinates below `2^depth`, in
    /// Morton order.
    ///
    /// At depth 0 the code has no bytes and means the root. (An octree without points has no code: nothing to
    /// store.) Memory is bounded by the bytes there are: eight cells for each.
    pub fn cells_from_masks(masks: &[u8], depth: u32) -> Result<Vec<[u32; 3]>, OctreeError> {
        if depth > LEVELS {
            return Err(OctreeError::TooDeep { depth });
        }
        let mut cells = vec![ROOT];
        let mut start = 0;
        for level in 0..depth {
            let Some(level_masks) = masks[start..].get(..cells.len()) else {
                return Err(OctreeError::Truncated {
                    level,
                    expected: cells.len(),
                    found: masks.len() - start,
                });
            };
            if let Some(offset) = level_masks.iter().position(|&mask| mask == 0) {
                return Err(OctreeError::EmptyNode {
                    index: start + offset,
                    level,
                });
            }
            let below = level_masks.iter().map(|mask| mask.count_ones() as usize).sum();
            cells = children(&cells, level_masks, below);
            start += level_masks.len();
        }
        match masks.len() - start {
            0 => {
                let codes = cells.into_iter().map(|cell| cell ^ (ROOT << (3 * depth)));
                Ok(codes.map(morton::decode).collect())
            }
            trailing => Err(OctreeError::TrailingBytes { trailing }),
        }
    }
}

/// The location code of the root.
const ROOT: u64 = 1;

/// The `count` children of `cells` with these masks.
fn children(cells: &[u64], masks: &[u8], count: usize) -> Vec<u64> {
    let mut children = Vec::with_capacity(count);
    // The masks of eight cells form one word: one unpredictable loop exit instead of eight.
    for (cells, masks) in cells.chunks(8).zip(masks.chunks(8)) {
        let mut word = [0; 8];
        word[..masks.len()].copy_from_slice(masks);
        let mut octants = u64::from_le_bytes(word);
        while octants != 0 {
            let bit = octants.trailing_zeros();
            children.push(cells[bit as usize / 8] << 3 | u64::from(bit % 8));
            octants &= octants - 1;
        }
    }
    children
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::octree::StopCriterion;
    use glam::Vec3;

    /// Two levels: octants 0 and 7 of the root; in them octants 1 and 2, and octant 4.
    const CODE: [u8; 3] = [0b1000_0001, 0b0000_0110, 0b0001_0000];

    #[test]
    fn a_hand_written_code_is_decoded() {
        let cells = Octree::cells_from_masks(&CODE, 2).unwrap();
        assert_eq!(cells, [[1, 0, 0], [0, 1, 0], [2, 2, 3]]);
        assert_eq!(Octree::cells_from_masks(&[], 0).unwrap(), [[0; 3]]);
    }

    #[test]
    fn damaged_codes_are_rejected() {
        let cases = [
            (
                &CODE[..2],
                2,
                OctreeError::Truncated {
                    level: 1,
                    expected: 2,
                    found: 1,
                },
            ),
            (
                &CODE[..0],
                2,
                OctreeError::Truncated {
                    level: 0,
                    expected: 1,
                    found: 0,
                },
            ),
            (&CODE, 1, OctreeError::TrailingBytes { trailing: 2 }),
            (&CODE, 0, OctreeError::TrailingBytes { trailing: 3 }),
            (
                &CODE,
                3,
                OctreeError::Truncated {
                    level: 2,
                    expected: 3,
                    found: 0,
                },
            ),
            (&[CODE[0], 0, 1], 2, OctreeError::EmptyNode { index: 1, level: 1 }),
            (&[0], 1, OctreeError::EmptyNode { index: 0, level: 0 }),
            (&CODE, 22, OctreeError::TooDeep { depth: 22 }),
        ];
        for (masks, depth, expected) in cases {
            assert_eq!(Octree::cells_from_masks(masks, depth), Err(expected));
        }
    }

    #[test]
    fn every_lost_or_added_byte_of_a_real_tree_is_detected() {
        let points: Vec<Vec3> = (0..500)
            .map(|i| Vec3::new((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i % 13) as f32))
            .collect();
        let tree = Octree::build(&points, &vec![[0; 4]; 500], StopCriterion::Loss(0.0));
        let masks = tree.masks();
        for cached in 0..masks.len() {
            assert!(Octree::cells_from_masks(&masks[..cached], tree.depth()).is_err());
        }
        for at in 0..masks.len() {
            let mut longer = masks.clone();
            longer.insert(at, 0xff);
            assert!(Octree::cells_from_masks(&longer, tree.depth()).is_err());
            let mut emptied = masks.clone();
            emptied[at] = 0;
            assert!(Octree::cells_from_masks(&emptied, tree.depth()).is_err());
        }
    }
}
