//! Gap filling: cells without points that are drawn between leaves, to close surfaces whose cells are about as small as
//! the spacing.
//!
//! How it works: some cells that a surface crosses hold no point, as points are random or the surface only
//! grazes them, and the background shows through. Those that touch a leaf and are found by morphological closing
//! (`closing.rs`) are gaps, and are drawn as that leaf is, where the leaf is in the cut. No gap is beyond the outline
//! of the points.
//!
//! Its cost compared with the rest of the tree is measured in `benches/octree.rs`.

use super::closing::{LevelCells, neighbour};
use super::gap::Gap;
use super::sorted_points::SortedPoints;
use super::stop::{LeafRun, Leaves};
use super::tree::Octree;
use super::write::{BATCH, NodeWriter, Nodes};
use crate::levels::cut::Cut;
use bytemuck::Zeroable as _;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Batches that are worth handing to another thread.
const BATCHES_PER_TASK: usize = 64;

impl SortedPoints {
    /// The gaps between some leaves, by the first points of those that they are drawn as.
    pub(super) fn gaps(&self, leaves: &Leaves) -> Vec<Gap> {
        let whole;
        let runs = match leaves {
            Leaves::OnLevel(level) => {
                whole = [LeafRun {
                    end: self.len() as u32,
                    level: *level,
                }];
                &whole[..]
            }
            Leaves::InRuns(runs) => runs,
            Leaves::OfPoints(_) => &[],
        };
        let mut levels: Vec<u32> = runs.iter().map(|run| run.level).collect();
        levels.sort_unstable();
        levels.dedup();
        let mut gaps: Vec<Gap> = levels
            .into_iter()
            .flat_map(|level| LevelCells::of_level(self, level, runs).gaps())
            .collect();
        gaps.par_sort_unstable_by_key(|gap| (gap.leaf[0], gap.direction));
        gaps
    }
}

impl Octree {
    /// The coordinates of a gap on its level.
    pub(super) fn cell_of_gap(&self, gap: &Gap) -> [u32; 3] {
        let first = self.points.cells[gap.leaf[0] as usize];
        let leaf = [0, 1, 2].map(|axis| first.coordinate(axis, gap.level.into()));
        // No gap is outside the root.
        neighbour(leaf, gap.direction.into()).unwrap_or(leaf)
    }

    /// The gaps between the leaves that are in a cut, which are to be drawn with them.
    pub fn gaps_of(&self, cut: &Cut) -> Vec<Gap> {
        let mut found = Vec::new();
        for range in &cut.ranges {
            let from = |point: usize| self.gaps.partition_point(|gap| (gap.leaf[0] as usize) < point);
            let gaps = &self.gaps[from(range.points.start)..from(range.points.end)];
            found.extend(gaps.iter().filter(|gap| u32::from(gap.level) == range.level));
        }
        found
    }
}

/// Adds the records of gaps: the records of the adjacent leaves.
pub(super) fn add_gaps<W: NodeWriter>(gaps: &[Gap], writer: &W, out: &mut Vec<W::Record>) {
    let before = out.len();
    out.resize(before + gaps.len(), W::Record::zeroed());
    let batches = out[before..].par_chunks_mut(BATCH).zip(gaps.par_chunks(BATCH));
    batches.with_min_len(BATCHES_PER_TASK).for_each(|(out, gaps)| {
        let mut values = [[0; BATCH]; 3];
        for (index, gap) in gaps.iter().enumerate() {
            let [first, end] = gap.leaf;
            for (values, value) in values.iter_mut().zip([first, end, gap.level.into()]) {
                values[index] = value;
            }
        }
        let [firsts, ends, levels] = &values;
        let nodes = Nodes { firsts, ends, levels };
        dispatch!(Level::new(), _simd => writer.write(&nodes, out));
    });
}
