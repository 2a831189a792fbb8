//! How the paper draws.

use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{LevelStyle, Primitive, Splatting, Style, SurfelStyle, VoxelLight, VoxelStyle};

/// How Table II draws, and by what the viewpoints of Table III are placed, which draws nothing.
pub(super) fn surfel_style() -> Style {
    Style {
        primitive: Primitive::Surfel,
        surfels: SurfelStyle {
            splatting: Splatting::TwoPassEnlarged,
            enlargement: 2.0,
            ..SurfelStyle::default()
        },
        ..Style::default()
    }
}

/// How Table IV draws: cells of the paper's δ, lit by their faces, down to a pixel.
pub(super) fn voxel_style() -> Style {
    Style {
        primitive: Primitive::Voxel,
        voxels: VoxelStyle {
            light: VoxelLight::Faces,
        },
        levels: LevelStyle {
            stop: StopCriterion::PAPER,
            ..LevelStyle::default()
        },
        ..Style::default()
    }
}

/// The same, drawn down to `lod_px`.
pub(super) fn voxel_style_at(lod_px: f32) -> Style {
    let usual = voxel_style();
    Style {
        levels: LevelStyle {
            lod: Lod::ThresholdPx(lod_px),
            ..usual.levels
        },
        ..usual
    }
}
