//! The last stage: the composed frame becomes the packet of one image.

use super::composed::Composed;
use crate::scene::{Camera, PhotoDepths, Scene, ScenePacket, Style};
use crate::sequence::PreparedFrame;
use glam::DVec3;
use std::sync::Arc;

/// Viewpoint of an image of a frame.
#[derive(Debug, Clone, Copy)]
pub struct PictureView<'a> {
    /// The camera, in world coordinates.
    pub camera: &'a Camera,
    /// World coordinates that positions of the frame are relative to.
    pub origin: DVec3,
    /// Width and height of the image.
    pub size_px: [u32; 2],
}

/// A composed frame, as a packet needs it.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// The frame.
    pub frame: &'a PreparedFrame,
    /// Depth maps of the frame as seen by the input images, if they were rendered ahead.
    pub depths: Option<&'a Arc<PhotoDepths>>,
}

impl<'a> From<&'a Composed> for Drawn<'a> {
    fn from(composed: &'a Composed) -> Self {
        let coarse = composed.coarse.as_ref().map(|coarse| &coarse.frame);
        Self {
            frame: coarse.unwrap_or(&composed.frame),
            depths: composed.depths.as_ref(),
        }
    }
}

impl<'a> From<&'a PreparedFrame> for Drawn<'a> {
    fn from(frame: &'a PreparedFrame) -> Self {
        Self { frame, depths: None }
    }
}

/// The packet of an image. `scene` remembers the last one, so that an equal one has the same allocations.
pub fn packet<'a>(
    scene: &mut Scene,
    drawn: impl Into<Drawn<'a>>,
    view: &PictureView<'_>,
    style: &Style,
) -> ScenePacket {
    let Drawn { frame, depths } = drawn.into();
    let mut packet = scene.packet(frame, view.origin, view.camera, style, view.size_px);
    if let Some(posed_images) = &mut packet.posed_images {
        posed_images.depths = depths.cloned();
    }
    packet
}
