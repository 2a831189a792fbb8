//! Building an octree from Morton codes (the 4D media paper §VI-A).
//!
//! How it works:
//! 1. Points become 63-bit Morton codes, which are sorted. The points of any cell of any level are now contiguous.
//! 2. For each code the level at which it *parts* from the one before it is noted: it is the first point of its cell
//!    there and on every deeper level. A histogram of these levels, summed up, counts the occupied cells of every
//!    level, so one scan evaluates the stop criterion for all depths.
//!
//! That is all: nodes are read off the parting levels on demand. Leaves on several levels are runs of
//! points (`spacing.rs`); leaves of at most N points, which the paper only compares with, are counted by going
//! through the tree once.

use super::sorted_points::SortedPoints;
use super::stop::{Leaves, StopCriterion, level_of_loss};
use super::tree::Octree;
use crate::levels::cut::NodeRange;
use crate::math::{Cube, morton::LEVELS};
use glam::Vec3;
use std::sync::Arc;

impl Octree {
    /// Builds the octree of `positions` down to the level that `stop` determines.
    ///
    /// Colours are averaged per cell on every level. No points make an octree without nodes; one point, or points that
    /// all coincide, a root that is a leaf. The result depends on the arguments alone. Points that are in Morton
    /// order already are not sorted again.
    ///
    /// # Panics
    /// Preconditions: finite positions, one colour a point, at most 2³¹ points.
    pub fn build(positions: &[Vec3], colors: &[[u8; 4]], stop: StopCriterion) -> Self {
        Self::build_in(Cube::around(positions).unwrap_or(Cube::EMPTY), positions, colors, stop)
    }

    /// [`Octree::build`] in another cube around the points.
    ///
    /// # Panics
    /// Preconditions: those of [`Octree::build`], and points inside the cube.
    pub fn build_in(cube: Cube, positions: &[Vec3], colors: &[[u8; 4]], stop: StopCriterion) -> Self {
        assert_eq!(positions.len(), colors.len(), "one colour for each point");
        // Enters the thread pool once, instead of for each parallel stage.
        rayon::scope(|_| {
            let points = SortedPoints::new(&cube, positions, colors);
            Self::divided(cube, Arc::new(points), stop)
        })
    }

    /// Returns an octree of the same points divided according to `stop`: the points are shared, and only leaves on
    /// several levels have to be counted.
    #[must_use]
    pub fn with_stop(&self, stop: StopCriterion) -> Self {
        Self::divided(self.cube, Arc::clone(&self.points), stop)
    }

    /// The tree of some points in a cube around them.
    pub(super) fn divided(cube: Cube, points: Arc<SortedPoints>, stop: StopCriterion) -> Self {
        let point_count = points.len();
        let leaves = match stop {
            _ if point_count == 0 => Leaves::OnLevel(0),
            StopCriterion::Spacing => {
                let found = points.leaves_by_spacing();
                let leaves = match found.runs[..] {
                    [run] => Leaves::OnLevel(run.level),
                    _ => Leaves::InRuns(found.runs.into()),
                };
                return Self {
                    // Only trees by the spacing have gaps, as these take six times as long as the rest of the tree (27
                    // blocks of 64 cells are examined for each block): a quarter of the time of the normals.
                    gaps: points.gaps(&leaves).into(),
                    cube,
                    points,
                    leaves,
                    level_counts: found.level_counts,
                    leaf_count: found.leaf_count,
                };
            }
            StopCriterion::Loss(delta) => Leaves::OnLevel(level_of_loss(delta, &points.occupied, point_count)),
            StopCriterion::Depth(depth) => Leaves::OnLevel(depth.min(LEVELS)),
            StopCriterion::PointsPerOctant(max) => Leaves::OfPoints(max as usize),
        };
        Self::with_leaves(cube, points, leaves)
    }

    /// The tree of some points in a cube around them whose leaves are known. Precondition: runs of leaves are those of
    /// a tree.
    pub(super) fn with_leaves(cube: Cube, points: Arc<SortedPoints>, leaves: Leaves) -> Self {
        let (level_counts, leaf_count) = match leaves {
            _ if points.len() == 0 => (Vec::new(), 0),
            Leaves::OnLevel(depth) => {
                let counts = points.occupied[..=depth as usize].to_vec();
                (counts, points.occupied[depth as usize])
            }
            Leaves::InRuns(_) | Leaves::OfPoints(_) => {
                let mut counts = Counts::default();
                let root = NodeRange {
                    level: 0,
                    points: 0..points.len(),
                };
                points.count_nodes_below(&leaves, &root, &mut counts);
                (counts.of_levels, counts.leaves)
            }
        };
        Self {
            cube,
            points,
            leaves,
            level_counts,
            leaf_count,
            gaps: Arc::default(),
        }
    }
}

#[derive(Debug, Default)]
struct Counts {
    of_levels: Vec<usize>,
    leaves: usize,
}

impl SortedPoints {
    /// Counts `node` and all below it. Recursion is bounded by the 21 levels.
    fn count_nodes_below(&self, leaves: &Leaves, node: &NodeRange, counts: &mut Counts) {
        let level = node.level as usize;
        if counts.of_levels.len() == level {
            counts.of_levels.push(0);
        }
        counts.of_levels[level] += 1;
        if self.is_leaf(leaves, node.level, &node.points) {
            counts.leaves += 1;
            return;
        }
        for (_, child) in self.children(node) {
            self.count_nodes_below(leaves, &child, counts);
        }
    }
}
