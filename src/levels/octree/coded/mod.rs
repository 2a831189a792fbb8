//! A cloud as the byte code of its octree, with attributes for every node: it is rendered directly from its stored form
//! (Botsch et al. 2002).
//!
//! # Layout
//!
//! Nodes are numbered breadth-first: the root is 0, each level in Morton order. Node `i` above the deepest
//! level has a byte, its occupied octants; the children of all nodes are in the order of the bits, so the first child
//! of `i` is one more than the bits before byte `i`. To find it without counting from the beginning, the number of bits
//! before every 64th byte is kept (half a bit for a byte); the rest is eight population counts. A sequential walk over
//! a level does not even need that.
//!
//! All nodes have attributes, leaves or not (the easiest solution of Botsch et al. 2002 §4.4, a third more of them). So
//! the bytes of the upper levels, and the attributes that belong to them, are a coarser cloud, and any prefix of levels
//! can be drawn.
//!
//! # Attributes
//!
//! Eight bytes per node: the normal as 17 bits of the refined octahedron (of which less may be used), the
//! *offset*, 3 bits, along the normal from the centre of the cell to the surface (Botsch et al. 2002 §5.1), a radius
//! and the cone of the normals below, 8 bits each, and a colour.
//!
//! The paper needs no radius: its cells are as large as the spacing of samples, and so are splats. Here the tree goes
//! as deep as its stop criterion says, which is mostly deeper, and points may be irregular: a radius says what a node's
//! splat has to cover.
//!
//! When it wins: a position costs some bits, and is decoded by adding one vector to the position of the cell above; a
//! node takes 8 bytes, where the records of a surfel take 32. What it costs: positions are those of cells, moved along
//! normals only.

mod attributes;
mod build;
mod expand;
#[cfg(test)]
mod expand_tests;
mod orders;
#[cfg(test)]
mod tests;

pub use attributes::{LARGEST_OFFSET, NodeAttributes};
#[cfg(feature = "gpu")]
pub(crate) use attributes::{NORMAL_MASK, OFFSET_SHIFT, RADIUS_SHIFT};
pub(crate) use attributes::{offset_of_code, radius_of_code};
pub use expand::{CodeNode, CodeView};
pub use orders::DepthFirstCode;

use super::{Octree, StopCriterion, stop::Leaves};
use crate::cloud::{FINEST_NORMAL_BITS, PointRecord, ShapeRecord};
use crate::math::Cube;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::{Arc, Weak};

/// Bytes whose bits are counted one by one.
pub(crate) const RANK_MASKS: usize = 64;

/// The byte code of an octree, and attributes of its nodes.
#[derive(Debug)]
pub struct CodedCloud {
    cube: Cube,
    masks: Vec<u8>,
    /// Bits before every [`RANK_MASKS`] bytes, and before the end.
    bits_before: Vec<u32>,
    /// The first node of each level, and the number of nodes.
    level_starts: Vec<usize>,
    attributes: Vec<NodeAttributes>,
    /// The largest radius on each level.
    largest_radii: Vec<f32>,
    of: Sources,
}

/// Source records that it was built from, if they still exist: a reused address is another array.
#[derive(Debug)]
struct Sources {
    octree: Weak<Octree>,
    points: Weak<Vec<PointRecord>>,
    shapes: Weak<Vec<ShapeRecord>>,
}

/// Storage size of a coded cloud, in bits per leaf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CodedBits {
    /// The byte code. On a surface whose cells are as large as its sample spacing, 2.67 at most (Botsch et al.
    /// 2002 §3).
    pub masks: f64,
    /// Entropy of the masks in the same unit: their size if bytes took as many bits as their frequency is worth (the
    /// result of an entropy coder).
    pub masks_entropy: f64,
    /// Normals of all nodes with 13 bits.
    pub normals: f64,
    /// Offsets of all nodes with 3 bits.
    pub offsets: f64,
    /// Colours of all nodes.
    pub colors: f64,
    /// All that is held in memory.
    pub in_memory: f64,
}

