//! Two ways to draw one pose side by side, and how far apart their pictures are.
//!
//! How it works: the settings of the window are those of the side that is edited; the other side's are here, with a scene, a
//! packet and what its pictures need of the frame beyond what is prepared. That is completed when it is drawn: it
//! is a way to look at a pose, not to play. Once both pictures have rested for a moment they are read back and compared on a thread.

use super::tasks::{Outcome, Tasks};
use crate::measure::{SizeMismatch, flip, mean_squared_error, psnr_db, ssim};
use crate::render::scaled_to;
use crate::scene::{Camera, Scene, ScenePacket, Settings};
use crate::sequence::{PrepareCounters, PreparedFrame, complete};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;
use std::time::Duration;

/// How long both pictures must have been the same before they are compared.
const REST: Duration = Duration::from_millis(250);

/// Left or right of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left.
    A,
    /// Right.
    B,
}

/// Another way to draw beside that of the window.
#[derive(Debug)]
pub struct Comparison {
    /// How the side draws that is not edited.
    pub other: Settings,
    /// The side that the settings of the window are of.
    pub edited: Side,
    /// Where the line is, as a share of the picture's width from the left.
    pub split: f32,
    /// Shows where the pictures differ instead of them.
    pub shows_difference: bool,
    /// How far apart the pictures are, once they have been compared.
    pub difference: Option<PictureDifference>,
    scene: Scene,
    /// Completed for the other side.
    frame: Option<PreparedFrame>,
    packet: Option<ScenePacket>,
    /// When the pictures are to be compared.
    due: Option<Duration>,
    /// Counts the pairs of pictures, so that the answer for one that has gone is known as such.
    pair: u64,
}

/// How far B is from A.
#[derive(Debug, Clone)]
pub struct PictureDifference {
    /// Mean FLIP, 0 to 1.
    pub flip: f64,
    /// Infinite for equal pictures.
    pub psnr_db: f64,
    /// `None` for pictures too small for it.
    pub ssim: Option<f64>,
    /// The FLIP error of each pixel in colours.
    pub map: Arc<RgbaImage>,
    pair: u64,
}

impl Comparison {
    /// The same settings on both sides; the right one is edited.
    pub(super) fn new(settings: Settings) -> Self {
        Self {
            other: settings,
            edited: Side::B,
            split: 0.5,
            shows_difference: false,
            difference: None,
            scene: Scene::that_remembers(),
            frame: None,
            packet: None,
            due: None,
            pair: 0,
        }
    }

    /// The packet of the side that is not edited, if it differs from the last one.
    pub(super) fn next_packet(
        &mut self,
        frame: &PreparedFrame,
        origin: DVec3,
        camera: &Camera,
        viewport_px: [u32; 2],
    ) -> Option<ScenePacket> {
        let known = self
            .frame
            .take()
            .filter(|known| Arc::ptr_eq(&known.frame, &frame.frame));
        let needs = Scene::needs(&self.other);
        let frame = complete(
            known.as_ref().unwrap_or(frame),
            &needs,
            &PrepareCounters::default(),
        );
        let packet = self
            .scene
            .packet(&frame, origin, camera, &self.other, viewport_px);
        self.frame = Some(frame);
        if self.packet.as_ref() == Some(&packet) {
            return None;
        }
        self.packet = Some(packet.clone());
        Some(packet)
    }

    /// Takes notice that one of the pictures is another one at `now`.
    pub(super) fn note_change(&mut self, now: Duration) {
        self.pair += 1;
        self.difference = None;
        self.due = Some(now + REST);
    }

    /// Forgets what was drawn.
    pub(super) fn forget_picture(&mut self) {
        self.packet = None;
    }

    /// When the pictures are to be compared.
    pub(super) fn next_deadline(&self) -> Option<Duration> {
        self.due
    }

    /// True once, when the pictures have rested.
    pub(super) fn is_due(&mut self, now: Duration) -> bool {
        let is_due = self.due.is_some_and(|due| due <= now);
        if is_due {
            self.due = None;
        }
        is_due
    }

    /// Compares the picture of the edited side with that of the other on a thread. They may be of different sizes.
    pub(super) fn compare(&self, edited: RgbaImage, other: RgbaImage, tasks: &Tasks) {
        let [a, b] = match self.edited {
            Side::A => [edited, other],
            Side::B => [other, edited],
        };
        let pair = self.pair;
        tasks.start("comparison", move || match difference(&a, b, pair) {
            Ok(difference) => Outcome::Compared(difference),
            Err(error) => Outcome::Failed(error.to_string()),
        });
    }

    /// Takes the answer, unless one of the pictures has changed since.
    pub(super) fn take_in(&mut self, difference: PictureDifference) {
        if difference.pair == self.pair {
            self.difference = Some(difference);
        }
    }
}

fn difference(a: &RgbaImage, b: RgbaImage, pair: u64) -> Result<PictureDifference, SizeMismatch> {
    let b = scaled_to(b, [a.width(), a.height()]);
    let map = flip(a, &b)?;
    Ok(PictureDifference {
        flip: map.mean(),
        psnr_db: psnr_db(mean_squared_error(a, &b)?),
        ssim: ssim(a, &b).ok(),
        map: Arc::new(map.to_heatmap()),
        pair,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_compared_once_they_rest() {
        let mut comparison = Comparison::new(Settings::default());
        let at = Duration::from_millis;
        assert!(!comparison.is_due(at(0)));
        comparison.note_change(at(100));
        comparison.note_change(at(200));
        assert_eq!(comparison.next_deadline(), Some(at(450)));
        assert!(!comparison.is_due(at(449)));
        assert!(comparison.is_due(at(450)));
        assert!(!comparison.is_due(at(900)), "once");
    }

    #[test]
    fn the_answer_for_a_picture_that_has_gone_is_not_taken() {
        let mut comparison = Comparison::new(Settings::default());
        comparison.note_change(Duration::ZERO);
        let picture = RgbaImage::from_pixel(16, 16, image::Rgba([10, 20, 30, 255]));
        let answer = difference(&picture, picture.clone(), 1).unwrap();
        assert_eq!(
            (answer.flip, answer.psnr_db, answer.ssim),
            (0.0, f64::INFINITY, Some(1.0))
        );
        comparison.take_in(answer.clone());
        assert!(comparison.difference.is_some());
        comparison.note_change(Duration::ZERO);
        assert!(comparison.difference.is_none());
        comparison.take_in(answer);
        assert!(comparison.difference.is_none());
    }
}
