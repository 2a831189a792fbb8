//! Building an octree from sorted Morton codes (paper 000 §VI-A).
//!
//! How it works:
//! 1. Points become 63-bit Morton codes, which are sorted. The points of any cell of any level now stand together.
//! 2. For each code the level at which it *parts* from the one before it is noted: it is the first point of its cell there
//!    and on every deeper level. A histogram of these levels, summed up, counts the occupied cells of every level,
//!    so one scan answers the stop criterion for all depths, and says where each level begins in the breadth-first array.
//! 3. A node is where its first point is. The leaves are the points that part at the leaf level or above; each coarser
//!    level is the finer one without the nodes that do not part there. All else about a node follows from its points, and
//!    is worked out when it is drawn ([`super::voxels`]).
//!    Leaves on several levels, which the paper only compares with, are found from the root down instead
//!    ([`super::uneven`]).
//! 4. Step 3 streams through memory once for each level. So it is taken for a *block* of a thousand points at a time, made of
//!    whole cells of some middle level: all levels of a block stay in the nearest cache. What is above the middle level is
//!    little, and done at the end.
//!
//! Halves of a large cloud are written by two threads: the scan of step 2 over one half tells where the other's nodes begin.
//!
//! When it wins: no node is searched for, allocated or visited twice, and each level is written in ascending order. Inner
//! loops select instead of branching: whether a node is the first child of its parent is a coin toss that a branch
//! predictor loses.

use super::sorted_points::{SortedPoints, occupied_cells};
use super::stop::{Leaves, StopCriterion};
use super::{Children, NodeLevel, Octree};
use crate::math::{Cube, morton::LEVELS};
use glam::Vec3;
use std::sync::Arc;

impl Octree {
    /// Builds the octree of `positions` down to the level that `stop` asks for.
    ///
    /// Colours are averaged per cell on every level. No points make an octree without nodes; one point, or points that all
    /// coincide, a root that is a leaf. The answer depends on the arguments alone. Points that stand in Morton order already
    /// are not sorted again.
    ///
    /// # Panics
    /// Preconditions: finite positions, one colour a point, at most 2³¹ points.
    pub fn build(positions: &[Vec3], colors: &[[u8; 4]], stop: StopCriterion) -> Self {
        assert_eq!(positions.len(), colors.len(), "one colour for each point");
        // One way into the pool and out again, instead of one for each parallel stage.
        rayon::scope(|_| {
            let cube = Cube::around(positions).unwrap_or(Cube::EMPTY);
            let (points, levels) = SortedPoints::sorted_and(&cube, positions, colors, |points| {
                points.levels(stop, &[])
            });
            Self::from_levels(cube, Arc::new(points), levels)
        })
    }

    /// The same points divided as `stop` asks. Nothing is sorted; a tree that is less deep only shares the upper levels, one
    /// that is deeper has the lower levels written, and where leaves are to be on several levels, or were, all are.
    #[must_use]
    pub fn with_stop(&self, stop: StopCriterion) -> Self {
        let known: &[NodeLevel] = if self.is_even { &self.levels } else { &[] };
        let levels = rayon::scope(|_| self.points.levels(stop, known));
        Self::from_levels(self.cube, Arc::clone(&self.points), levels)
    }

    fn from_levels(cube: Cube, points: Arc<SortedPoints>, levels: Vec<NodeLevel>) -> Self {
        let leaves_of = |level: &NodeLevel| match &level.children {
            Some(_) if level.point_end.is_none() => 0,
            Some(children) => children
                .masks()
                .iter()
                .map(|&mask| usize::from(mask == 0))
                .sum(),
            None => level.node_count(),
        };
        Self {
            cube,
            points,
            leaf_count: levels.iter().map(leaves_of).sum(),
            is_even: levels.iter().all(|level| level.point_end.is_none()),
            levels,
        }
    }
}

