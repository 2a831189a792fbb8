//! Decoding of the bytes of a block to the projections of its nodes.
//!
//! How it works: breadth-first, in byte order (Botsch et al. 2002 §4.4), but a block at a time, so that the queue of
//! nodes is two short lists. The drawn nodes of a block are on one level, so they are consecutive, and no attributes
//! need to be skipped.

use super::blocks::Block;
use super::transform::Transform;
use crate::levels::octree::CodedCloud;
use glam::Vec4;
use std::ops::Range;

/// Decodes blocks, and keeps the memory for it.
#[derive(Debug, Default)]
pub(super) struct Decoder {
    centers: Vec<Vec4>,
    below: Vec<Vec4>,
}

impl Block {
    /// The nodes that are drawn.
    pub(super) fn nodes(&self, cloud: &CodedCloud) -> Range<usize> {
        cloud.descendants(self.node..self.node + 1, self.drawn_level - self.level)
    }
}

impl Decoder {
    /// Decodes the drawn nodes of a block, and the projections of their centres.
    #[inline(always)]
    pub(super) fn decode(
        &mut self,
        cloud: &CodedCloud,
        transform: &Transform,
        block: &Block,
    ) -> (Range<usize>, &[Vec4]) {
        self.centers.clear();
        self.centers.push(block.center);
        let mut nodes = block.node..block.node + 1;
        for level in block.level..block.drawn_level {
            let masks = &cloud.masks()[nodes.clone()];
            let first = cloud.first_child(nodes.start);
            let count: u32 = masks.iter().map(|mask| mask.count_ones()).sum();
            nodes = first..first + count as usize;
            self.below.resize(nodes.len(), Vec4::ZERO);
            let to_child = &transform.to_child[level as usize + 1];
            let mut below = self.below.iter_mut();
            for (&mask, &center) in masks.iter().zip(&self.centers) {
                let mut octants = mask;
                while octants != 0 {
                    let octant = octants.trailing_zeros() as usize % 8;
                    octants &= octants - 1;
                    if let Some(child) = below.next() {
                        *child = center + to_child[octant];
                    }
                }
            }
            std::mem::swap(&mut self.centers, &mut self.below);
        }
        (nodes, &self.centers)
    }
}
