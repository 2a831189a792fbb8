//! Surfels for the nodes of every level (future work of paper 000): what voxels are to points, these are to surfels.
//!
//! A node's surfel has the mean position, colour, normal and scalar of its points. Its disk covers theirs, as far as they lie in
//! one plane: it reaches to the farthest of them, so a surface that is closed at the finest level is closed at all. A *normal
//! cone* around the mean normal holds those of all points; where it faces away from the eye, so do they.
//!
//! How it works: the points of a node are a contiguous range. The surfels of a cut are worked out from the points under it, in one
//! pass over their records, and forgotten; a level of which as many points were read as there are is worked out whole and kept,
//! and what is drawn of it are contiguous pieces. So a frame that is seen once reads each point once, and a view that moves
//! about copies, having paid at most twice for what it copies. Leaves, where all are on one level, are
//! drawn as the very points they hold, so that nothing is lost where nothing is small.
//!
//! When it wins: where splats are small on the screen and many.

use super::node_surfel::NodeSurfel;
use super::write::{NodeWriter, Nodes};
use super::{Cut, NodeRange, Octree, stop::Leaves};
use crate::cloud::{PointRecord, ShapeRecord};
use crate::math::morton::LEVELS;
use glam::Vec3;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// The surfels of an octree's nodes.
#[derive(Debug)]
pub struct LodSurfels {
    octree: Arc<Octree>,
    points: Arc<Vec<PointRecord>>,
    shapes: Arc<Vec<ShapeRecord>>,
    /// The one level whose nodes are tested for facing away: the finest at which that is less than drawing them. Those above
    /// it would each take a pass over all points, to spare some visits.
    cone_level: Option<u32>,
    levels: [KeptLevel; LEVELS as usize + 1],
}

/// A level, once it is worth keeping.
#[derive(Debug, Default)]
struct KeptLevel {
    /// Points read for nodes of the level that were not kept.
    points_read: AtomicUsize,
    surfels: OnceLock<SurfelLevel>,
}

#[derive(Debug)]
struct SurfelLevel {
    surfels: Vec<NodeSurfel>,
    /// Nodes that begin before each [`RANK_POINTS`] points.
    nodes_before: Vec<u32>,
}

/// Points whose beginnings are counted one by one.
const RANK_POINTS: usize = 64;

/// Cells above this level are not tested for facing away: they are as large as the object.
const FIRST_CONE_LEVEL: u32 = 3;

/// Below so many points a node on average, it costs more to test whether they face away than to draw them.
const POINTS_PER_CONE: usize = 16;

impl LodSurfels {
    /// The surfels of `octree`, from the records of its points. Nothing is worked out yet.
    ///
    /// # Panics
    /// Preconditions: a record of each kind for each point, in the order of the points the tree was built from, which was
    /// Morton order.
    pub fn new(
        octree: Arc<Octree>,
        points: Arc<Vec<PointRecord>>,
        shapes: Arc<Vec<ShapeRecord>>,
    ) -> Self {
        assert_eq!(octree.point_count(), points.len(), "one record a point");
        assert_eq!(points.len(), shapes.len(), "one shape a point");
        assert!(
            octree.points.are_as_given,
            "points of the octree in the order they were given"
        );
        Self {
            cone_level: cone_level(&octree),
            octree,
            points,
            shapes,
            levels: Default::default(),
        }
    }

    /// The same, with nothing worked out yet.
    #[must_use]
    pub fn anew(&self) -> Self {
        let (points, shapes) = (Arc::clone(&self.points), Arc::clone(&self.shapes));
        Self::new(Arc::clone(&self.octree), points, shapes)
    }

    /// The tree.
    pub fn octree(&self) -> &Arc<Octree> {
        &self.octree
    }

    /// Whether these are the surfels of these records.
    pub fn is_of(
        &self,
        octree: &Arc<Octree>,
        points: &Arc<Vec<PointRecord>>,
        shapes: &Arc<Vec<ShapeRecord>>,
    ) -> bool {
        Arc::ptr_eq(&self.octree, octree)
            && Arc::ptr_eq(&self.points, points)
            && Arc::ptr_eq(&self.shapes, shapes)
    }

    /// The records of all points.
    #[cfg(test)]
    pub(super) fn records(&self) -> (&[PointRecord], &[ShapeRecord]) {
        (&self.points, &self.shapes)
    }

    /// The surfels of all cells of a level that hold points, in Morton order. Level 21 at most.
    pub fn level(&self, level: u32) -> &[NodeSurfel] {
        &self.surfel_level(level).surfels
    }

    /// Most bytes that the levels can come to, worked out or not.
    pub fn most_bytes(&self) -> usize {
        self.octree.internal_count() * size_of::<NodeSurfel>()
    }