impl SortedPoints {
    /// The levels that `stop` asks for; of `known`, which has all leaves on its last level, what can be used again.
    fn levels(&self, stop: StopCriterion, known: &[NodeLevel]) -> Vec<NodeLevel> {
        if self.codes.is_empty() {
            return Vec::new();
        }
        let depth = match stop.leaves(&self.occupied, self.codes.len()) {
            Leaves::OnLevel(depth) => depth,
            Leaves::OfPoints(most_points) => return self.uneven_levels(most_points),
        };
        let kept = known.len().saturating_sub(1).min(depth as usize);
        let mut levels = known[..kept].to_vec();
        match known.get(kept) {
            Some(last) if kept == depth as usize => levels.push(last.undivided()),
            _ => levels.extend(self.even_levels(kept as u32, depth)),
        }
        levels
    }

    /// Levels `top` to `depth`, on which all leaves are.
    fn even_levels(&self, top: u32, depth: u32) -> Vec<NodeLevel> {
        let counts = &self.occupied[..=depth as usize];
        let mut arrays: Vec<LevelArrays> = (top..=depth)
            .map(|level| LevelArrays::new(counts[level as usize], level < depth, self.codes.len()))
            .collect();
        let middle = self.middle_level(depth).max(top);
        let (upper, lower) = arrays.split_at_mut((middle - top) as usize);
        let writer = LevelWriter {
            points: self,
            top: middle,
            levels: lower.iter_mut().map(LevelArrays::nodes).collect(),
        };
        writer.write_points(0, self.codes.len());
        let mut upper: Vec<Nodes<'_>> = upper.iter_mut().map(LevelArrays::nodes).collect();
        let roots = &lower[0].first_point[..counts[middle as usize]];
        self.write_above(top, roots, &mut upper);
        arrays.into_iter().map(LevelArrays::into_level).collect()
    }

    /// The deepest level down to `depth` whose cells still hold half a block on average.
    fn middle_level(&self, depth: u32) -> u32 {
        (0..=depth)
            .rev()
            .find(|&level| self.occupied[level as usize] * BLOCK_POINTS / 2 <= self.codes.len())
            .unwrap_or(0)
    }

    /// The first place from `least` to `end` where a cell of `level` begins, or `end`.
    fn cell_boundary(&self, least: usize, end: usize, level: u32) -> usize {
        let least = least.min(end);
        self.partings[least..end]
            .iter()
            .position(|&parting| u32::from(parting) <= level)
            .map_or(end, |beyond| least + beyond)
    }

    /// Writes the leaves among the points `first..end`, on `level`.
    fn write_leaves<'a>(
        &self,
        level: u32,
        first: usize,
        end: usize,
        nodes: &mut Nodes<'a>,
    ) -> Nodes<'a> {
        let mut count = 0;
        for (&parting, point) in self.partings[first..end].iter().zip(first as u32..) {
            // Overwritten until a point that parts moves on.
            if let Some(first_point) = nodes.first_point.get_mut(count) {
                *first_point = point;
            }
            count += usize::from(u32::from(parting) <= level);
        }
        nodes.take(count)
    }

    /// Writes the next nodes of `levels`, of which the first is level `top`, above nodes that begin with the points
    /// `children`.
    fn write_above(&self, top: u32, children: &[u32], levels: &mut [Nodes<'_>]) {
        let Some((parents, above)) = levels.split_last_mut() else {
            return;
        };
        let level = top + above.len() as u32;
        let parents = self.write_parents(level, children, parents);
        self.write_above(top, parents.first_point, above);
    }

    /// Writes the parents, on `level`, of the nodes that begin with the points `children`.
    fn write_parents<'a>(&self, level: u32, children: &[u32], nodes: &mut Nodes<'a>) -> Nodes<'a> {
        let octant_shift = 3 * (LEVELS - 1 - level);
        let firsts = &mut *nodes.first_point;
        let masks = &mut nodes.masks[..firsts.len()];
        let mut parents = 0;
        let (mut first, mut mask) = (0, 0);
        for &point in children {
            let octant = self.codes[point as usize] >> octant_shift & 7;
            let is_first = u32::from(self.partings[point as usize]) <= level;
            parents += usize::from(is_first);
            first = if is_first { point } else { first };
            mask = if is_first { 0 } else { mask } | 1 << octant;
            // Written for every child: the last one leaves what is right. The first child of all begins a parent.
            firsts[parents - 1] = first;
            masks[parents - 1] = mask;
        }
        nodes.take(parents)
    }
}

