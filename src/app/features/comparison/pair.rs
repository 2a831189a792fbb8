//! Two images, and their difference.

use crate::app::work::outcome::Message;
use crate::app::work::tasks::{TaskFailed, TaskOutcome, Tasks};
use crate::measure::{SizeMismatch, flip, mean_squared_error, psnr_db, ssim};
use crate::render::scaled_to;
use image::RgbaImage;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Time for which both images must have been unchanged before they are compared.
const REST: Duration = Duration::from_millis(250);

/// Number of image pairs so far, to recognise results for a replaced pair.
static PAIRS: AtomicU64 = AtomicU64::new(0);

/// Pair of images next to each other.
#[derive(Debug)]
pub struct PicturePair {
    /// Position of the dividing line between them, as a fraction of the width from the left.
    pub split: f32,
    /// Shows the difference instead of the images.
    pub shows_difference: bool,
    /// Difference of the images, once they have been compared.
    pub difference: Option<PictureDifference>,
    /// Time at which the images are to be compared.
    due: Option<Duration>,
    /// Identifier of the image pair.
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

impl Message for PictureDifference {}

/// Difference of image B from image A.
#[derive(Debug, Clone)]
pub struct PictureDifference {
    /// Mean FLIP, 0 to 1.
    pub flip: f64,
    /// Infinite for equal images.
    pub psnr_db: f64,
    /// `None` for images too small for it.
    pub ssim: Option<f64>,
    /// The FLIP error of each pixel in colours.
    pub map: Arc<RgbaImage>,
    pair: u64,
}

impl PicturePair {
    /// Records that one of the images changed at `now`.
    pub(in crate::app) fn note_change(&mut self, now: Duration) {
        self.pair = 1 + PAIRS.fetch_add(1, Ordering::Relaxed);
        self.difference = None;
        self.due = Some(now + REST);
    }

    /// Forgets the difference: the images show different places, or there is only one.
    pub(in crate::app) fn forget_difference(&mut self) {
        self.pair = 1 + PAIRS.fetch_add(1, Ordering::Relaxed);
        self.difference = None;
        self.due = None;
    }

    /// Time at which the images are to be compared.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        self.due
    }

    /// True once, when the images have been stable long enough.
    pub(in crate::app) fn is_due(&mut self, now: Duration) -> bool {
        let is_due = self.due.is_some_and(|due| due <= now);
        if is_due {
            self.due = None;
        }
        is_due
    }

    /// Compares both images on a thread. They may be of different sizes.
    pub(in crate::app) fn compare<T: TaskOutcome + From<PictureDifference>>(
        &self,
        [a, b]: [RgbaImage; 2],
        tasks: &Tasks<T>,
    ) {
        let pair = self.pair;
        tasks.try_start("comparison", move || {
            difference(&a, b, pair).map_err(|error| TaskFailed(error.to_string()))
        });
    }

    /// Takes the result, unless one of the images has changed since.
    pub(in crate::app) fn take_in(&mut self, difference: PictureDifference) {
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
    fn images_are_compared_once_at_rest() {
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
    fn results_for_replaced_images_are_ignored() {
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
