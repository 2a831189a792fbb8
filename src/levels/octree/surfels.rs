//! Surfels for the nodes of every level (future work of the 4D media paper): the counterpart of voxels for surfels.
//!
//! A node's surfel has the mean position, colour, normal and scalar of its points. Its disk covers theirs, as far as
//! they lie in one plane: it reaches to the farthest of them, so a surface that is closed at the finest level is closed
//! at all. A *normal cone* around the mean normal holds the normals of all points; where it faces away from the eye, so
//! do they.
//!
//! How it works: the points of a node are a contiguous range. The surfels of a cut are computed from the points under
//! it, in one pass over their records, and dropped; those of levels that are drawn repeatedly are cached
//! (`cached_levels.rs`). Leaves, where all are on one level, are drawn as the very points they hold, so that nothing is
//! lost at close range.
//!
//! When it wins: where splats are small on the screen and many.

use super::cached_levels::{Cached, CachedLevels};
use super::node_surfel::NodeSurfel;
use super::selectable::{Parts, Selectable};
use super::stop::Leaves;
use super::tree::Octree;
use super::write::{NodeWriter, Nodes};
use crate::cloud::{PointRecord, ShapeRecord};
use crate::levels::cut::{Cut, NodeRange};
use crate::levels::selection::NodeRecords;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// The surfels of an octree's nodes.
#[derive(Debug)]
pub struct LodSurfels {
    pub(super) octree: Arc<Octree>,
    points: Arc<Vec<PointRecord>>,
    pub(super) shapes: Arc<Vec<ShapeRecord>>,
    are_ellipses: bool,
    /// The one level whose nodes are tested for facing away: the finest at which that is less than drawing them. Those
    /// above it would each take a pass over all points, to spare some visits.
    cone_level: Option<u32>,
    levels: CachedLevels<NodeSurfel>,
    selectable: Selectable,
    /// Normals of voxels.
    pub(super) normals: CachedLevels<ShapeRecord>,
}

/// Cells above this level are not tested for facing away: they are as large as the object.
const FIRST_CONE_LEVEL: u32 = 3;

/// Below this many points per node on average, it costs more to test whether they face away than to draw them.
// With back-face culling, a cut of 1,000,000 points takes 5.2 ms instead of 2.0 ms (2 threads), for half of the
// surfels, whose records take 1.3 instead of 3.3 ms to copy.
const POINTS_PER_CONE: usize = 16;