impl CodedCloud {
    /// The code of `octree`, with attributes from the records of its points.
    ///
    /// All leaves have to be on one level. A tree that divides by numbers of points takes the level of the default
    /// criterion.
    ///
    /// # Panics
    /// Preconditions: a record of each kind for each point, in the order of the points the tree was built from, which
    /// was Morton order; fewer than 2³² nodes.
    pub fn new(octree: &Arc<Octree>, points: &Arc<Vec<PointRecord>>, shapes: &Arc<Vec<ShapeRecord>>) -> Self {
        let tree = match octree.leaves {
            Leaves::OnLevel(_) => Cow::Borrowed(octree.as_ref()),
            Leaves::InRuns(_) | Leaves::OfPoints(_) => Cow::Owned(octree.with_stop(StopCriterion::PAPER)),
        };
        let masks = tree.masks();
        let mut level_starts = vec![0];
        for count in tree.level_counts() {
            level_starts.push(level_starts[level_starts.len() - 1] + count);
        }
        let attributes = build::attributes(&tree, &masks, points, shapes);
        let cube = tree.cube();
        let largest_radii = (0u32..)
            .zip(level_starts.windows(2))
            .map(|(level, ends)| {
                let of_level = attributes[ends[0]..ends[1]].iter();
                let largest = of_level.fold(0, |largest, node| node.radius_code().max(largest));
                radius_of_code(largest) * cube.cell_edge(level)
            })
            .collect();
        let mut before = 0;
        let mut bits_before = vec![0];
        bits_before.extend(masks.chunks(RANK_MASKS).map(|masks| {
            before += masks.iter().map(|mask| mask.count_ones()).sum::<u32>();
            before
        }));
        Self {
            cube,
            masks,
            bits_before,
            level_starts,
            attributes,
            largest_radii,
            of: Sources {
                octree: Arc::downgrade(octree),
                points: Arc::downgrade(points),
                shapes: Arc::downgrade(shapes),
            },
        }
    }

    /// Returns true if it was built from these records.
    pub fn is_of(&self, octree: &Arc<Octree>, points: &Arc<Vec<PointRecord>>, shapes: &Arc<Vec<ShapeRecord>>) -> bool {
        std::ptr::eq(self.of.octree.as_ptr(), Arc::as_ptr(octree))
            && std::ptr::eq(self.of.points.as_ptr(), Arc::as_ptr(points))
            && std::ptr::eq(self.of.shapes.as_ptr(), Arc::as_ptr(shapes))
    }

    /// The cube of the root.
    pub fn cube(&self) -> Cube {
        self.cube
    }

    /// The level of the leaves; 0 without points.
    pub fn depth(&self) -> u32 {
        self.level_starts.len().saturating_sub(2) as u32
    }

    /// The numbers of the nodes of a level, none below the leaves.
    pub fn level(&self, level: u32) -> Range<usize> {
        match self.level_starts.get(level as usize..level as usize + 2) {
            Some(&[start, end]) => start..end,
            _ => self.attributes.len()..self.attributes.len(),
        }
    }

    /// The deepest level with at most this many nodes.
    pub fn deepest_level_of(&self, max_nodes: usize) -> u32 {
        let has_few = |&level: &u32| self.level(level).len() <= max_nodes;
        (0..=self.depth()).rev().find(has_few).unwrap_or(0)
    }

    /// One byte for each node above the leaves, breadth-first.
    pub fn masks(&self) -> &[u8] {
        &self.masks
    }

    /// The attributes of all nodes.
    pub fn attributes(&self) -> &[NodeAttributes] {
        &self.attributes
    }

    /// No splat of a level has a larger radius, in scene units.
    pub fn largest_radius(&self, level: u32) -> f32 {
        self.largest_radii.get(level as usize).copied().unwrap_or(0.0)
    }

    /// Returns the reach of the splats of every level and of those below it beyond their cells, in scene units, with
    /// radii scaled by a factor.
    pub(crate) fn reaches(&self, scale: f32) -> Vec<f32> {
        let mut farthest = 0f32;
        let mut reaches: Vec<f32> = (0..=self.depth())
            .rev()
            .map(|level| {
                let radius = scale * self.largest_radius(level);
                farthest = farthest.max(radius + self.cube.cell_edge(level));
                farthest
            })
            .collect();
        reaches.reverse();
        reaches
    }

