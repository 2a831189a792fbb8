//! Two render modes of one frame side by side, and the difference of their images.
//!
//! How it works: the settings of the window belong to the edited side; the other side's are here, with a scene, a
//! packet and the data that its images need beyond the prepared frame. These are completed when it is drawn: it is for
//! examining a frame, not for playback. Once both images have been stable for a short time they are read back and
//! compared on a thread.

mod in_window;
mod pair;
pub(in crate::app) mod panel;

pub use pair::{PictureDifference, PicturePair};

use crate::app::side::Side;
use crate::composition::{Drawn, PictureView, packet};
use crate::scene::{Scene, ScenePacket, Settings, Style};
use crate::sequence::{PrepareCounters, PreparedFrame, complete};
use std::sync::Arc;

/// Second render mode, alongside the window's.
#[derive(Debug)]
pub struct Comparison {
    /// Settings of the side that is not edited.
    pub other: Settings,
    /// The side that the settings of the window are of.
    pub edited: Side,
    /// Both images.
    pub pictures: PicturePair,
    scene: Scene,
    /// Completed for the other side.
    frame: Option<PreparedFrame>,
    packet: Option<ScenePacket>,
}

impl Comparison {
    /// Creates a comparison with equal settings on both sides; the right one is edited.
    pub(in crate::app) fn new(style: Settings) -> Self {
        Self {
            other: style,
            edited: Side::B,
            pictures: PicturePair::default(),
            scene: Scene::that_remembers(),
            frame: None,
            packet: None,
        }
    }

    /// The packet of the side that is not edited, if it differs from the last one.
    pub(in crate::app) fn next_packet(
        &mut self,
        frame: &PreparedFrame,
        view: &PictureView<'_>,
        style: &Style,
    ) -> Option<ScenePacket> {
        let posed_images = |frame: &PreparedFrame| frame.posed_images.as_ref().map(Arc::as_ptr);
        let is_known = |known: &PreparedFrame| {
            Arc::ptr_eq(&known.frame, &frame.frame) && posed_images(known) == posed_images(frame)
        };
        let known = self.frame.take().filter(is_known);
        let needs = Scene::needs(style);
        let frame = complete(known.as_ref().unwrap_or(frame), &needs, &PrepareCounters::default());
        let packet = packet(&mut self.scene, Drawn::from(&frame), view, style);
        self.frame = Some(frame);
        if self.packet.as_ref() == Some(&packet) {
            return None;
        }
        self.packet = Some(packet.clone());
        Some(packet)
    }

    /// Forgets the drawn image.
    pub(in crate::app) fn forget_picture(&mut self) {
        self.packet = None;
    }
}
