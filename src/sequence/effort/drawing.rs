//! Point budget for drawing: the number of points that can be drawn in the time of a frame.
//!
//! Part of the time of an image is fixed, the rest depends on the number of points. That dependence is learned where
//! their number changes; until then a number that fits in proportion surely fits. So playback begins with few points,
//! or with the number known from images drawn before, and goes to as many as fit at once. Where that says that no more
//! fit, more are tried all the same, since the workers, which are busiest at the beginning, slow drawing as well: after
//! each attempt without success, the next waits four times as long: a few images are late each time.

use super::average::Average;
use super::points::{MIN_POINTS, power_of_two};

/// Drawing statistics learned from images.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawingPace {
    /// The number of points that frames should have; all if `None`.
    pub(super) max_points: Option<u32>,
    picture_ms: Average,
    /// Approximate number of points in those images.
    of_points: usize,
    /// Images since the number was changed.
    pictures: u32,
    /// Number of points in earlier images, and their drawing time, milliseconds.
    before: Option<(usize, f64)>,
    /// Cost of an additional point, milliseconds.
    slope_ms: Option<f64>,
    attempt: Attempt,
    /// Images to wait for before the next attempt.
    patience: u32,
    /// True if images have yielded measurements yet.
    pub(super) is_known: bool,
}

/// The reason for the number of points.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Attempt {
    None,
    /// Fewer points than these, since their images took this many milliseconds.
    Fewer {
        before: Option<u32>,
        before_ms: f64,
    },
    /// Twice the points, or the number that should fit.
    More,
}

impl Default for DrawingPace {
    fn default() -> Self {
        Self {
            max_points: None,
            picture_ms: Average::default(),
            of_points: 0,
            pictures: 0,
            before: None,
            slope_ms: None,
            attempt: Attempt::None,
            patience: Self::LOOKED_AT,
            is_known: false,
        }
    }
}

impl DrawingPace {
    /// Images measured before the number is changed again.
    pub(super) const LOOKED_AT: u32 = 6;
    /// Images that suffice to recognise times far from that of a frame.
    pub(super) const LOOKED_AT_IF_CLEAR: u32 = 3;
    const MAX_PATIENCE: u32 = 1 << 11;
    /// Part of the time of a frame that images may take if it is to be held.
    const PLANNED: f64 = 0.8;
    /// Part of the time of a frame beyond which images do not hold it: some take longer than the mean.
    const LATE: f64 = 0.9;
    /// Minimum part of the time of an image that grows with its points: measured slopes are unreliable if little
    /// changed.
    const MIN_SLOPE: f64 = 0.25;

    /// Returns the same numbers, without the measurements they follow from.
    pub(super) fn forgetful(self) -> Self {
        Self {
            max_points: self.max_points,
            is_known: self.is_known,
            ..Self::default()
        }
    }

    /// Playing begins.
    pub(super) fn begin(&mut self, interval_ms: f64) {
        let is_late = |mean_ms: f64| mean_ms > Self::PLANNED * interval_ms;
        if self.max_points.is_none()
            && let Some(mean_ms) = self.picture_ms.mean.filter(|&mean_ms| is_late(mean_ms))
        {
            self.max_points = Some(self.fitting_points(mean_ms, interval_ms));
        }
        self.is_known |= self.picture_ms.mean.is_some();
        self.change(self.max_points, Attempt::None);
    }

