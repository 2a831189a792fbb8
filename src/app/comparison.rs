//! Two ways to draw one pose side by side, and how far apart their pictures are.
//!
//! How it works: the settings of the window are those of the side that is edited; the other side's are here, with a
//! scene, a packet and what its pictures need of the frame beyond what is prepared. That is completed when it is drawn:
//! it is a way to look at a pose, not to play. Once both pictures have rested for a moment they are read back and
//! compared on a thread.

use super::tasks::{Outcome, Tasks};
use crate::measure::{SizeMismatch, flip, mean_squared_error, psnr_db, ssim};
use crate::render::scaled_to;
use crate::scene::{Camera, FirstLook, Scene, ScenePacket, Settings};
use crate::sequence::{PrepareCounters, PreparedFrame, complete};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// How long both pictures must have been the same before they are compared.
const REST: Duration = Duration::from_millis(250);

/// Pairs of pictures so far, so that the answer for one that has gone is known as such.
static PAIRS: AtomicU64 = AtomicU64::new(0);

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
    /// Both pictures.
    pub pictures: PicturePair,
    scene: Scene,
    /// Completed for the other side.
    frame: Option<PreparedFrame>,
    packet: Option<ScenePacket>,
}

/// Two pictures beside each other.
#[derive(Debug)]
pub struct PicturePair {
    /// Where the line between them is, as a share of the width from the left.
    pub split: f32,
    /// Shows where the pictures differ instead of them.
    pub shows_difference: bool,
    /// How far apart the pictures are, once they have been compared.
    pub difference: Option<PictureDifference>,
    /// When the pictures are to be compared.
    due: Option<Duration>,
    /// Which pair of pictures it is.
    pair: u64,
}

impl Default for PicturePair {
    fn default() -> Self {
        Self {
            split: 0.5,
            shows_difference: false,
            difference: None,
            due: None,
            pair: 0,
        }
    }
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
            pictures: PicturePair::default(),
            scene: Scene::that_remembers(),
            frame: None,
            packet: None,
        }
    }

    /// The packet of the side that is not edited, if it differs from the last one.
    pub(super) fn next_packet(
        &mut self,
        frame: &PreparedFrame,
        origin: DVec3,
        camera: &Camera,
        look: Option<&FirstLook>,
        viewport_px: [u32; 2],
    ) -> Option<ScenePacket> {
        let known = self
            .frame
            .take()
            .filter(|known| Arc::ptr_eq(&known.frame, &frame.frame));
        let other = look.map_or(self.other, |look| self.other.resolved(look));
        let needs = Scene::needs(&other);
        let frame = complete(
            known.as_ref().unwrap_or(frame),
            &needs,
            &PrepareCounters::default(),
        );
        let packet = self
            .scene
            .packet(&frame, origin, camera, &other, viewport_px);
        self.frame = Some(frame);
        if self.packet.as_ref() == Some(&packet) {
            return None;
        }
        self.packet = Some(packet.clone());
        Some(packet)
    }

    /// Forgets what was drawn.
    pub(super) fn forget_picture(&mut self) {
        self.packet = None;
    }
}

impl PicturePair {
    /// Takes notice that one of the pictures is another one at `now`.
    pub(super) fn note_change(&mut self, now: Duration) {
        self.pair = 1 + PAIRS.fetch_add(1, Ordering::Relaxed);
        self.difference = None;
        self.due = Some(now + REST);
    }

    /// Knows no difference any more: the pictures are of different places, or there is only one.
    pub(super) fn forget_difference(&mut self) {
        self.pair = 1 + PAIRS.fetch_add(1, Ordering::Relaxed);
        self.difference = None;
        self.due = None;
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

    /// Compares both pictures on a thread. They may be of different sizes.
    pub(super) fn compare(&self, [a, b]: [RgbaImage; 2], tasks: &Tasks) {
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
        let mut pictures = PicturePair::default();
        let at = Duration::from_millis;
        assert!(!pictures.is_due(at(0)));
        pictures.note_change(at(100));
        pictures.note_change(at(200));
        assert_eq!(pictures.next_deadline(), Some(at(450)));
        assert!(!pictures.is_due(at(449)));
        assert!(pictures.is_due(at(450)));
        assert!(!pictures.is_due(at(900)), "once");
    }

    #[test]
    fn the_answer_for_a_picture_that_has_gone_is_not_taken() {
        let mut pictures = PicturePair::default();
        pictures.note_change(Duration::ZERO);
        let picture = RgbaImage::from_pixel(16, 16, image::Rgba([10, 20, 30, 255]));
        let answer = difference(&picture, picture.clone(), pictures.pair).unwrap();
        assert_eq!(
            (answer.flip, answer.psnr_db, answer.ssim),
            (0.0, f64::INFINITY, Some(1.0))
        );
        pictures.take_in(answer.clone());
        assert!(pictures.difference.is_some());
        pictures.note_change(Duration::ZERO);
        assert!(pictures.difference.is_none());
        pictures.take_in(answer);
        assert!(pictures.difference.is_none());
    }
}