/// Points that a block should have: what is written for it and read again takes 20 KiB.
const BLOCK_POINTS: usize = 1024;

/// Below this, points are not shared out among threads.
const PARALLEL_POINTS: usize = 1 << 14;

/// The arrays of a [`NodeLevel`] before they are shared.
#[derive(Debug)]
struct LevelArrays {
    first_point: Vec<u32>,
    /// Empty on the deepest level.
    masks: Vec<u8>,
}

impl LevelArrays {
    /// Of so many nodes, with what ends them in place.
    fn new(count: usize, has_children: bool, point_count: usize) -> Self {
        let mut first_point = vec![0; count + 1];
        first_point[count] = point_count as u32;
        let masks = if has_children {
            Children::masks_of(count)
        } else {
            Vec::new()
        };
        Self { first_point, masks }
    }

    /// All nodes, to be written.
    fn nodes(&mut self) -> Nodes<'_> {
        let count = self.first_point.len() - 1;
        Nodes {
            first_point: &mut self.first_point[..count],
            masks: &mut self.masks,
        }
    }

    fn into_level(self) -> NodeLevel {
        let has_children = !self.masks.is_empty();
        NodeLevel {
            first_point: Arc::new(self.first_point),
            point_end: None,
            children: has_children.then(|| Arc::new(Children::new(self.masks))),
        }
    }
}

/// Consecutive nodes of one level that are still to be written.
#[derive(Debug, Default)]
struct Nodes<'a> {
    first_point: &'a mut [u32],
    /// Empty for leaves.
    masks: &'a mut [u8],
}

impl Nodes<'_> {
    /// Takes the first `count` nodes away.
    fn take(&mut self, count: usize) -> Self {
        let internal = count.min(self.masks.len());
        Nodes {
            first_point: self.first_point.split_off_mut(..count).unwrap_or_default(),
            masks: self.masks.split_off_mut(..internal).unwrap_or_default(),
        }
    }
}

/// Fills some nodes of some consecutive levels, each from its beginning.
#[derive(Debug)]
struct LevelWriter<'a> {
    points: &'a SortedPoints,
    /// Level of the first of `levels`; the last are the leaves.
    top: u32,
    levels: Vec<Nodes<'a>>,
}

impl LevelWriter<'_> {
    /// Keeps all but the first nodes of each level, as many as the points `first..end` begin; the writer of these.
    fn split_points(&mut self, first: usize, end: usize) -> Self {
        let begun = occupied_cells(&self.points.partings[first..end]);
        let levels = self.levels.iter_mut().zip(&begun[self.top as usize..]);
        Self {
            points: self.points,
            top: self.top,
            levels: levels.map(|(nodes, &count)| nodes.take(count)).collect(),
        }
    }

    /// Writes the nodes of the points `first..end`, which are whole cells of the top level.
    fn write_points(mut self, first: usize, end: usize) {
        if end - first >= 2 * PARALLEL_POINTS {
            let middle = self
                .points
                .cell_boundary(first.midpoint(end), end, self.top);
            if middle < end {
                let low = self.split_points(first, middle);
                rayon::join(
                    || low.write_points(first, middle),
                    || self.write_points(middle, end),
                );
                return;
            }
        }
        let Some((leaves, parents)) = self.levels.split_last_mut() else {
            return;
        };
        let leaf_level = self.top + parents.len() as u32;
        let mut next = first;
        while next < end {
            let block_end = self
                .points
                .cell_boundary(next + BLOCK_POINTS, end, self.top);
            let leaves = self
                .points
                .write_leaves(leaf_level, next, block_end, leaves);
            self.points
                .write_above(self.top, leaves.first_point, parents);
            next = block_end;
        }
    }
}
