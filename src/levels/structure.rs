//! Interface of a level-of-detail structure to its renderers.

use super::cut::{Cut, CutHints, SelectView};
use super::selection::{NodeRecords, Selection};
use crate::cloud::{PointRecord, ShapeRecord, VoxelRecord};
use std::fmt::Debug;

/// Levels of detail of one cloud: the nodes that represent it in a view, and the records drawn for them.
///
/// It is called once per image, so that its inner loops are compiled for one structure.
pub trait Levels: Debug + Send + Sync {
    /// The nodes that represent the cloud in `view`: they cover every leaf that can be seen, none twice.
    fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut;

    /// Writes the records drawn for a cut of these levels, in the memory of `buffers`. Mere decoration of nodes, such
    /// as the cells that close gaps, is omitted if there would be more than `max_records`.
    fn write(&self, cut: &Cut, max_records: usize, buffers: RecordBuffers) -> Records;

    /// Selects the records of the cut as indices into persistent records, for renderers that keep these on the GPU.
    /// `None` if there are no such records, or not yet: see [`Levels::write`]. Only the index memory of `buffers` is
    /// used.
    fn select(&self, _cut: &Cut, _buffers: &mut RecordBuffers) -> Option<Records> {
        None
    }

    /// Returns the records drawn in a view as a per-node filter, for the same kind of renderer, without a cut: see
    /// [`Levels::select`]. The previous view is not used.
    fn filter(&self, _view: &SelectView, _hints: CutHints<'_>) -> Option<Records> {
        None
    }

    /// Returns its size.
    fn size(&self) -> LevelsSize;

    /// The cut of at most `max_nodes` nodes with the smallest LOD threshold from `view.lod_px` up, in steps of a 32nd
    /// of an octave (2 %).
    ///
    /// Cells that the eye is in are always divided, so that around it some more are emitted than a very small number.
    ///
    /// How it works: a higher threshold never emits more, so thresholds are bisected. Counting is cheap compared with
    /// drawing: it reads a byte for each point that is drawn. A previous cut is only remembered for hysteresis where it
    /// still fits: a threshold that emits at least three quarters of the allowed number stays.
    fn cut_at_most(&self, max_nodes: usize, view: &SelectView, hints: CutHints<'_>) -> Cut {
        let cached = hints.before.map(Cut::lod_px);
        if let Some(lod_px) = cached.filter(|&lod_px| lod_px >= view.lod_px) {
            let cut = self.cut(&SelectView { lod_px, ..*view }, hints);
            let is_used_up = cut.node_count() >= max_nodes - max_nodes / 4;
            if cut.node_count() <= max_nodes && (is_used_up || lod_px == view.lod_px) {
                return cut;
            }
        }
        let fresh = CutHints { before: None, ..hints };
        let mut visited_nodes = 0;
        let mut cut_at = |step: u32| {
            let lod_px = threshold_px(view.lod_px, step);
            let cut = self.cut(&SelectView { lod_px, ..*view }, fresh);
            visited_nodes += cut.stats().visited_nodes;
            cut
        };
        let mut best = cut_at(0);
        if best.node_count() > max_nodes {
            let (mut too_fine, mut coarse_enough) = (0, THRESHOLD_STEPS);
            best = cut_at(coarse_enough);
            while coarse_enough - too_fine > 1 {
                let step = too_fine.midpoint(coarse_enough);
                let tried = cut_at(step);
                if tried.node_count() > max_nodes {
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

/// A structure in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct LevelsSize {
    /// All nodes, leaves included.
    pub nodes: usize,
    /// Size in bytes, in addition to the records of the points that it is built from.
    pub bytes: usize,
}

/// Records drawn for a cut, one for each node in the order of the cut.
#[derive(Debug)]
pub enum Records {
    /// Disks: the same number of both.
    Surfels {
        /// Positions and colours.
        points: Vec<PointRecord>,
        /// Normals and radii.
        shapes: Vec<ShapeRecord>,
    },
    /// Disks among those of all nodes, which are the same from cut to cut.
    Selected {
        /// Records of all nodes.
        nodes: NodeRecords,
        /// Selection of the nodes that are drawn.
        selection: Selection,
    },
    /// Cubes.
    Voxels {
        /// Cells and colours.
        voxels: Vec<VoxelRecord>,
        /// A record per voxel, with normals only, where these and not faces are shaded.
        normals: Option<Vec<ShapeRecord>>,
        /// Edge of the cube that is divided.
        cube_edge: f32,
    },
}

/// Memory for [`Records`], of earlier images; its contents do not matter.
#[derive(Debug, Default)]
pub struct RecordBuffers {
    /// For positions and colours.
    pub points: Vec<PointRecord>,
    /// For normals and radii.
    pub shapes: Vec<ShapeRecord>,
    /// For cells.
    pub voxels: Vec<VoxelRecord>,
    /// For indices of nodes.
    pub places: Vec<u32>,
}

/// Thresholds that [`Levels::cut_at_most`] chooses from: up to 16,384 pixels.
const THRESHOLD_STEPS: u32 = STEPS_PER_OCTAVE * 16;
const STEPS_PER_OCTAVE: u32 = 32;

/// The threshold some steps above the lowest, which is taken as it is.
fn threshold_px(lowest_px: f32, step: u32) -> f32 {
    match step {
        0 => lowest_px,
        _ => lowest_px.max(0.25) * (step as f32 / STEPS_PER_OCTAVE as f32).exp2(),
    }
}
