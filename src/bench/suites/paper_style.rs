//! How the paper draws.

use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{Primitive, Splatting, Style, VoxelLight};

/// How Table II draws, and by what the viewpoints of Table III are placed, which draws nothing.
pub(super) fn surfel_style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.surfels.splatting = Splatting::TwoPassEnlarged;
        style.surfels.enlargement = 2.0;
    })
}

/// How Table IV draws: cells of the paper's δ, lit by their faces, down to a pixel.
pub(super) fn voxel_style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Voxel;
        style.voxels.light = VoxelLight::Faces;
        style.levels.stop = StopCriterion::PAPER;
    })
}

/// The same, drawn down to `lod_px`.
pub(super) fn voxel_style_at(lod_px: f32) -> Style {
    let usual = voxel_style();
    usual.with(|style| style.levels.lod = Lod::ThresholdPx(lod_px))
}
