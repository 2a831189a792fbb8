//! Trees with leaves on several levels: a cell is divided while it holds more than so many points.
//!
//! The paper compares its stop criterion with this one (000 §VI-A, Fig. 5): where points are dense, voxels come out smaller
//! than where they are sparse, so that a surface of one scan is drawn in several sizes.
//!
//! How it works: from the root down, a level at a time. The points of a node are a range in Morton order, and its children
//! begin where a point parts from the one before it on the next level. Points in one finest cell cannot be parted; they are
//! one leaf, however many they are.
//!
//! When it wins: for comparison, and for an index whose leaves hold about equally many points. Every level reads the points
//! of the cells that are divided on it, so it takes longer than a tree with all leaves on one level.

use super::sorted_points::SortedPoints;
use super::{Children, NodeLevel};
use crate::math::morton::LEVELS;
use std::sync::Arc;

impl SortedPoints {
    /// The levels of the tree whose leaves hold at most `most_points` points (at least 1). Precondition: there are points.
    pub(super) fn uneven_levels(&self, most_points: usize) -> Vec<NodeLevel> {
        let most_points = most_points.max(1);
        let point_count = self.codes.len() as u32;
        let mut levels = Vec::new();
        let mut nodes = Nodes {
            first_point: vec![0],
            point_end: vec![point_count],
        };
        while !nodes.first_point.is_empty() {
            let level = levels.len() as u32;
            let (below, children) = self.divide(&nodes, level, most_points);
            levels.push(nodes.into_level(point_count, children));
            nodes = below;
        }
        levels
    }

    /// The children of the nodes of `level`, and who has which.
    fn divide(&self, nodes: &Nodes, level: u32, most_points: usize) -> (Nodes, Children) {
        let mut below = Nodes::default();
        let mut masks = Vec::with_capacity(nodes.first_point.len());
        for (&first, &end) in nodes.first_point.iter().zip(&nodes.point_end) {
            let codes = &self.codes[first as usize..end as usize];
            let can_be_parted = codes.first() != codes.last();
            let mask = if codes.len() > most_points && can_be_parted {
                self.write_children(first, end, level + 1, &mut below)
            } else {
                0
            };
            masks.push(mask);
        }
        (below, Children::new(masks))
    }

    /// Adds the cells of `level` that the points `first..end` of one cell above it lie in; which octants they are.
    fn write_children(&self, first: u32, end: u32, level: u32, below: &mut Nodes) -> u8 {
        let octant_shift = 3 * (LEVELS - level);
        let mut mask = 0;
        for point in first..end {
            let begins = point == first || u32::from(self.partings[point as usize]) == level;
            if begins {
                if point != first {
                    below.point_end.push(point);
                }
                below.first_point.push(point);
                mask |= 1 << (self.codes[point as usize] >> octant_shift & 7);
            }
        }
        below.point_end.push(end);
        mask
    }
}

/// The points of the nodes of one level.
#[derive(Debug, Default)]
struct Nodes {
    first_point: Vec<u32>,
    point_end: Vec<u32>,
}

impl Nodes {
    fn into_level(mut self, point_count: u32, children: Children) -> NodeLevel {
        self.first_point.push(point_count);
        let is_deepest = children.masks().iter().all(|&mask| mask == 0);
        NodeLevel {
            first_point: Arc::new(self.first_point),
            point_end: Some(Arc::new(self.point_end)),
            children: (!is_deepest).then(|| Arc::new(children)),
        }
    }
}
