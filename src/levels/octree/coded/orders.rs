//! The byte code in the two orders of Botsch et al. 2002, decoded to the centres of cells as they are there.
//!
//! How it works: the centre of a child is its parent's plus one of eight vectors of its level, so a node costs one
//! addition.
//!
//! - *Depth-first* (§4.3): a stack of one node per level. A subtree that is culled has to be read to its end, with a
//!   flag that says that nothing is computed, as nothing says where it ends.
//! - *Breadth-first* (§4.4): a queue of the nodes of a level. A subtree that is culled costs nothing below: the number
//!   of a node's first child is counted from the bits before it.
//!
//! When depth-first wins: it needs no memory but the stack, and attributes of leaves alone. Any prefix of the other is
//! a coarser cloud, so that is the order in which clouds are kept; `bench coded` measures both.

use super::CodedCloud;
use crate::levels::octree::Octree;
use crate::levels::octree::stop::Leaves;
use crate::math::Cube;
use crate::math::morton::LEVELS;
use glam::Vec3;

/// The byte code of a tree whose leaves are on one level, each node before its children.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthFirstCode {
    cube: Cube,
    depth: u32,
    masks: Vec<u8>,
}

/// The vectors from the centre of a node to those of its children, by level of the child and octant.
struct Steps([[Vec3; 8]; LEVELS as usize + 1]);

impl Steps {
    fn of(cube: &Cube) -> Self {
        Self(std::array::from_fn(|level| {
            let half = 0.5 * cube.cell_edge(level as u32);
            std::array::from_fn(|octant| {
                let along = |axis: usize| if octant >> axis & 1 == 0 { -half } else { half };
                Vec3::new(along(0), along(1), along(2))
            })
        }))
    }
}

/// A node whose children are being visited.
#[derive(Debug, Clone, Copy, Default)]
struct Open {
    center: Vec3,
    /// Octants that were not visited yet.
    octants: u8,
}

impl DepthFirstCode {
    /// Writes the code of a tree in one pass over its points.
    ///
    /// # Panics
    /// Precondition: all leaves on one level.
    pub fn of(tree: &Octree) -> Self {
        assert!(matches!(tree.leaves, Leaves::OnLevel(_)), "leaves on one level");
        let depth = tree.depth();
        let mut masks = Vec::with_capacity(tree.node_count() - tree.leaf_count());
        // The bytes of the nodes that the last point is in, by level.
        let mut open = [0; LEVELS as usize + 1];
        let points = tree.points.cells.iter().zip(&tree.points.partings);
        for (cell, &parting) in points {
            // The first level on which this point is in another node than the one before it; the root's for the first.
            let first_new = u32::from(parting);
            if first_new > depth {
                continue;
            }
            if first_new > 0 {
                masks[open[first_new as usize - 1]] |= 1 << cell.octant(first_new);
            }
            for level in first_new..depth {
                open[level as usize] = masks.len();
                masks.push(1 << cell.octant(level + 1));
            }
        }
        Self {
            cube: tree.cube(),
            depth,
            masks,
        }
    }

    /// One byte for each node above the leaves.
    pub fn masks(&self) -> &[u8] {
        &self.masks
    }

    /// Calls `draw` with the number and the centre of each leaf, in Morton order, but for those below nodes above the
    /// leaves that `is_visible` refuses by level and centre.
    pub fn leaves(&self, is_visible: impl Fn(u32, Vec3) -> bool, mut draw: impl FnMut(usize, Vec3)) {
        let root = self.cube.cell_center(0, [0; 3]);
        let Some((&mask, mut unread)) = self.masks.split_first() else {
            draw(0, root);
            return;
        };
        let steps = Steps::of(&self.cube);
        let mut open = [Open::default(); LEVELS as usize + 1];
        open[0] = Open {
            center: root,
            octants: mask,
        };
        // Below the node of this level nothing is computed.
        let mut passive_below = (!is_visible(0, root)).then_some(0);
        let (mut level, mut leaf) = (0, 0);
        loop {
            let Open { center, octants } = open[level];
            if octants == 0 {
                if passive_below == Some(level) {
                    passive_below = None;
                }
                let Some(above) = level.checked_sub(1) else {
                    return;
                };
                level = above;
                continue;
            }
            let to_child = &steps.0[level + 1];
            if level as u32 + 1 == self.depth {
                open[level].octants = 0;
                if passive_below.is_some() {
                    leaf += octants.count_ones() as usize;
                    continue;
                }
                let mut left = octants;
                while left != 0 {
                    draw(leaf, center + to_child[left.trailing_zeros() as usize % 8]);
                    leaf += 1;
                    left &= left - 1;
                }
                continue;
            }
            open[level].octants = octants & (octants - 1);
            let Some((&mask, rest)) = unread.split_first() else {
                return;
            };
            unread = rest;
            level += 1;
            open[level].octants = mask;
            if passive_below.is_none() {
                let center = center + to_child[octants.trailing_zeros() as usize % 8];
                open[level].center = center;
                if !is_visible(level as u32, center) {
                    passive_below = Some(level);
                }
            }
        }
    }
}