impl LodSurfels {
    /// The surfels of `octree`, from the records of its points. Nothing is computed yet.
    ///
    /// # Panics
    /// Preconditions: a record of each kind for each point, in the order of the points the tree was built from, which
    /// was Morton order.
    pub fn new(octree: Arc<Octree>, points: Arc<Vec<PointRecord>>, shapes: Arc<Vec<ShapeRecord>>) -> Self {
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
            are_ellipses: shapes.par_iter().any(|shape| shape.ellipse != 0),
            shapes,
            levels: CachedLevels::default(),
            selectable: Selectable::default(),
            normals: CachedLevels::default(),
        }
    }

    /// Returns a copy without any cached results.
    #[must_use]
    pub fn fresh(&self) -> Self {
        let (points, shapes) = (Arc::clone(&self.points), Arc::clone(&self.shapes));
        Self::new(Arc::clone(&self.octree), points, shapes)
    }

    /// The tree.
    pub fn octree(&self) -> &Arc<Octree> {
        &self.octree
    }

    /// Returns true if these are the surfels of these records.
    pub fn is_of(&self, octree: &Arc<Octree>, points: &Arc<Vec<PointRecord>>, shapes: &Arc<Vec<ShapeRecord>>) -> bool {
        Arc::ptr_eq(&self.octree, octree) && Arc::ptr_eq(&self.points, points) && Arc::ptr_eq(&self.shapes, shapes)
    }

    /// The records of all points.
    #[cfg(test)]
    pub(super) fn records(&self) -> (&[PointRecord], &[ShapeRecord]) {
        (&self.points, &self.shapes)
    }

    /// The surfels of all cells of a level that hold points, in Morton order. Level 21 at most.
    pub fn level(&self, level: u32) -> &[NodeSurfel] {
        let level = self.levels.level(level, &self.octree.points, self);
        &level.records
    }

    /// Maximum size of the levels in bytes, computed or not.
    pub fn max_bytes(&self) -> usize {
        let sorted = &self.octree.points;
        let above_leaves = &sorted.occupied[..self.octree.depth() as usize];
        let count = self.points.len();
        let (surfels, normals) = (above_leaves, sorted.coarse_levels());
        CachedLevels::<NodeSurfel>::max_bytes(surfels, count) + CachedLevels::<ShapeRecord>::max_bytes(normals, count)
    }

    /// Maximum number of bytes of the concatenated levels, with the points, for selection.
    pub fn max_selectable_bytes(&self) -> usize {
        let above_leaves = &self.octree.points.occupied[..self.octree.depth() as usize];
        let nodes = self.points.len() + above_leaves.iter().sum::<usize>();
        nodes * (size_of::<PointRecord>() + size_of::<ShapeRecord>())
    }

    /// Replaces the contents of `points` and `shapes` by the surfels of a cut of the octree; the surfels of leaves are
    /// the points themselves.
    pub fn write_surfels(&self, cut: &Cut, points: &mut Vec<PointRecord>, shapes: &mut Vec<ShapeRecord>) {
        points.clear();
        shapes.clear();
        let sorted = &self.octree.points;
        let is_leaf = |range: &NodeRange| self.octree.is_leaf_range(range);
        let above_leaves = cut.ranges.iter().filter(|range| !is_leaf(range));
        let cached = self.levels.cached(above_leaves.clone(), sorted, self);
        let is_passing = |range: &NodeRange| cached[range.level as usize].is_none();
        let passing: Vec<NodeRange> = above_leaves.filter(|range| is_passing(range)).cloned().collect();
        let mut worked_out = Vec::new();
        sorted.write_nodes(&passing, self, &Cached::default(), &mut worked_out);
        let mut worked_out = worked_out.as_slice();
        for range in &cut.ranges {
            let surfels = if is_leaf(range) {
                points.extend_from_slice(&self.points[range.points.clone()]);
                shapes.extend_from_slice(&self.shapes[range.points.clone()]);
                continue;
            } else if let Some(cached) = cached[range.level as usize] {
                cached.of_nodes(range, sorted)
            } else {
                let count = sorted.count_nodes(std::slice::from_ref(range));
                worked_out.split_off(..count).unwrap_or_default()
            };
            points.extend(surfels.iter().map(|surfel| surfel.point));
            shapes.extend(surfels.iter().map(|surfel| surfel.shape));
        }
    }

    /// Selects the surfels as indices into persistent records; `None` if a level of the cut is not cached.
    pub(super) fn select_surfels(&self, cut: &Cut, places: &mut Vec<u32>) -> Option<NodeRecords> {
        let mut parts = Parts::default();
        for range in &cut.ranges {
            if self.octree.is_leaf_range(range) {
                parts.has_leaves = true;
            } else {
                parts.levels |= 1 << range.level;
            }
        }
        let all = self
            .selectable
            .with_parts(parts, &self.levels, &self.points, &self.shapes)?;
        places.clear();
        for range in &cut.ranges {
            if self.octree.is_leaf_range(range) {
                places.extend(range.points.start as u32..range.points.end as u32);
            } else {
                all.extend_places(range, &self.levels, &self.octree.points, places);
            }
        }
        Some(all.nodes)
    }

    /// Returns true if the points of a node all face away from `eye`. They are in a sphere; `false` if that is not
    /// known.
    pub(super) fn all_face_away(&self, node: &NodeRange, eye: Vec3, center: Vec3, sphere_radius: f32) -> bool {
        self.cones(node.level, node.points.start)
            .is_some_and(|surfels| surfels[0].faces_away(center - eye, sphere_radius))
    }

    /// The surfels of the nodes of `level` from the one that begins with a point; `None` where they are not tested for
    /// facing away.
    pub(super) fn cones(&self, level: u32, first: usize) -> Option<&[NodeSurfel]> {
        if self.cone_level != Some(level) {
            return None;
        }
        let sorted = &self.octree.points;
        let cached = self.levels.level(level, sorted, self);
        Some(&cached.records[cached.rank(first, sorted)..])
    }

    /// Computes the data for [`LodSurfels::all_face_away`] before several threads ask for it.
    pub(super) fn work_out_cones(&self) {
        if let Some(level) = self.cone_level {
            self.level(level);
        }
    }

    /// The level below `level` whose nodes are tested for facing away, if there is one.
    pub(super) fn cone_level_below(&self, level: u32) -> Option<u32> {
        self.cone_level.filter(|&cones| level < cones)
    }
}

fn cone_level(octree: &Octree) -> Option<u32> {
    let are_large = |count: &usize| count * POINTS_PER_CONE <= octree.point_count();
    let level = octree.level_counts().iter().rposition(are_large)? as u32;
    (level >= FIRST_CONE_LEVEL).then_some(level)
}

impl Octree {
    /// Returns true if the nodes of a cut are leaves that are drawn as their points. If leaves are on several levels,
    /// their cells are to be shown instead.
    fn is_leaf_range(&self, range: &NodeRange) -> bool {
        match self.leaves {
            Leaves::OnLevel(depth) => range.level == depth,
            Leaves::InRuns(_) | Leaves::OfPoints(_) => false,
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
            *surfel = NodeSurfel::of(&self.points[points.clone()], &self.shapes[points], self.are_ellipses);
        }
    }
}
