//! Cache of the records of all nodes of a level, for levels that are drawn repeatedly.
//!
//! How it works: once as many points were read for a level as it has, it is computed completely and cached, and the
//! drawn parts of it are contiguous ranges. So a frame that is seen once reads each point once, and a moving view
//! copies, at no more than twice the cost of the copied records.
//!
//! When it wins: where nodes have several points each, and a camera moves about a frame or a loop comes back to it.

use super::sorted_points::SortedPoints;
use super::write::NodeWriter;
use crate::levels::cut::NodeRange;
use crate::math::morton::LEVELS;
use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

pub(super) const LEVEL_COUNT: usize = LEVELS as usize + 1;

/// Points whose beginnings are counted one by one.
const RANK_POINTS: usize = 64;

/// The levels of a tree, each once it is worth keeping.
#[derive(Debug)]
pub(super) struct CachedLevels<R> {
    levels: [CachedLevel<R>; LEVEL_COUNT],
}

#[derive(Debug)]
struct CachedLevel<R> {
    /// Points read for nodes of the level that were not cached.
    points_read: AtomicUsize,
    records: OnceLock<LevelRecords<R>>,
}

/// Records of the nodes of a level, in Morton order.
#[derive(Debug)]
pub(super) struct LevelRecords<R> {
    pub(super) records: Vec<R>,
    level: u32,
    /// Nodes that begin before each [`RANK_POINTS`] points.
    nodes_before: Vec<u32>,
}

/// The cached levels, by their number.
pub(super) type Cached<'a, R> = [Option<&'a LevelRecords<R>>; LEVEL_COUNT];

impl<R> Default for CachedLevels<R> {
    fn default() -> Self {
        let none = || CachedLevel {
            points_read: AtomicUsize::new(0),
            records: OnceLock::new(),
        };
        Self {
            levels: std::array::from_fn(|_| none()),
        }
    }
}

impl<R> CachedLevels<R> {
    /// Maximum number of bytes of levels with this many nodes.
    pub(super) fn max_bytes(node_counts: &[usize], point_count: usize) -> usize {
        let ranks = point_count / RANK_POINTS + 1;
        let bytes = |count: &usize| count * size_of::<R>() + ranks * size_of::<u32>();
        node_counts.iter().map(bytes).sum()
    }

    /// The cached levels among those of some nodes that are about to be written; this may start caching one.
    pub(super) fn cached<'r, W: NodeWriter<Record = R>>(
        &self,
        ranges: impl Iterator<Item = &'r NodeRange>,
        points: &SortedPoints,
        writer: &W,
    ) -> Cached<'_, R> {
        let mut to_be_read = [0; LEVEL_COUNT];
        for range in ranges {
            to_be_read[range.level as usize] += range.points.len();
        }
        std::array::from_fn(|level| {
            let cached = &self.levels[level];
            if to_be_read[level] == 0 || cached.records.get().is_some() {
                return cached.records.get();
            }
            let read = cached.points_read.fetch_add(to_be_read[level], Ordering::Relaxed);
            // Not earlier: a frame that is played once then reads each point once, however many levels its cut has.
            (read >= points.len()).then(|| self.level(level as u32, points, writer))
        })
    }

    /// A level, if it is cached.
    pub(super) fn known(&self, level: usize) -> Option<&LevelRecords<R>> {
        self.levels[level].records.get()
    }

    /// A level, computed if it is not cached yet.
    pub(super) fn level<W: NodeWriter<Record = R>>(
        &self,
        level: u32,
        points: &SortedPoints,
        writer: &W,
    ) -> &LevelRecords<R> {
        let cached = &self.levels[level as usize].records;
        if let Some(records) = cached.get() {
            return records;
        }
        // Not inside `get_or_init`: a thread that waits for its share of the level may pick up other work, and end up
        // here again. If two compute the same level, one result is dropped.
        let worked_out = LevelRecords::work_out(level, points, writer);
        cached.get_or_init(|| worked_out)
    }
}

