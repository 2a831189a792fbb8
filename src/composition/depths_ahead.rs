//! Depth maps from the viewpoints of images, drawn before rendering asks for them.

use super::composed::Composed;
use crate::scene::{Camera, PhotoDepths, PhotoMode, Scene, ScenePacket, Style, UpAxis};
use glam::DVec3;

/// Parameters for drawing the depth maps of a frame from the viewpoints of the images.
#[derive(Debug, Clone, Copy)]
pub struct DepthsAhead {
    /// Disks are as large as this says.
    pub style: Style,
    /// Origin of the positions of the frame.
    pub origin: DVec3,
    /// A renderer.
    pub draw: fn(&ScenePacket) -> PhotoDepths,
}

impl DepthsAhead {
    pub(super) fn drawn(mut self, composed: &Composed) -> PhotoDepths {
        // They depend neither on the eye position nor on how many images are blended.
        self.style.photos.mode = PhotoMode::Vdts;
        let camera = Camera::framing(&composed.frame.frame.bounds(), self.origin, UpAxis::Y);
        let packet = Scene::default().packet(&composed.frame, self.origin, &camera, &self.style, [1; 2]);
        (self.draw)(&packet)
    }
}
