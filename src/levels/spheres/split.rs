//! Division of a bounding sphere tree: points in Morton order, node by node.
//!
//! How it works: the points of a node are a contiguous range, and its cell is the smallest cell of Morton codes that
//! holds them. A cell is halved where its codes part in their highest bit. Of a node's pieces the one with the largest
//! cell is halved until there are four, so nearly every node has four children, the maximum for a node of QSplat. All
//! nodes of a level are divided in parallel, which leaves them in breadth-first order.
//!
//! When it wins: nothing is sorted or moved. Halving the longest axis of the box, as QSplat does, moves the points on
//! every level.

use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of children of a node.
pub(super) const MAX_CHILDREN: usize = 4;

/// Nodes that are worth handing to another thread.
pub(super) const NODES_PER_TASK: usize = 256;

/// A node that is not a leaf: at least one point in at most four children.
#[derive(Debug, Clone)]
pub(super) struct Inner {
    /// The first point of each child, then the end of the last.
    starts: [u32; MAX_CHILDREN + 1],
    child_count: u8,
    /// The root is on level 0.
    pub(super) level: u8,
    /// Index of the first of its children that are not leaves; the others of these follow.
    first_child: u32,
    /// Index of its parent; the root is its own.
    pub(super) parent: u32,
}

/// A child of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Child {
    /// A single point, by its index in Morton order.
    Leaf(u32),
    /// A node, by its index.
    Inner(u32),
}

/// The nodes of a tree that are not leaves, in breadth-first order.
#[derive(Debug)]
pub(super) struct Division {
    pub(super) inners: Vec<Inner>,
    /// Start index of each level, then the end of the last one.
    pub(super) level_starts: Vec<usize>,
}

impl Inner {
    /// Its children, in Morton order.
    pub(super) fn children(&self) -> impl Iterator<Item = Child> + Clone {
        let mut next_inner = self.first_child;
        let ends = self.starts[..=usize::from(self.child_count)].array_windows();
        ends.map(move |&[start, end]| {
            if end - start == 1 {
                return Child::Leaf(start);
            }
            next_inner += 1;
            Child::Inner(next_inner - 1)
        })
    }

    /// Its children that are not leaves.
    pub(super) fn inner_children(&self) -> Range<u32> {
        let ends = self.starts[..=usize::from(self.child_count)].array_windows();
        let count = ends.filter(|[start, end]| end - start > 1).count();
        self.first_child..self.first_child + count as u32
    }

    /// The points below, in Morton order.
    pub(super) fn points(&self) -> Range<usize> {
        self.starts[0] as usize..self.starts[usize::from(self.child_count)] as usize
    }

    /// Number of points below.
    pub(super) fn point_count(&self) -> usize {
        self.points().len()
    }

    pub(super) fn child_count(&self) -> usize {
        usize::from(self.child_count)
    }

    /// The node of some points, divided.
    fn of(codes: &[u64], points: Range<u32>, level: u8, parent: u32) -> Self {
        let mut starts = [points.end; MAX_CHILDREN + 1];
        starts[0] = points.start;
        let mut child_count = 1;
        while child_count < MAX_CHILDREN {
            let pieces = (0..child_count).filter(|&piece| starts[piece + 1] - starts[piece] > 1);
            // The largest cell; among coincident points, the one with the most points.
            let largest = pieces.max_by_key(|&piece| {
                let (first, end) = (starts[piece], starts[piece + 1]);
                let different = codes[first as usize] ^ codes[end as usize - 1];
                (u64::BITS - different.leading_zeros(), end - first)
            });
            let Some(piece) = largest else { break };
            let center = center_of(codes, starts[piece]..starts[piece + 1]);
            starts.copy_within(piece + 1..MAX_CHILDREN, piece + 2);
            starts[piece + 1] = center;
            child_count += 1;
        }
        Self {
            starts,
            child_count: child_count as u8,
            level,
            first_child: 0,
            parent,
        }
    }
}