    /// Records an image, and the duration of a frame while playing. While earlier frames are shown, since others are
    /// not made yet, or files have fewer points, images say nothing about the attempt, unless they are late with few
    /// points.
    pub(super) fn note(&mut self, points: usize, picture_ms: f64, interval_ms: Option<f64>, points_in_file: usize) {
        if interval_ms.is_some_and(|interval_ms| {
            let wanted = self.wanted_points(points, points_in_file);
            let are_few = 4 * points < 3 * wanted;
            2 * points > 3 * wanted || are_few && picture_ms < Self::LATE * interval_ms
        }) {
            return;
        }
        if points > 2 * self.of_points || 2 * points < self.of_points {
            self.picture_ms = Average::default();
            self.pictures = 0;
            self.of_points = points;
        }
        self.picture_ms.add(picture_ms);
        self.pictures += 1;
        let (Some(mean_ms), Some(interval_ms)) = (self.picture_ms.mean, interval_ms) else {
            return;
        };
        if self.pictures < Self::LOOKED_AT_IF_CLEAR {
            return;
        }
        self.learn_slope(mean_ms);
        let fitting = self.fitting_points(mean_ms, interval_ms);
        let fits_twice = fitting as usize >= 2 * points;
        let is_tried = self.attempt == Attempt::More;
        let is_clear = fits_twice || mean_ms > if is_tried { 1.0 } else { 1.5 } * interval_ms;
        if self.pictures < Self::LOOKED_AT && !is_clear {
            return;
        }
        self.is_known = true;
        let is_patient = self.pictures < self.patience && !is_clear;
        if mean_ms > Self::LATE * interval_ms {
            // When images have just become slower, the mean has not caught up yet.
            self.draw_fewer(mean_ms, mean_ms.max(picture_ms), fitting, is_patient);
            return;
        }
        self.attempt = Attempt::None;
        match self.max_points {
            Some(max_points) if fits_twice && fitting > max_points => {
                self.change(Some(fitting), Attempt::More);
            }
            Some(max_points) if mean_ms < Self::PLANNED * interval_ms && !is_patient => {
                self.change(max_points.checked_mul(2), Attempt::More);
            }
            // The first images, with few points.
            None if (fitting as usize) < points_in_file && points < points_in_file => {
                self.change(Some(fitting), Attempt::More);
            }
            _ => {}
        }
    }

    /// Images take longer than a frame lasts.
    fn draw_fewer(&mut self, mean_ms: f64, before_ms: f64, fitting: u32, is_patient: bool) {
        let attempt = std::mem::replace(&mut self.attempt, Attempt::None);
        match (attempt, self.max_points) {
            (Attempt::Fewer { before, before_ms }, _) if mean_ms > 0.9 * before_ms => {
                self.try_later();
                self.change(before, Attempt::None);
            }
            (Attempt::More, Some(more)) => {
                self.try_later();
                self.change(Some((more / 2).max(MIN_POINTS)), Attempt::None);
            }
            // A copy is only worthwhile for at least a quarter fewer points.
            _ if 4 * fitting as usize <= 3 * self.of_points && !is_patient => {
                let before = self.max_points;
                self.change(Some(fitting), Attempt::Fewer { before, before_ms });
            }
            _ => {}
        }
    }

    /// Points of the largest frames as wanted; points of the frame shown if all are wanted.
    fn wanted_points(&self, points: usize, points_in_file: usize) -> usize {
        let max_points = self.max_points.map(|max| max as usize);
        max_points.map_or(points, |max| max.min(points_in_file.max(points)))
    }

    /// Learns the cost of an additional point, from the first of these images and the last ones before the number was
    /// changed: later, other things may have changed as well.
    fn learn_slope(&mut self, mean_ms: f64) {
        if let Some((points, before_ms)) = self.before
            && points != self.of_points
            && self.pictures <= Self::LOOKED_AT
        {
            self.slope_ms = Some((mean_ms - before_ms) / (self.of_points as f64 - points as f64));
        }
    }

    /// Returns the number of points that fit into the time of a frame, from the current drawing times. Fewer are chosen
    /// in proportion: a recent slowdown need not depend on the points as before.
    fn fitting_points(&self, mean_ms: f64, interval_ms: f64) -> u32 {
        let of_points = self.of_points as f64;
        let left_ms = Self::PLANNED * interval_ms - mean_ms;
        let in_proportion_ms = mean_ms.max(1e-3) / of_points;
        let slope_ms = match self.slope_ms {
            Some(slope_ms) if left_ms > 0.0 => slope_ms.clamp(Self::MIN_SLOPE * in_proportion_ms, in_proportion_ms),
            // Before the slope is learned, a proportional estimate is safe.
            _ => in_proportion_ms,
        };
        power_of_two(of_points + left_ms / slope_ms)
    }

    fn try_later(&mut self) {
        // At growing intervals, as most skipped frames occur while more points are tried.
        self.patience = (4 * self.patience).min(Self::MAX_PATIENCE);
    }

    fn change(&mut self, max_points: Option<u32>, attempt: Attempt) {
        let is_settled = self.pictures >= Self::LOOKED_AT_IF_CLEAR;
        if let Some(mean_ms) = self.picture_ms.mean.filter(|_| is_settled) {
            self.before = Some((self.of_points, mean_ms));
        }
        self.max_points = max_points;
        self.attempt = attempt;
        self.pictures = 0;
        self.picture_ms = Average::default();
        self.of_points = 0;
    }
}
