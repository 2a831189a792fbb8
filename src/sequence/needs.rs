//! What a picture needs of a frame: what is not needed is not computed.

use super::{ColorHints, Coloring};
use crate::levels::octree::StopCriterion;

/// What a picture needs of a frame beyond its points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Needs {
    /// Normals and radii: for surfels.
    pub shapes: bool,
    /// Ellipses in the shapes, where radii are estimated. Off for drawing, which shows circles: they take twice as
    /// long as radii.
    pub ellipses: bool,
    /// An octree of this depth: for voxels, levels of detail and picking.
    pub octree: Option<StopCriterion>,
    /// The byte code of the octree with attributes, where shapes and an octree are asked for: for footprints from
    /// masks.
    pub coded: bool,
    /// The colours of points and voxels.
    pub colors: Coloring,
    /// What is known beyond the frames that colours can depend on.
    pub hints: ColorHints,
}

impl Needs {
    /// Whether byte codes are asked for, and all that they are made of.
    pub(super) fn asks_for_codes(&self) -> bool {
        self.coded && self.shapes && self.octree.is_some()
    }
}
