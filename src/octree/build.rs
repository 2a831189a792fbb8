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
//! 4. Step 3 streams through memory once for each level. So it is taken for a *block* of a thousand points at a time, made of
//!    whole cells of some middle level: all levels of a block stay in the nearest cache. What is above the middle level is
//!    little, and done at the end.
//!
//! Halves of a large cloud are written by two threads: the scan of step 2 over one half tells where the other's nodes begin.
//!
//! When it wins: no node is searched for, allocated or visited twice, and each level is written in ascending order. Inner
//! loops select instead of branching: whether a node is the first child of its parent is a coin toss that a branch
//! predictor loses.

use super::{Octree, StopCriterion, stop::OccupiedCells, voxels};
use crate::math::{
    Cube,
    morton::{self, LEVELS},
    sort_codes,
};
use glam::Vec3;
use rayon::prelude::*;

impl Octree {
    /// Builds the octree of `positions` down to the level that `stop` asks for.
    ///
    /// Colours are averaged per cell on every level. No points make an octree without nodes; one point, or points that all
    /// coincide, a root that is a leaf. The answer depends on the arguments alone.
    ///
    /// # Panics
    /// Preconditions: finite positions, one colour a point, at most 2³¹ points.
    pub fn build(positions: &[Vec3], colors: &[[u8; 4]], stop: StopCriterion) -> Self {
        assert_eq!(positions.len(), colors.len(), "one colour for each point");
        // One way into the pool and out again, instead of one for each parallel stage.
        rayon::scope(|_| Self::build_in_pool(positions, colors, stop))
    }

    fn build_in_pool(positions: &[Vec3], colors: &[[u8; 4]], stop: StopCriterion) -> Self {
        let Some(cube) = Cube::around(positions) else {
            return Self::with_levels(Cube::EMPTY, Vec::new());
        };
        let sorted = sort_codes(cube.codes(positions));
        let shape = || {
            let partings = parting_levels(&sorted.codes);
            let occupied = occupied_cells(&partings);
            let depth = stop.depth(&occupied, positions.len());
            let middle = middle_level(&occupied, depth, positions.len());
            let level_counts = occupied[..=depth as usize].to_vec();
            (partings, middle, Self::with_levels(cube, level_counts))
        };
        let colors = sorted.order.iter().map(|&index| colors[index as usize]);
        let ((partings, middle, mut tree), colors_before) =
            rayon::join(shape, || voxels::running_sums(colors));
        tree.codes = sorted.codes;
        tree.colors_before = colors_before;
        tree.write_nodes(&partings, middle);
        tree
    }

    /// A tree of this shape with nothing else in it yet.
    fn with_levels(cube: Cube, level_counts: Vec<usize>) -> Self {
        let node_count: usize = level_counts.iter().sum();
        let internal_count = node_count - level_counts.last().copied().unwrap_or(0);
        let mut first_child = vec![0; internal_count + 1];
        first_child[internal_count] = node_count as u32;
        Self {
            cube,
            first_point: vec![0; node_count + 1],
            masks: vec![0; internal_count],
            first_child,
            level_counts,
            codes: Vec::new(),
            colors_before: Vec::new(),
        }
    }

    /// Writes all nodes; those below level `middle` and on it a block at a time.
    fn write_nodes(&mut self, partings: &[u8], middle: u32) {
        let points = SortedPoints {
            codes: &self.codes,
            partings,
        };
        let (upper_counts, lower_counts) = self.level_counts.split_at(middle as usize);
        let mut all = Nodes {
            next: 0,
            first_point: &mut self.first_point,
            masks: &mut self.masks,
            first_child: &mut self.first_child,
        };
        let upper = all.take(upper_counts.iter().sum());
        let first_root = all.next;
        let lower = LevelWriter {
            points,
            top: middle,
            levels: all.reborrowed().levels(lower_counts),
        };
        lower.write_points(0, points.codes.len());
        let roots = &all.first_point[..lower_counts[0]];
        points.write_above(0, roots, first_root, &mut upper.levels(upper_counts));
    }
}

/// The level at which each sorted code parts from the one before it; 0 for the first.
fn parting_levels(codes: &[u64]) -> Vec<u8> {
    let mut partings = vec![0; codes.len()];
    if let Some((_, partings)) = partings.split_first_mut() {
        partings
            .par_iter_mut()
            .with_min_len(PARALLEL_POINTS)
            .zip(codes.par_windows(2))
            .for_each(|(parting, pair)| *parting = morton::parting_level(pair[0], pair[1]));
    }
    partings
}

