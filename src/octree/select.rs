//! Which voxels stand for the cloud in one view (paper 000 §VI-B).

use super::Octree;
use crate::{
    cloud::VoxelRecord,
    math::{Frustum, morton::LEVELS},
};
use glam::Vec3;

/// What a view needs of the octree. Positions are in the space of the frame (relative to the sequence origin).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectView {
    /// Cells outside are dropped.
    pub frustum: Frustum,
    /// Where distances are measured from.
    pub eye: Vec3,
    /// A length `s` at distance `d` covers about `s * pixels_per_unit_at_1 / d` pixels.
    pub pixels_per_unit_at_1: f32,
    /// A cell whose edge covers less is not divided further; 0 (or less) always descends to the leaves.
    pub lod_px: f32,
    /// Cells of this level are not divided either; [`SelectView::ALL_LEVELS`] divides down to the leaves.
    pub deepest_level: u32,
}

impl SelectView {
    /// No limit to the level.
    pub const ALL_LEVELS: u32 = LEVELS;
}

/// What a traversal did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SelectStats {
    /// Nodes that were tested or emitted.
    pub visited_nodes: usize,
    /// Voxels written.
    pub emitted: usize,
}

impl Octree {
    /// Replaces the contents of `out` by the voxels that stand for the cloud in `view`.
    ///
    /// They cover every leaf that can be seen, none twice: an emitted node stands for all leaves under it.
    pub fn select(&self, view: &SelectView, out: &mut Vec<VoxelRecord>) -> SelectStats {
        let cut = self.traverse(view);
        self.write_voxels(&cut.ranges, out);
        SelectStats {
            visited_nodes: cut.visited_nodes(out.len()),
            emitted: out.len(),
        }
    }

    /// Replaces the contents of `out` by at most `most_voxels` voxels: those of the smallest LOD threshold from `view.lod_px`
    /// up, in steps of a 32nd of an octave (2 %), that draws no more. Returns that threshold in pixels too.
    ///
    /// Cells that the eye is in are always divided, so that around it some more are drawn than a very small number.
    ///
    /// How it works: a higher threshold never draws more, so thresholds are bisected. Counting is cheap beside writing:
    /// it reads a byte for each point that is drawn.
    pub fn select_at_most(
        &self,
        most_voxels: usize,
        view: &SelectView,
        out: &mut Vec<VoxelRecord>,
    ) -> (SelectStats, f32) {
        let mut visited_nodes = 0;
        let mut cut_at = |step: u32| {
            let lod_px = threshold_px(view.lod_px, step);
            let cut = self.traverse(&SelectView { lod_px, ..*view });
            let count = self.points.count_nodes(&cut.ranges);
            visited_nodes += cut.visited_nodes(count);
            (cut, count, lod_px)
        };
        let mut best = cut_at(0);
        if best.1 > most_voxels {
            let (mut too_fine, mut coarse_enough) = (0, THRESHOLD_STEPS);
            best = cut_at(coarse_enough);
            while coarse_enough - too_fine > 1 {
                let step = too_fine.midpoint(coarse_enough);
                let tried = cut_at(step);
                if tried.1 > most_voxels {
                    too_fine = step;
                } else {
                    coarse_enough = step;
                    best = tried;
                }
            }
        }
        let (cut, emitted, lod_px) = best;
        self.write_voxels(&cut.ranges, out);
        let stats = SelectStats {
            visited_nodes,
            emitted,
        };
        (stats, lod_px)
    }
}

/// Thresholds that [`Octree::select_at_most`] chooses from: up to 16,384 pixels.
const THRESHOLD_STEPS: u32 = STEPS_PER_OCTAVE * 16;
const STEPS_PER_OCTAVE: u32 = 32;

/// The threshold some steps above the lowest, which is taken as it is.
fn threshold_px(lowest_px: f32, step: u32) -> f32 {
    match step {
        0 => lowest_px,
        _ => lowest_px.max(0.25) * (step as f32 / STEPS_PER_OCTAVE as f32).exp2(),
    }
}