impl<R> LevelRecords<R> {
    fn work_out<W: NodeWriter<Record = R>>(level: u32, points: &SortedPoints, writer: &W) -> Self {
        let mut before = 0;
        let nodes_before = (0..=points.len() / RANK_POINTS)
            .map(|group| {
                let first = RANK_POINTS * group;
                let end = points.len().min(first + RANK_POINTS);
                let here = before;
                before += points.count_beginnings(level, first..end) as u32;
                here
            })
            .collect();
        let whole = NodeRange {
            level,
            points: 0..points.len(),
        };
        let mut records = Vec::new();
        if !whole.points.is_empty() {
            points.write_nodes(&[whole], writer, &Cached::default(), &mut records);
        }
        Self {
            records,
            level,
            nodes_before,
        }
    }

    /// Returns the records of consecutive nodes of the level.
    pub(super) fn of_nodes(&self, range: &NodeRange, points: &SortedPoints) -> &[R] {
        &self.records[self.places(range, points)]
    }

    /// The indices of consecutive nodes among those of the level.
    pub(super) fn places(&self, range: &NodeRange, points: &SortedPoints) -> Range<usize> {
        self.rank(range.points.start, points)..self.rank(range.points.end, points)
    }

    /// Number of nodes that begin before a point.
    pub(super) fn rank(&self, point: usize, points: &SortedPoints) -> usize {
        let group = point / RANK_POINTS;
        let before = self.nodes_before[group] as usize;
        before + points.count_beginnings(self.level, RANK_POINTS * group..point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_shapes::{self, Random};
    use crate::cloud::VoxelRecord;
    use crate::levels::SelectView;
    use crate::levels::octree::tests::{random_colors, view_from};
    use crate::levels::octree::{Octree, StopCriterion};
    use glam::Vec3;

    /// The voxels of `view`, from the tree and from one that keeps nothing.
    fn drawn(tree: &Octree, positions: &[Vec3], colors: &[[u8; 4]], view: &SelectView) {
        let (mut voxels, mut expected) = (Vec::new(), Vec::new());
        tree.select(view, &mut voxels);
        Octree::build(positions, colors, StopCriterion::Loss(0.02)).select(view, &mut expected);
        assert!(voxels == expected, "{} px", view.lod_px);
    }

    #[test]
    fn cached_voxels_match_computed_ones() {
        let mut random = Random(31);
        let positions = test_shapes::torus(60_000, 0.4, &mut random).positions;
        let colors = random_colors(positions.len(), &mut random);
        let tree = Octree::build(&positions, &colors, StopCriterion::Loss(0.02));
        let cached = |tree: &Octree| -> Vec<u32> {
            let levels = tree.points.voxels.levels.iter().zip(0..);
            let cached = levels.filter(|(level, _)| level.records.get().is_some());
            cached.map(|(_, number)| number).collect()
        };
        let at = |distance: f32, lod_px| view_from(Vec3::new(0.3, 0.5, 0.81) * distance, Vec3::ZERO, lod_px);
        // Everything in view is drawn once, which reads each point once.
        drawn(&tree, &positions, &colors, &at(4.0, 6.0));
        assert_eq!(cached(&tree), [0; 0]);
        for turn in 0..6 {
            // From inside, only part of it is visible: pieces of levels, between pieces of others.
            for (distance, lod_px) in [(4.0, 6.0), (0.9, 6.0), (2.0, 24.0), (2.0, 0.0)] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1 + turn % 3);
                pool.build().unwrap().install(|| {
                    drawn(&tree, &positions, &colors, &at(distance, lod_px));
                });
            }
        }
        let (cached, coarse) = (cached(&tree), tree.points.coarse_levels().len() as u32);
        assert!(
            cached.len() > 1 && cached.iter().all(|&level| level < coarse),
            "{cached:?} of {coarse}"
        );
        // Trees of the same points share the cached levels.
        let divided = tree.with_stop(StopCriterion::Loss(0.5));
        assert!(divided.points.voxels.levels[cached[0] as usize].records.get().is_some());
        let held: usize = cached
            .iter()
            .filter_map(|&level| tree.points.voxels.levels[level as usize].records.get())
            .map(|level| size_of_val(&level.records[..]) + size_of_val(&level.nodes_before[..]))
            .sum();
        let max = CachedLevels::<VoxelRecord>::max_bytes(tree.points.coarse_levels(), positions.len());
        assert!(
            held > 0 && held <= max && max < 8 * positions.len(),
            "{held} of {max} bytes"
        );
    }
}
