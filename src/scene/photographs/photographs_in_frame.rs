//! Photographs of what a packet shows.

use crate::photos::Photographs;
use crate::scene::{Content, PhotoDepths, Surfels};
use glam::DVec3;
use std::sync::Arc;

/// Photographs for the frames of a packet.
#[derive(Debug, Clone)]
pub struct PhotographsInFrame {
    /// The photographs.
    pub photographs: Arc<Photographs>,
    /// What places of the frame are relative to.
    pub origin: DVec3,
    /// All of the surface, whatever of it is drawn: what photographs see of it does not change with the view.
    pub surface: Option<Surfels>,
    /// What photographs see of it, if that was drawn ahead; else who draws the packet does that first.
    pub depths: Option<Arc<PhotoDepths>>,
}

/// Equal if they are the same allocations.
impl PartialEq for PhotographsInFrame {
    fn eq(&self, other: &Self) -> bool {
        let content = |surface: &Option<Surfels>| surface.clone().map_or(Content::Nothing, Content::Surfels);
        Arc::ptr_eq(&self.photographs, &other.photographs)
            && self.origin == other.origin
            && self.depths.as_ref().map(Arc::as_ptr) == other.depths.as_ref().map(Arc::as_ptr)
            && content(&self.surface) == content(&other.surface)
    }
}