/// Returns the split index of two points or more: the first that differs from those before in the highest bit in which
/// any do; the midpoint for equal ones.
fn center_of(codes: &[u64], points: Range<u32>) -> u32 {
    let codes = &codes[points.start as usize..points.end as usize];
    let different = codes[0] ^ codes[codes.len() - 1];
    if different == 0 {
        return points.start.midpoint(points.end);
    }
    let highest = 1 << different.ilog2();
    points.start + codes.partition_point(|code| code & highest == 0) as u32
}

impl Division {
    /// The division of points with these Morton codes; of none, no nodes.
    ///
    /// # Panics
    /// Preconditions: ascending codes, fewer than 2³² of them.
    pub(super) fn of(codes: &[u64]) -> Self {
        assert!(codes.is_sorted(), "points in Morton order");
        let point_count = u32::try_from(codes.len()).expect("fewer points than indices");
        let mut inners = Vec::new();
        let mut level_starts = vec![0];
        let mut undivided = Vec::new();
        if point_count > 0 {
            undivided.push((0..point_count, 0));
        }
        while !undivided.is_empty() {
            let level = level_starts.len() as u8 - 1;
            let divided = undivided.into_par_iter().with_min_len(NODES_PER_TASK);
            let mut nodes: Vec<Inner> = divided
                .map(|(points, parent)| Inner::of(codes, points, level, parent))
                .collect();
            let first = inners.len();
            let first_below = (first + nodes.len()) as u32;
            undivided = Vec::with_capacity(2 * nodes.len());
            for (node, index) in nodes.iter_mut().zip(first as u32..) {
                node.first_child = first_below + undivided.len() as u32;
                let ends = node.starts[..=node.child_count()].array_windows();
                let children = ends.filter(|[start, end]| end - start > 1);
                undivided.extend(children.map(|&[start, end]| (start..end, index)));
            }
            inners.append(&mut nodes);
            level_starts.push(inners.len());
        }
        Self { inners, level_starts }
    }

    /// The nodes of each level, from the root down.
    pub(super) fn levels(&self) -> impl DoubleEndedIterator<Item = Range<usize>> {
        self.level_starts.array_windows().map(|&[start, end]| start..end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Children of a node as ranges of points.
    fn pieces(codes: &[u64]) -> Vec<Range<u32>> {
        let node = Inner::of(codes, 0..codes.len() as u32, 0, 0);
        let ends = node.starts[..=node.child_count()].array_windows();
        ends.map(|&[start, end]| start..end).collect()
    }

    #[test]
    fn the_largest_cells_are_halved_first() {
        // Halved at bit 5, then the upper half at bit 4, then the upper quarter at bit 3.
        let codes = [0b00_0000, 0b00_0001, 0b10_0000, 0b11_0000, 0b11_1000, 0b11_1001];
        assert_eq!(pieces(&codes), [0..2, 2..3, 3..4, 4..6]);
        assert_eq!(pieces(&[7]), std::slice::from_ref(&(0..1)));
        assert_eq!(pieces(&[7, 8]), [0..1, 1..2]);
    }

    #[test]
    fn equal_points_are_divided_evenly() {
        assert_eq!(pieces(&[5; 8]), [0..2, 2..4, 4..6, 6..8]);
    }

    #[test]
    fn every_point_and_every_node_but_the_root_has_one_parent() {
        let codes: Vec<u64> = (0..999_u64).map(|i| i * i / 7 / 5 * 5).collect();
        let Division { inners, level_starts } = Division::of(&codes);
        let (mut leaves, mut children) = (Vec::new(), vec![0]);
        for (node, index) in inners.iter().zip(0..) {
            let level = level_starts.partition_point(|&start| start <= index) - 1;
            assert_eq!(level, usize::from(node.level));
            for child in node.children() {
                match child {
                    Child::Leaf(point) => leaves.push(point),
                    Child::Inner(child) => {
                        assert_eq!(inners[child as usize].parent as usize, index);
                        assert!(node.inner_children().contains(&child));
                        children.push(child);
                    }
                }
            }
        }
        leaves.sort_unstable();
        assert!(leaves.into_iter().eq(0..999));
        assert!(children.into_iter().eq(0..inners.len() as u32));
        assert!(Division::of(&[]).inners.is_empty());
    }
}
