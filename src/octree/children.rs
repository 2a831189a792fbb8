//! Which nodes are whose children, in little more than a byte a node.
//!
//! How it works: the children of the nodes of a level stand one after the other on the next, so the first child of a node is
//! as many nodes from the beginning as the masks before it have bits. That number is stored for every eighth node; the bits of
//! the up to seven masks in between are counted, which are one word.
//!
//! When it wins: over a number for each node, which takes four times the memory of the mask beside it; building a tree is
//! mostly waiting for memory, and bits are counted in a few cycles.

/// Nodes whose masks are one word.
const GROUP: usize = 8;

/// The children of the nodes of one level.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Children {
    /// Which octants of each node are occupied; 0 for a leaf. Filled up to whole groups, and one more, with zeros, so that
    /// there is a word for the end too.
    masks: Vec<u8>,
    count: usize,
    /// Children of all nodes before each group of eight.
    before_group: Vec<u32>,
}

impl Children {
    /// Masks of so many nodes, to be written, with room for what [`Children::new`] adds.
    pub(super) fn masks_of(count: usize) -> Vec<u8> {
        let mut masks = Vec::with_capacity((count / GROUP + 1) * GROUP);
        masks.resize(count, 0);
        masks
    }

    /// From the occupied octants of each node.
    pub(super) fn new(mut masks: Vec<u8>) -> Self {
        let count = masks.len();
        masks.resize((count / GROUP + 1) * GROUP, 0);
        let mut before_group = Vec::with_capacity(masks.len() / GROUP);
        let mut before = 0;
        for &group in masks.as_chunks::<GROUP>().0 {
            before_group.push(before);
            before += u64::from_le_bytes(group).count_ones();
        }
        Self {
            masks,
            count,
            before_group,
        }
    }

    /// The occupied octants of each node; 0 for a leaf.
    pub(super) fn masks(&self) -> &[u8] {
        &self.masks[..self.count]
    }

    /// The occupied octants of a node; 0 for a leaf.
    pub(super) fn mask(&self, node: usize) -> u8 {
        self.masks[node]
    }

    /// The first child of a node, a number on the next level; for the number of nodes, that of the next level's.
    pub(super) fn first_child(&self, node: usize) -> usize {
        let group = node / GROUP;
        let word = u64::from_le_bytes(self.masks.as_chunks::<GROUP>().0[group]);
        let before_node = word & ((1 << (8 * (node % GROUP))) - 1);
        (self.before_group[group] + before_node.count_ones()) as usize
    }

    /// Bytes held in memory.
    pub(super) fn byte_size(&self) -> usize {
        size_of_val(self.masks.as_slice()) + size_of_val(self.before_group.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_children_are_counted_up() {
        for count in 0..40 {
            let masks: Vec<u8> = (0..count).map(|node| (node * 37 % 256) as u8).collect();
            let children = Children::new(masks.clone());
            let mut before = 0;
            for (node, mask) in masks.iter().enumerate() {
                assert_eq!(children.first_child(node), before);
                assert_eq!(children.mask(node), *mask);
                before += mask.count_ones() as usize;
            }
            assert_eq!(children.first_child(masks.len()), before);
        }
    }
}
