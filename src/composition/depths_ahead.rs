//! Depths that photographs see, drawn before pictures ask for them.

use super::composed::Composed;
use crate::scene::{Camera, PhotoDepths, PhotoMode, Scene, ScenePacket, Style, UpAxis};
use glam::DVec3;

/// How the depths that photographs see of a frame are drawn.
#[derive(Debug, Clone, Copy)]
pub struct DepthsAhead {
    /// Disks are as large as this says.
    pub style: Style,
    /// Of the positions of the frame.
    pub origin: DVec3,
    /// A renderer.
    pub draw: fn(&ScenePacket) -> PhotoDepths,
}

impl DepthsAhead {
    pub(super) fn drawn(mut self, composed: &Composed) -> PhotoDepths {
        // They depend neither on where the eye is nor on how many photographs are blended.
        self.style.photos.mode = PhotoMode::Vdts;
        let camera = Camera::framing(&composed.frame.frame.bounds(), self.origin, UpAxis::Y);
        let packet = Scene::default().packet(&composed.frame, self.origin, &camera, &self.style, [1; 2]);
        (self.draw)(&packet)
    }
}