    /// The number of a node's first child; of the first leaf, the number of nodes. Precondition: no other leaf.
    #[inline]
    pub fn first_child(&self, node: usize) -> usize {
        let group = node / RANK_MASKS;
        let masks = &self.masks[RANK_MASKS * group..node];
        let (words, rest) = masks.as_chunks::<8>();
        let of_words: u32 = words.iter().map(|&word| u64::from_le_bytes(word).count_ones()).sum();
        let of_rest: u32 = rest.iter().map(|mask| mask.count_ones()).sum();
        1 + (self.bits_before[group] + of_words + of_rest) as usize
    }

    /// The descendants of some nodes that follow each other on a level, on a level below it or the same one.
    pub(crate) fn descendants(&self, nodes: Range<usize>, levels_below: u32) -> Range<usize> {
        (0..levels_below).fold(nodes, |nodes, _| {
            self.first_child(nodes.start)..self.first_child(nodes.end)
        })
    }

    /// The cells of a level, as coordinates below `2^level`, in Morton order: read from the bytes above it alone.
    pub fn cells(&self, level: u32) -> Vec<[u32; 3]> {
        let level = level.min(self.depth());
        let bytes = self.level(level).start.min(self.masks.len());
        Octree::cells_from_masks(&self.masks[..bytes], level).unwrap_or_default()
    }

    /// The code as words, for GPUs: masks, four in each, then the numbers of bits before every 64th, then two words of
    /// attributes for each node.
    pub fn words(&self) -> Vec<u32> {
        let masks = self.masks.chunks(4).map(|masks| {
            let mut word = [0; 4];
            word[..masks.len()].copy_from_slice(masks);
            u32::from_le_bytes(word)
        });
        let attributes: &[u32] = bytemuck::cast_slice(&self.attributes);
        let words = masks.chain(self.bits_before.iter().copied());
        words.chain(attributes.iter().copied()).collect()
    }

    /// Places of the numbers of bits and of the attributes in [`CodedCloud::words`], and its length.
    pub fn word_starts(&self) -> [usize; 3] {
        let ranks = self.masks.len().div_ceil(4);
        let attributes = ranks + self.bits_before.len();
        [ranks, attributes, attributes + 2 * self.attributes.len()]
    }

    /// Bytes held in memory.
    pub fn byte_size(&self) -> usize {
        size_of::<Self>()
            + self.masks.len()
            + size_of_val(self.bits_before.as_slice())
            + size_of_val(self.level_starts.as_slice())
            + size_of_val(self.attributes.as_slice())
            + size_of_val(self.largest_radii.as_slice())
    }

    /// Returns the storage size in bits per leaf; `None` without leaves.
    pub fn bits_per_leaf(&self) -> Option<CodedBits> {
        let leaves = self.level(self.depth()).len();
        if leaves == 0 {
            return None;
        }
        let per_leaf = |bits: f64| bits / leaves as f64;
        let nodes = self.attributes.len() as f64;
        Some(CodedBits {
            masks: per_leaf(8.0 * self.masks.len() as f64),
            masks_entropy: per_leaf(entropy_bits(&self.masks)),
            normals: per_leaf(f64::from(FINEST_NORMAL_BITS - 4) * nodes),
            offsets: per_leaf(3.0 * nodes),
            colors: per_leaf(24.0 * nodes),
            in_memory: per_leaf(8.0 * self.byte_size() as f64),
        })
    }
}

/// Bits that symbols are worth by their frequency.
fn entropy_bits(symbols: &[u8]) -> f64 {
    let mut counts = [0usize; 256];
    for &symbol in symbols {
        counts[symbol as usize] += 1;
    }
    let total = symbols.len() as f64;
    let worth = |count: &usize| match *count {
        0 => 0.0,
        count => count as f64 * (total / count as f64).log2(),
    };
    counts.iter().map(worth).sum()
}
