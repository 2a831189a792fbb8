//! Per-sequence style data, which goes with a style and is stored in no file.

use crate::math::Aabb;
use crate::scene::Clip;
use crate::sequence::ColorHints;

/// Per-sequence style data, which goes with a style and is stored in no file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OfSequence {
    /// Colour hints: data besides the frames that colours can depend on.
    pub color_hints: ColorHints,
    /// Bounding box that the ground is below, relative to the origin; all points of a frame if `None`.
    pub ground_box: Option<Aabb>,
    /// True if there are posed images of the scene in the frames.
    pub has_photos: bool,
    /// Clip region: the part of the cloud that is drawn; all if `None`.
    pub clip: Option<Clip>,
}
