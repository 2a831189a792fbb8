//! What goes with a style and belongs to one sequence: it is kept in no file.

use crate::math::Aabb;
use crate::scene::Clip;
use crate::sequence::ColorHints;

/// What goes with a style and belongs to one sequence: it is kept in no file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OfSequence {
    /// What colours can depend on beside the frames.
    pub color_hints: ColorHints,
    /// What the ground is below, relative to the origin; all points of a frame if `None`.
    pub ground_box: Option<Aabb>,
    /// Whether there are photographs of what the frames show.
    pub has_photographs: bool,
    /// What of the cloud is drawn; all if `None`.
    pub clip: Option<Clip>,
}