impl CodedCloud {
    /// [`DepthFirstCode::leaves`] from the code in breadth-first order.
    pub fn leaves(&self, is_visible: impl Fn(u32, Vec3) -> bool, mut draw: impl FnMut(usize, Vec3)) {
        if self.attributes().is_empty() {
            return;
        }
        let steps = Steps::of(&self.cube());
        let mut nodes = vec![(0, self.cube().cell_center(0, [0; 3]))];
        let mut below = Vec::new();
        for level in 0..self.depth() {
            let to_child = &steps.0[level as usize + 1];
            // The children of neighbours follow each other, unless a node between them was culled.
            let mut next = None;
            for &(node, center) in &nodes {
                if !is_visible(level, center) {
                    next = None;
                    continue;
                }
                let mut child = match next {
                    Some((of, first)) if of == node => first,
                    _ => self.first_child(node),
                };
                let mut octants = self.masks()[node];
                while octants != 0 {
                    below.push((child, center + to_child[octants.trailing_zeros() as usize % 8]));
                    child += 1;
                    octants &= octants - 1;
                }
                next = Some((node + 1, child));
            }
            std::mem::swap(&mut nodes, &mut below);
            below.clear();
        }
        let first_leaf = self.level(self.depth()).start;
        for (node, center) in nodes {
            draw(node - first_leaf, center);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{PointRecord, ShapeRecord};
    use crate::levels::octree::StopCriterion;
    use crate::math::order_of_codes;
    use proptest::prelude::*;
    use std::sync::Arc;

    fn codes_of(points: &[Vec3], depth: u32) -> (DepthFirstCode, CodedCloud) {
        let cube = Cube::around(points).unwrap_or(Cube::EMPTY);
        let order = order_of_codes(&cube.codes(points));
        let sorted: Vec<Vec3> = order.iter().map(|&index| points[index as usize]).collect();
        let tree = Octree::build(&sorted, &vec![[0; 4]; sorted.len()], StopCriterion::Depth(depth));
        let record = |position: &Vec3| PointRecord {
            position: position.to_array(),
            color: [0; 4],
        };
        let shape = ShapeRecord {
            normal: crate::cloud::oct_encode(Vec3::Z),
            radius: 0.0,
            ellipse: 0,
            scalar: 0.0,
        };
        let records = Arc::new(sorted.iter().map(record).collect());
        let shapes = Arc::new(vec![shape; sorted.len()]);
        let code = DepthFirstCode::of(&tree);
        (code, CodedCloud::new(&Arc::new(tree), &records, &shapes))
    }

    #[test]
    fn a_small_code_is_in_both_orders() {
        // Octants 0 and 7 of the root; in the first its octants 0 and 1, in the other its octant 7.
        let points = [Vec3::ZERO, Vec3::new(0.3, 0.0, 0.0), Vec3::ONE];
        let (depth_first, breadth_first) = codes_of(&points, 2);
        assert_eq!(breadth_first.masks(), [0b1000_0001, 0b11, 0b1000_0000]);
        assert_eq!(depth_first.masks(), breadth_first.masks());
        let (depth_first, breadth_first) = codes_of(&points, 3);
        assert_eq!(
            breadth_first.masks(),
            [0b1000_0001, 0b11, 0b1000_0000, 1, 1, 0b1000_0000]
        );
        assert_eq!(depth_first.masks(), [0b1000_0001, 0b11, 1, 1, 0b1000_0000, 0b1000_0000]);
    }

    proptest! {
        /// Both orders give the leaves in Morton order, and of culled nodes none.
        #[test]
        fn both_orders_have_the_same_leaves(
            points in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 0..200),
            depth in 0u32..7,
            direction in prop::array::uniform3(-1f32..1.0),
            share in -1f32..1.0,
        ) {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from_array).collect();
            let (depth_first, breadth_first) = codes_of(&points, depth);
            let all = |_: u32, _: Vec3| true;
            let half = |level: u32, center: Vec3| level < 2 || center.dot(Vec3::from_array(direction)) > share;
            let mut found = [const { Vec::new() }; 4];
            if !points.is_empty() {
                depth_first.leaves(all, |leaf, center| found[0].push((leaf, center)));
                depth_first.leaves(half, |leaf, center| found[2].push((leaf, center)));
            }
            breadth_first.leaves(all, |leaf, center| found[1].push((leaf, center)));
            breadth_first.leaves(half, |leaf, center| found[3].push((leaf, center)));
            prop_assert_eq!(&found[0], &found[1]);
            prop_assert_eq!(&found[2], &found[3]);
            let depth = breadth_first.depth();
            let cells = if points.is_empty() { Vec::new() } else { breadth_first.cells(depth) };
            let cube = breadth_first.cube();
            prop_assert_eq!(cells.len(), found[0].len());
            for (place, (cell, &(leaf, center))) in cells.iter().zip(&found[0]).enumerate() {
                prop_assert_eq!(place, leaf);
                let expected = cube.cell_center(depth, *cell);
                prop_assert!((center - expected).abs().max_element() <= 1e-5, "{center} for {expected}");
                // A leaf is there if no node above it was refused.
                let is_seen = (0..depth).all(|level| {
                    half(level, cube.cell_center(level, cell.map(|coordinate| coordinate >> (depth - level))))
                });
                let is_near = (0..depth).any(|level| {
                    let center = cube.cell_center(level, cell.map(|coordinate| coordinate >> (depth - level)));
                    (center.dot(Vec3::from_array(direction)) - share).abs() < 1e-4
                });
                prop_assert!(is_near || is_seen == found[2].iter().any(|&(other, _)| other == leaf));
            }
        }
    }
}
