//! Leaves no smaller than the spacing of the points around them: these make cubes a closed solid.
//!
//! How it works: leaves are on the deepest level whose cells are closed, together with the gaps between them
//! (`gaps.rs`). While a level is as dense as the surface, it has four times the cells of the level above; where points
//! are too few for that, cells are left empty, and once it has less than twice as many there are more empty ones in a
//! row than can be closed. Curves have twice the cells at best, so for them, as for all dense clouds, the number of
//! points per cell decides. Leaves are one to two and a half spacings long.
//!
//! Spacings differ within a cloud, by a hundred times in the sweep of a scanner. So the test is made for the root, for
//! its octants, and so on, as long as there are enough points. A node keeps the level that it inherits unless that is
//! clearly wrong for it: sizes that change from cell to cell with the noise of sampling are worse to look at than one
//! that is slightly off (the 4D media paper, Fig. 5). Few points far from all others are never tested, so none becomes
//! a cube that hides the cloud.
//!
//! Points at the same place count once, and so do those that are much nearer to each other than all are to the rest, as
//! where two scans of one surface are laid on each other.
//!
//! Measured for bodies of 8,000 to 100,000 points (`tests/pictures/closed_voxels.rs`): leaves and gaps cover 99.4 % and
//! more of the area of surfels. Without the gaps it took cells of 2.5 points on average and more to cover as much,
//! which are twice as long and extend beyond the outline by two to three times as much.
//!
//! When it wins: everything is read off running counts of the parting levels, one pass over a byte a point.

use super::sorted_points::SortedPoints;
use super::stop::{LeafRun, OccupiedCells};
use crate::levels::cut::NodeRange;
use crate::math::morton::LEVELS;
use rayon::prelude::*;

/// Cells that hold this many points on average have hardly a hole.
const MANY_POINTS: f64 = 2.5;

/// Cells of a surface that hold fewer are closed by the gaps between them (`gaps.rs`) while they are this many times as
/// many as the cells of the level above; all of them would be four times as many.
// Without gaps, cells had to be twice as long, and their outline extended beyond the surfels by 5 to 11 % of the
// object instead of 2.5 to 5 %. Below one spacing nothing closes them.
const GROWTH: f64 = 2.0;

/// Occupancy threshold in points per cell: if fewer points share a cell, the number of cells is not a measure of their
/// size.
const FEW_POINTS: f64 = 1.12;

/// An inherited level stays if it has this fraction of the ratio required of a closed one,
const SPARSE: f64 = 0.85;

/// and the level below it has less than this many times that ratio.
const DENSE: f64 = 1.25;

/// Fewer points do not determine their spacing.
const ASKED_POINTS: usize = 64;

/// A node without cells of this many levels above the leaves is not tested: too few cells to take a mean over.
const ASKED_LEVELS: u32 = 2;

/// Leaves are at most this many levels above those of the whole cloud: 4 times their edge. Few points in a large
/// volume, as in the trees that a scanner sees from afar, would require more.
const MAX_LEVELS_ABOVE: u32 = 2;

/// Points counted together.
const GROUP: usize = 64;

const LEVEL_COUNT: usize = LEVELS as usize + 1;

/// The leaves of a tree by spacing, and its nodes.
#[derive(Debug, Default)]
pub(super) struct LeavesBySpacing {
    /// In Morton order; neighbours are on different levels.
    pub(super) runs: Vec<LeafRun>,
    /// Nodes of each level, the leaves included.
    pub(super) level_counts: Vec<usize>,
    pub(super) leaf_count: usize,
}

/// Cumulative counts of the points that part at each level before every group of them.
struct Census<'a> {
    partings: &'a [u8],
    before: Vec<[u32; LEVEL_COUNT]>,
}

impl<'a> Census<'a> {
    fn new(partings: &'a [u8]) -> Self {
        let mut before: Vec<[u32; LEVEL_COUNT]> = partings
            .par_chunks(GROUP)
            .with_min_len(256)
            .map(|group| {
                let mut counts = [0; LEVEL_COUNT];
                add(&mut counts, group);
                counts
            })
            .collect();
        let mut sums = [0; LEVEL_COUNT];
        for counts in &mut before {
            let here = *counts;
            *counts = sums;
            for (sum, count) in sums.iter_mut().zip(here) {
                *sum += count;
            }
        }
        before.push(sums);
        Self { partings, before }
    }

    /// Returns the counts of points before `point` that part at each level.
    fn before(&self, point: usize) -> [u32; LEVEL_COUNT] {
        let group = point / GROUP;
        let mut counts = self.before[group];
        add(&mut counts, &self.partings[GROUP * group..point]);
        counts
    }

