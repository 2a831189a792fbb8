//! Choices of a person about what is made of a frame, the same for all frames.

use super::change::ChangeColors;
use super::onion::OnionSkin;
use super::trails::{TrailLook, Trails};
use std::sync::Arc;

/// Additions to each pose.
#[derive(Debug, Clone, Default)]
pub struct ComposeOptions {
    /// The colours of points.
    pub change: Option<ChangeColors>,
    /// Neighbouring poses.
    pub onion: Option<OnionSkin>,
    /// The ways of points, and how each is drawn.
    pub trails: Option<(Arc<Trails>, Vec<TrailLook>)>,
    /// Photographs that are not put on surfaces, by their numbers.
    pub left_out_photos: Vec<usize>,
}

impl ComposeOptions {
    /// A pose as it is.
    pub const NONE: Self = Self {
        change: None,
        onion: None,
        trails: None,
        left_out_photos: Vec::new(),
    };
}
