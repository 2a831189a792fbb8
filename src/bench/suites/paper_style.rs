//! Render styles of the paper.

use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{Primitive, Splatting, Style, VoxelLight};

/// Returns the surfel style of Table II, which also places the viewpoints of Table III, where nothing is drawn.
pub(super) fn surfel_style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.surfels.splatting = Splatting::TwoPassEnlarged;
        style.surfels.enlargement = 2.0;
    })
}

/// Returns the voxel style of Table IV: cells of the paper's δ, lit by their faces, down to a pixel.
pub(super) fn voxel_style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Voxel;
        style.voxels.light = VoxelLight::Faces;
        style.levels.stop = StopCriterion::PAPER;
    })
}

/// Returns [`voxel_style`] drawn down to `lod_px`.
pub(super) fn voxel_style_at(lod_px: f32) -> Style {
    let usual = voxel_style();
    usual.with(|style| style.levels.lod = Lod::ThresholdPx(lod_px))
}