    /// Occupied cells of every level in a node; 1 above it.
    fn cells_in(&self, node: &NodeRange) -> OccupiedCells {
        let [start, end] = [node.points.start + 1, node.points.end].map(|point| self.before(point));
        let mut cells = 1;
        std::array::from_fn(|level| {
            cells += (end[level] - start[level]) as usize;
            cells
        })
    }
}

/// Points that share a finest cell with the one before them part on none of the levels.
fn add(counts: &mut [u32; LEVEL_COUNT], partings: &[u8]) {
    for &parting in partings {
        if let Some(count) = counts.get_mut(usize::from(parting)) {
            *count += 1;
        }
    }
}

/// Points that count: where the cells of a level are hardly divided by the next two, each is a point, though some have
/// several close together. Cells of a curve are divided into four by two levels, those of a surface into sixteen.
fn distinct_points(cells: &OccupiedCells) -> usize {
    /// More points than that are not one place but a part of the cloud.
    const MAX_TOGETHER: usize = 8;
    let all = cells[LEVELS as usize];
    let are_points = |level: &usize| {
        let here = cells[*level];
        // Some points that belong together are separated by a face of a cell.
        all <= MAX_TOGETHER * here && 100 * cells[level + 2] <= 112 * here + 200
    };
    let level = (0..LEVEL_COUNT - 2).find(are_points);
    level.map_or(all, |level| cells[level + 2])
}

/// Returns true if the cells of a level and the gaps between them are closed: `share` times the required amount.
fn are_closed(cells: &OccupiedCells, level: usize, share: f64) -> bool {
    let points = distinct_points(cells) as f64;
    let (here, above) = (cells[level] as f64, cells[level.saturating_sub(1)] as f64);
    let points_a_cell = points / here;
    points_a_cell >= share * MANY_POINTS || (points_a_cell >= FEW_POINTS && here >= share * GROWTH * above)
}

/// The deepest level that is closed.
fn level_of_spacing(cells: &OccupiedCells) -> u32 {
    let level = (0..LEVEL_COUNT).rfind(|&level| are_closed(cells, level, 1.0));
    level.unwrap_or(0) as u32
}

/// Returns true if leaves may be on `level` where they would be if this was all of the cloud.
fn is_cached(level: u32, cells: &OccupiedCells) -> bool {
    let level = level as usize;
    are_closed(cells, level, SPARSE) && (level + 1 == LEVEL_COUNT || !are_closed(cells, level + 1, DENSE))
}

impl SortedPoints {
    /// The leaves that the spacing of the points requires. Precondition: there are points.
    pub(super) fn leaves_by_spacing(&self) -> LeavesBySpacing {
        let census = Census::new(&self.partings);
        let root = NodeRange {
            level: 0,
            points: 0..self.len(),
        };
        let level = level_of_spacing(&self.occupied);
        let mut found = LeavesBySpacing::default();
        let search = Search {
            points: self,
            census,
            coarsest: level.saturating_sub(MAX_LEVELS_ABOVE),
        };
        search.visit(&root, level, &mut found);
        found
    }
}

struct Search<'a> {
    points: &'a SortedPoints,
    census: Census<'a>,
    /// No leaf is above this level.
    coarsest: u32,
}

impl Search<'_> {
    /// Adds the leaves below a node whose parent would have them on the level `inherited`. Recursion is bounded by the
    /// 21 levels.
    fn visit(&self, node: &NodeRange, inherited: u32, found: &mut LeavesBySpacing) {
        let cells = self.census.cells_in(node);
        let is_asked = node.points.len() >= ASKED_POINTS;
        // Inherited unless clearly wrong, so that sizes do not follow the sampling noise; and nodes with few points
        // always inherit, so that a far outlier does not become a giant cube.
        let level = if !is_asked || is_cached(inherited, &cells) {
            inherited
        } else {
            level_of_spacing(&cells).max(self.coarsest)
        };
        let level = level.max(node.level);
        if !is_asked || level < node.level + ASKED_LEVELS {
            found.add(node, level, &cells);
            return;
        }
        found.count(node.level, 1);
        for (_, child) in self.points.children(node) {
            self.visit(&child, level, found);
        }
    }
}

impl LeavesBySpacing {
    fn count(&mut self, level: u32, nodes: usize) {
        let level = level as usize;
        if self.level_counts.len() <= level {
            self.level_counts.resize(level + 1, 0);
        }
        self.level_counts[level] += nodes;
    }

    /// Adds a node and all below it, down to the leaves.
    fn add(&mut self, node: &NodeRange, leaf_level: u32, cells: &OccupiedCells) {
        for level in node.level..=leaf_level {
            self.count(level, cells[level as usize]);
        }
        self.leaf_count += cells[leaf_level as usize];
        LeafRun::push(&mut self.runs, node.points.end, leaf_level);
    }
}