/// Cells of every level that hold a point: one for each code that parted there or above.
fn occupied_cells(partings: &[u8]) -> OccupiedCells {
    // Several counters, because most partings are of few levels, and a count that was just written is slow to read.
    let mut parted = [[0u32; LEVELS as usize + 2]; 4];
    let (chunks, rest) = partings.as_chunks::<4>();
    for partings in chunks {
        for (parted, &level) in parted.iter_mut().zip(partings) {
            parted[level as usize] += 1;
        }
    }
    for &level in rest {
        parted[0][level as usize] += 1;
    }
    let mut total = 0;
    std::array::from_fn(|level| {
        total += parted
            .iter()
            .map(|parted| parted[level] as usize)
            .sum::<usize>();
        total
    })
}

/// Points that a block should have: what is written for it and read again takes 20 KiB.
const BLOCK_POINTS: usize = 1024;

/// The deepest level whose cells still hold half a block on average.
fn middle_level(occupied: &OccupiedCells, depth: u32, point_count: usize) -> u32 {
    (0..=depth)
        .rev()
        .find(|&level| occupied[level as usize] * BLOCK_POINTS / 2 <= point_count)
        .unwrap_or(0)
}

/// Below this, points are not shared out among threads.
const PARALLEL_POINTS: usize = 1 << 14;

/// Points in Morton order.
#[derive(Debug, Clone, Copy)]
struct SortedPoints<'a> {
    codes: &'a [u64],
    /// See [`parting_levels`].
    partings: &'a [u8],
}

impl SortedPoints<'_> {
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
    /// `children` and of which the first is number `first_child`.
    fn write_above(&self, top: u32, children: &[u32], first_child: u32, levels: &mut [Nodes<'_>]) {
        let Some((parents, above)) = levels.split_last_mut() else {
            return;
        };
        let level = top + above.len() as u32;
        let parents = self.write_parents(level, children, first_child, parents);
        self.write_above(top, parents.first_point, parents.next, above);
    }

    /// Writes the parents, on `level`, of the nodes that begin with the points `children`; the first is number `first_child`.
    fn write_parents<'a>(
        &self,
        level: u32,
        children: &[u32],
        first_child: u32,
        nodes: &mut Nodes<'a>,
    ) -> Nodes<'a> {
        let octant_shift = 3 * (LEVELS - 1 - level);
        let firsts = &mut *nodes.first_point;
        let first_children = &mut nodes.first_child[..firsts.len()];
        let masks = &mut nodes.masks[..firsts.len()];
        let mut parents = 0;
        let (mut first, mut child_of_first, mut mask) = (0, 0, 0);
        for (&point, child) in children.iter().zip(first_child..) {
            let octant = self.codes[point as usize] >> octant_shift & 7;
            let is_first = u32::from(self.partings[point as usize]) <= level;
            parents += usize::from(is_first);
            first = if is_first { point } else { first };
            child_of_first = if is_first { child } else { child_of_first };
            mask = if is_first { 0 } else { mask } | 1 << octant;
            // Written for every child: the last one leaves what is right. The first child of all begins a parent.
            firsts[parents - 1] = first;
            first_children[parents - 1] = child_of_first;
            masks[parents - 1] = mask;
        }
        nodes.take(parents)
    }
}

/// Consecutive nodes that are still to be written.
#[derive(Debug, Default)]
struct Nodes<'a> {
    /// Number of the first of them.
    next: u32,
    first_point: &'a mut [u32],
    /// Empty for leaves, as are the first children.
    masks: &'a mut [u8],
    first_child: &'a mut [u32],
}

impl Nodes<'_> {
    fn reborrowed(&mut self) -> Nodes<'_> {
        Nodes {
            next: self.next,
            first_point: self.first_point,
            masks: self.masks,
            first_child: self.first_child,
        }
    }

    /// Levels of these many nodes.
    fn levels(mut self, counts: &[usize]) -> Vec<Self> {
        counts.iter().map(|&count| self.take(count)).collect()
    }

    /// Takes the first `count` nodes away.
    fn take(&mut self, count: usize) -> Self {
        let internal = count.min(self.masks.len());
        let taken = Nodes {
            next: self.next,
            first_point: self.first_point.split_off_mut(..count).unwrap_or_default(),
            masks: self.masks.split_off_mut(..internal).unwrap_or_default(),
            first_child: self
                .first_child
                .split_off_mut(..internal)
                .unwrap_or_default(),
        };
        self.next += count as u32;
        taken
    }
}

/// Fills some nodes of some consecutive levels, each from its beginning.
#[derive(Debug)]
struct LevelWriter<'a> {
    points: SortedPoints<'a>,
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
                .write_above(self.top, leaves.first_point, leaves.next, parents);
            next = block_end;
        }
    }
}
