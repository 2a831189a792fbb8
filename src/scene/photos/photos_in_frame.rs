//! Posed images of the scene in a packet.

use crate::photos::PosedImages;
use crate::scene::{Content, PhotoDepths, Surfels};
use glam::DVec3;
use std::sync::Arc;

/// Posed images for the frames of a packet.
#[derive(Debug, Clone)]
pub struct PhotosInFrame {
    /// Posed images.
    pub posed_images: Arc<PosedImages>,
    /// Origin that positions of the frame are relative to.
    pub origin: DVec3,
    /// Complete surface, even if partly drawn: the posed images' view of it does not change with the camera.
    pub surface: Option<Surfels>,
    /// Depth maps of the surface as the posed images see it, if they were drawn ahead; otherwise the renderer of the
    /// packet does that first.
    pub depths: Option<Arc<PhotoDepths>>,
}

/// Equal if they are the same allocations.
impl PartialEq for PhotosInFrame {
    fn eq(&self, other: &Self) -> bool {
        let content = |surface: &Option<Surfels>| surface.clone().map_or(Content::Nothing, Content::Surfels);
        Arc::ptr_eq(&self.posed_images, &other.posed_images)
            && self.origin == other.origin
            && self.depths.as_ref().map(Arc::as_ptr) == other.depths.as_ref().map(Arc::as_ptr)
            && content(&self.surface) == content(&other.surface)
    }
}
