//! Levels of detail: how deep the octree goes, and which of its cells are drawn.

use crate::levels::Lod;
use crate::levels::octree::StopCriterion;

/// How deep the octree goes, and which of its cells are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct LevelStyle {
    /// How deep the octree goes: as far as voxels are closed, or as is said; a loss δ is offered from 0 to 0.6.
    pub stop: StopCriterion,
    /// Which of its cells are drawn.
    pub lod: Lod,
    /// Surfels stand for cells of the octree, as [`LevelStyle::lod`] says, where they are small; else all points are
    /// drawn.
    pub surfel_lod: bool,
}
