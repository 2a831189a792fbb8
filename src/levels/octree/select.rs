//! Which voxels stand for the cloud in one view (paper 000 §VI-B).

use super::{Octree, cut::Cut, cut::CutHints};
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
    /// Nodes emitted.
    pub emitted: usize,
}

impl Octree {
    /// Replaces the contents of `out` by the voxels that stand for the cloud in `view`: those of [`Octree::cut`].
    pub fn select(&self, view: &SelectView, out: &mut Vec<VoxelRecord>) -> SelectStats {
        let cut = self.cut(view, CutHints::default());
        self.write_voxels(&cut, out);
        cut.stats()
    }

    /// The cut of at most `most_nodes` nodes with the smallest LOD threshold from `view.lod_px` up, in steps of a 32nd
    /// of an octave (2 %).
    ///
    /// Cells that the eye is in are always divided, so that around it some more are emitted than a very small number.
    ///
    /// How it works: a higher threshold never emits more, so thresholds are bisected. Counting is cheap beside drawing:
    /// it reads a byte for each point that is drawn. A cut before is only remembered for hysteresis where it still
    /// fits: a threshold that emits at least three quarters of what is allowed stays.
    pub fn cut_at_most(&self, most_nodes: usize, view: &SelectView, hints: CutHints<'_>) -> Cut {
        let kept = hints.before.map(Cut::lod_px);
        if let Some(lod_px) = kept.filter(|&lod_px| lod_px >= view.lod_px) {
            let cut = self.cut(&SelectView { lod_px, ..*view }, hints);
            let is_used_up = cut.node_count() >= most_nodes - most_nodes / 4;
            if cut.node_count() <= most_nodes && (is_used_up || lod_px == view.lod_px) {
                return cut;
            }
        }
        let anew = CutHints {
            before: None,
            ..hints
        };
        let mut visited_nodes = 0;
        let mut cut_at = |step: u32| {
            let lod_px = threshold_px(view.lod_px, step);
            let cut = self.cut(&SelectView { lod_px, ..*view }, anew);
            visited_nodes += cut.stats().visited_nodes;
            cut
        };
        let mut best = cut_at(0);
        if best.node_count() > most_nodes {
            let (mut too_fine, mut coarse_enough) = (0, THRESHOLD_STEPS);
            best = cut_at(coarse_enough);
            while coarse_enough - too_fine > 1 {
                let step = too_fine.midpoint(coarse_enough);
                let tried = cut_at(step);
                if tried.node_count() > most_nodes {
                    too_fine = step;
                } else {
                    coarse_enough = step;
                    best = tried;
                }
            }
        }
        best.tested.nodes += visited_nodes - best.stats().visited_nodes;
        best
    }
}

/// Thresholds that [`Octree::cut_at_most`] chooses from: up to 16,384 pixels.
const THRESHOLD_STEPS: u32 = STEPS_PER_OCTAVE * 16;
const STEPS_PER_OCTAVE: u32 = 32;

/// The threshold some steps above the lowest, which is taken as it is.
fn threshold_px(lowest_px: f32, step: u32) -> f32 {
    match step {
        0 => lowest_px,
        _ => lowest_px.max(0.25) * (step as f32 / STEPS_PER_OCTAVE as f32).exp2(),
    }
}