    /// Replaces the contents of `points` and `shapes` by the surfels of a cut of the octree; those of leaves are the points
    /// themselves.
    pub fn write(&self, cut: &Cut, points: &mut Vec<PointRecord>, shapes: &mut Vec<ShapeRecord>) {
        points.clear();
        shapes.clear();
        let passing: Vec<NodeRange> = cut
            .ranges
            .iter()
            .filter(|range| !self.octree.is_leaf_range(range) && !self.is_kept(range))
            .cloned()
            .collect();
        let mut worked_out = Vec::new();
        self.octree
            .points
            .write_nodes(&passing, self, &mut worked_out);
        let mut worked_out = worked_out.as_slice();
        let mut passing = passing.iter().peekable();
        for range in &cut.ranges {
            let surfels = if self.octree.is_leaf_range(range) {
                points.extend_from_slice(&self.points[range.points.clone()]);
                shapes.extend_from_slice(&self.shapes[range.points.clone()]);
                continue;
            } else if passing.next_if_eq(&range).is_some() {
                let count = self.octree.points.count_nodes(std::slice::from_ref(range));
                worked_out.split_off(..count).unwrap_or_default()
            } else {
                self.of_nodes(range)
            };
            points.extend(surfels.iter().map(|surfel| surfel.point));
            shapes.extend(surfels.iter().map(|surfel| surfel.shape));
        }
    }

    /// Whether the level of some nodes that are to be drawn is kept, or is now.
    fn is_kept(&self, range: &NodeRange) -> bool {
        let level = &self.levels[range.level as usize];
        if level.surfels.get().is_some() {
            return true;
        }
        let read = level
            .points_read
            .fetch_add(range.points.len(), Ordering::Relaxed);
        read >= self.points.len() && !self.surfel_level(range.level).surfels.is_empty()
    }

    /// Whether the points of a node all face away from `eye`. They are in a sphere; `false` where that is not known.
    pub(super) fn all_face_away(
        &self,
        node: &NodeRange,
        eye: Vec3,
        center: Vec3,
        sphere_radius: f32,
    ) -> bool {
        self.cones(node.level, node.points.start)
            .is_some_and(|surfels| surfels[0].faces_away(center - eye, sphere_radius))
    }

    /// The surfels of the nodes of `level` from the one that begins with a point; `None` where they are not tested for facing away.
    pub(super) fn cones(&self, level: u32, first: usize) -> Option<&[NodeSurfel]> {
        if self.cone_level != Some(level) {
            return None;
        }
        let kept = self.surfel_level(level);
        Some(&kept.surfels[self.rank(kept, level, first)..])
    }

    /// Works out what [`LodSurfels::all_face_away`] asks for, before many threads do.
    pub(super) fn work_out_cones(&self) {
        if let Some(level) = self.cone_level {
            self.surfel_level(level);
        }
    }

    /// The level below `level` whose nodes are tested for facing away, if there is one.
    pub(super) fn cone_level_below(&self, level: u32) -> Option<u32> {
        self.cone_level.filter(|&cones| level < cones)
    }

    /// The surfels of consecutive nodes.
    fn of_nodes(&self, range: &NodeRange) -> &[NodeSurfel] {
        let level = self.surfel_level(range.level);
        let first = self.rank(level, range.level, range.points.start);
        let end = self.rank(level, range.level, range.points.end);
        &level.surfels[first..end]
    }

    /// Number of nodes of a level that begin before a point.
    fn rank(&self, level: &SurfelLevel, number: u32, point: usize) -> usize {
        let group = point / RANK_POINTS;
        let before = level.nodes_before[group] as usize;
        let points = RANK_POINTS * group..point;
        before + self.octree.points.count_beginnings(number, points)
    }

    fn surfel_level(&self, level: u32) -> &SurfelLevel {
        let kept = &self.levels[level as usize].surfels;
        if let Some(level) = kept.get() {
            return level;
        }
        // Not inside of `get_or_init`: a thread that waits for its share of the level may take up other work, and come by here
        // again. If two work out the same, one of them is dropped.
        let worked_out = self.work_out(level);
        kept.get_or_init(|| worked_out)
    }

    fn work_out(&self, level: u32) -> SurfelLevel {
        let sorted = &self.octree.points;
        let all = 0..self.points.len();
        let mut before = 0;
        let nodes_before = (0..=self.points.len() / RANK_POINTS)
            .map(|group| {
                let first = RANK_POINTS * group;
                let end = all.end.min(first + RANK_POINTS);
                let here = before;
                before += sorted.count_beginnings(level, first..end) as u32;
                here
            })
            .collect();
        let mut surfels = Vec::new();
        if !all.is_empty() {
            sorted.write_nodes(&[NodeRange { level, points: all }], self, &mut surfels);
        }
        SurfelLevel {
            surfels,
            nodes_before,
        }
    }
}

fn cone_level(octree: &Octree) -> Option<u32> {
    let are_large = |count: &usize| count * POINTS_PER_CONE <= octree.point_count();
    let level = octree.level_counts().iter().rposition(are_large)? as u32;
    (level >= FIRST_CONE_LEVEL).then_some(level)
}

impl Octree {
    /// Whether nodes of a cut are leaves that are drawn as their points. Where leaves are on several levels, the cells are what
    /// is to be seen.
    fn is_leaf_range(&self, range: &NodeRange) -> bool {
        match self.leaves {
            Leaves::OnLevel(depth) => range.level == depth,
            Leaves::OfPoints(_) => false,
        }
    }
}

impl NodeWriter for LodSurfels {
    type Record = NodeSurfel;

    #[inline(always)]
    fn write(&self, nodes: &Nodes<'_>, out: &mut [NodeSurfel]) {
        let ends = nodes.ends.iter();
        for (surfel, (&first, &end)) in out.iter_mut().zip(nodes.firsts.iter().zip(ends)) {
            let points = first as usize..end as usize;
            *surfel = NodeSurfel::of(&self.points[points.clone()], &self.shapes[points]);
        }
    }
}
