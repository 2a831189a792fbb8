//! When subdivision ends.

use crate::math::morton::LEVELS;
use std::ops::Range;
use std::sync::Arc;

/// Number of occupied cells of every level, the root's level first.
pub(super) type OccupiedCells = [usize; LEVELS as usize + 1];

/// Stop criterion for the depth of an octree.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StopCriterion {
    /// Leaves are no smaller than the spacing of the points around them, so that cubes are closed surfaces: on one
    /// level where points are spread evenly, on several where they are not. See `octree/spacing.rs`.
    // The default, as δ gives nearly every point a leaf smaller than its share of the surface: a spray of dots.
    #[default]
    Spacing,
    /// The δ of the 4D media paper (§VI-A): level h is subdivided while `oct(h)/n < 1 − δ`, where `oct(h)` counts its
    /// occupied cells.
    ///
    /// δ is clamped to 0..=1 and NaN counts as 0; the interface offers 0 to 0.6. Subdivision also ends where no finer
    /// level of the 21 separates any two points, so that duplicates (which no cell size can part) do not drive δ = 0 to
    /// the bottom.
    Loss(f32),
    /// All leaves on this level, at most 21.
    Depth(u32),
    /// A cell is divided while it holds more than this many points (0 counts as 1), so leaves are on several levels:
    /// the paper's Fig. 5 shows their incoherent voxel sizes.
    PointsPerOctant(u32),
}

impl StopCriterion {
    /// The δ of 5 % that the paper found good for its sequences: most points have a leaf of their own.
    pub const PAPER: Self = Self::Loss(0.05);

    /// Returns the stop criterion for surfels, whose leaves are drawn as the points that they hold: leaves that are as
    /// large as the spacing would deprive them of the finest levels of detail.
    #[must_use]
    pub fn of_surfels(self) -> Self {
        match self {
            Self::Spacing => Self::PAPER,
            Self::Loss(_) | Self::Depth(_) | Self::PointsPerOctant(_) => self,
        }
    }
}

/// Location of the leaves of a tree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Leaves {
    /// All on one level.
    OnLevel(u32),
    /// On several, which are known: runs of leaves in Morton order, the last ending with the last point.
    InRuns(Arc<[LeafRun]>),
    /// Wherever a cell holds at most this many points.
    OfPoints(usize),
}

impl Leaves {
    /// The level of all leaves that have one of some points; `None` if there are several, or they are not known.
    /// Precondition: the points are those of a node that is a leaf or above the leaves, or some of them.
    #[inline]
    pub(super) fn only_level(&self, points: &Range<usize>) -> Option<u32> {
        match self {
            Self::OnLevel(level) => Some(*level),
            Self::InRuns(runs) => {
                let run = runs.partition_point(|run| run.end <= points.start as u32);
                let run = runs.get(run)?;
                (run.end as usize >= points.end).then_some(run.level)
            }
            Self::OfPoints(_) => None,
        }
    }
}

/// Consecutive leaves of one level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LeafRun {
    /// The point after their last.
    pub(super) end: u32,
    pub(super) level: u32,
}

impl LeafRun {
    /// Adds leaves of a level that end before the point `end` to those before them.
    pub(super) fn push(runs: &mut Vec<Self>, end: usize, level: u32) {
        let end = end as u32;
        match runs.last_mut() {
            Some(last) if last.level == level => last.end = end,
            _ => runs.push(Self { end, level }),
        }
    }
}

/// The first level that need not be subdivided for a loss of `delta`.
pub(super) fn level_of_loss(delta: f32, occupied: &OccupiedCells, point_count: usize) -> u32 {
    let delta = if delta.is_nan() { 0.0 } else { delta.clamp(0.0, 1.0) };
    let cached = 1.0 - f64::from(delta);
    let enough = cached * point_count as f64;
    let distinct = occupied[LEVELS as usize];
    (0..LEVELS)
        .find(|&level| {
            let cells = occupied[level as usize];
            cells as f64 >= enough || cells == distinct
        })
        .unwrap_or(LEVELS)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(delta: f32, first_levels: &[usize], point_count: usize) -> u32 {
        let last = first_levels[first_levels.len() - 1];
        let mut occupied = [last; LEVELS as usize + 1];
        occupied[..first_levels.len()].copy_from_slice(first_levels);
        level_of_loss(delta, &occupied, point_count)
    }

    #[test]
    fn the_depth_is_the_first_level_with_acceptable_loss() {
        let levels = [1, 8, 50, 90, 95, 98, 100];
        assert_eq!(depth(0.5, &levels, 100), 2);
        assert_eq!(depth(0.49, &levels, 100), 3);
        assert_eq!(depth(0.05, &levels, 100), 4);
        assert_eq!(depth(0.0, &levels, 100), 6);
        assert_eq!(depth(1.0, &levels, 100), 0);
    }

    #[test]
    fn duplicates_do_not_force_the_maximum_depth() {
        assert_eq!(depth(0.0, &[1, 4, 40], 100), 2);
        assert_eq!(depth(0.0, &[1], 100), 0);
    }

    #[test]
    fn out_of_range_deltas_are_handled() {
        let levels = [1, 8, 50, 100];
        assert_eq!(depth(f32::NAN, &levels, 100), 3);
        assert_eq!(depth(-3.0, &levels, 100), 3);
        assert_eq!(depth(7.0, &levels, 100), 0);
    }
}
