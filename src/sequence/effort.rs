//! How detailed frames can be at the rate that they are played at.
//!
//! **How it works.** Two things may be too slow for a frame rate. *Making* frames: what decoding takes and what a point takes after it
//! are averaged over the frames made lately, as they were measured, with whatever else the machine did meanwhile; the workers'
//! time between two frames, less decoding, says how many points there is time for. *Drawing* them: while pictures take longer than a
//! frame lasts, frames of half the points are wanted, as long as that helps; now and then twice the points are tried.
//!
//! Numbers of points are powers of two, and are raised only when there is time for a third more, so that they do not waver.
//!
//! What is made in a hurry is [`Effort::in_time`]; what may be made while all that is due soon is there already is
//! [`Effort::at_best`], which only drawing limits. Nothing here looks at a clock.

use super::Detail;
use std::time::Duration;

/// Frames of fewer points save nothing worth it.
const FEWEST_POINTS: u32 = 1 << 13;

/// Part of the workers' time that is planned with.
const PLANNED: f64 = 0.85;

/// Weight of the newest measurement in an average.
const NEWEST: f64 = 0.25;

/// What making a frame took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Made {
    /// Decoding alone, milliseconds; `None` if nothing was decoded.
    pub(super) decode_ms: Option<f64>,
    /// Everything after it, milliseconds.
    pub(super) rest_ms: f64,
    /// Points that it was done for.
    pub(super) points: usize,
    /// Points of the file.
    pub(super) points_in_file: usize,
}

/// What was measured, and what follows.
#[derive(Debug, Clone)]
pub(super) struct Effort {
    workers: usize,
    /// Wall time of a frame that is played; `None` when nothing is due.
    interval: Option<Duration>,
    decode_ms: Average,
    rest_ns_per_point: Average,
    /// Of the largest frame.
    points_in_file: usize,
    made_for: Option<u32>,
    drawing: Drawing,
}

impl Effort {
    pub(super) fn new(workers: usize) -> Self {
        Self {
            workers,
            interval: None,
            decode_ms: Average::default(),
            rest_ns_per_point: Average::default(),
            points_in_file: 0,
            made_for: None,
            drawing: Drawing::default(),
        }
    }

    /// Says how long a frame lasts while playing, or that nothing is played. True if that changes anything.
    pub(super) fn set_interval(&mut self, interval: Option<Duration>) -> bool {
        if interval.is_none() {
            self.made_for = None;
        }
        std::mem::replace(&mut self.interval, interval) != interval
    }

    /// Other pictures are wanted: what they take has to be measured again.
    pub(super) fn forget(&mut self) {
        self.rest_ns_per_point = Average::default();
        self.made_for = None;
        self.drawing = Drawing::default();
    }

    /// Takes notice of a frame that was made.
    pub(super) fn note_made(&mut self, made: &Made) {
        self.points_in_file = self.points_in_file.max(made.points_in_file);
        if let Some(decode_ms) = made.decode_ms {
            self.decode_ms.add(decode_ms);
        }
        if made.points > 0 {
            self.rest_ns_per_point
                .add(made.rest_ms * 1e6 / made.points as f64);
        }
        self.plan();
    }

    /// Takes notice of a picture of a frame of so many points.
    pub(super) fn note_drawn(&mut self, points: usize, picture_ms: f64) {
        if let Some(interval) = self.interval {
            let interval_ms = interval.as_secs_f64() * 1e3;
            self.drawing.note(points, picture_ms, interval_ms);
        }
    }

    /// The detail of frames that are due soon.
    pub(super) fn in_time(&self) -> Detail {
        let fewest = [self.made_for, self.drawing.most_points];
        self.detail(fewest.into_iter().flatten().min())
    }

    /// The detail of frames that there is time for.
    pub(super) fn at_best(&self) -> Detail {
        self.detail(self.drawing.most_points)
    }

    /// How many frames should be ready, so that slow ones among them are waited for nowhere.
    pub(super) fn ahead_frames(&self) -> usize {
        const SPAN: Duration = Duration::from_secs(2);
        const FEWEST: f64 = 8.0;
        let Some(interval) = self.interval else {
            return usize::MAX;
        };
        let interval_ms = (interval.as_secs_f64() * 1e3).max(1e-3);
        let frame_ms =
            self.decode_ms.worst + self.rest_ns_per_point.worst * self.points_in_file as f64 / 1e6;
        let span_ms = SPAN.as_secs_f64() * 1e3 + 4.0 * frame_ms;
        (span_ms / interval_ms).max(FEWEST) as usize
    }

    fn detail(&self, most_points: Option<u32>) -> Detail {
        match (self.interval, most_points) {
            (Some(_), Some(points)) if (points as usize) < self.points_in_file => {
                Detail::at_most(points)
            }
            _ => Detail::Full,
        }
    }

    /// How many points there is time to make frames of.
    fn plan(&mut self) {
        let (Some(interval), Some(ns_per_point)) = (self.interval, self.rest_ns_per_point.mean)
        else {
            return;
        };
        let time_ms = PLANNED * self.workers as f64 * interval.as_secs_f64() * 1e3;
        let left_ms = time_ms - self.decode_ms.mean.unwrap_or(0.0);
        let points = (left_ms * 1e6 / ns_per_point.max(1e-3)).max(0.0);
        let affordable = power_of_two(points);
        let at_present = self.made_for.unwrap_or(u32::MAX);
        if affordable < at_present || power_of_two(points / 1.33) > at_present {
            self.made_for = Some(affordable);
        }
    }
}

/// The power of two at or below `points`, within bounds.
fn power_of_two(points: f64) -> u32 {
    let points = points.min(f64::from(1_u32 << 31)) as u32;
    (1 << points.max(1).ilog2()).max(FEWEST_POINTS)
}

/// A moving average, and the worst of what is fading from it.
#[derive(Debug, Clone, Copy, Default)]
struct Average {
    mean: Option<f64>,
    worst: f64,
}

impl Average {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            let mean = self.mean.unwrap_or(value);
            self.mean = Some(mean + NEWEST * (value - mean));
            // The worst is forgotten at a tenth of that pace.
            self.worst = value.max(self.worst * (1.0 - 0.1 * NEWEST));
        }
    }
}

/// How many points can be drawn in the time of a frame, found by trying.
///
/// A number that was tried without success is not tried again at once: the next attempt waits twice as long as the last, since the
/// workers, which are busiest at the beginning, slow drawing as well.
#[derive(Debug, Clone, Copy)]
struct Drawing {
    most_points: Option<u32>,
    picture_ms: Average,
    /// Pictures since the number was changed.
    pictures: u32,
    attempt: Attempt,
    /// Pictures to wait for before something is tried again.
    patience: u32,
}

/// Why the number of points is what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Attempt {
    None,
    /// Half of the points, since pictures took so many milliseconds.
    Fewer {
        before_ms: f64,
    },
    /// Twice the points.
    More,
}

impl Default for Drawing {
    fn default() -> Self {
        Self {
            most_points: None,
            picture_ms: Average::default(),
            pictures: 0,
            attempt: Attempt::None,
            patience: Self::LOOKED_AT,
        }
    }
}

impl Drawing {
    /// Pictures that are looked at before the number is changed again.
    const LOOKED_AT: u32 = 6;
    const MOST_PATIENCE: u32 = 1 << 11;

    fn note(&mut self, points: usize, picture_ms: f64, interval_ms: f64) {
        self.picture_ms.add(picture_ms);
        self.pictures += 1;
        let (Some(mean_ms), false) = (self.picture_ms.mean, self.pictures < Self::LOOKED_AT) else {
            return;
        };
        let is_late = mean_ms > 0.95 * interval_ms;
        let is_patient = self.pictures < self.patience;
        let attempt = std::mem::replace(&mut self.attempt, Attempt::None);
        let half = points.next_power_of_two() as u32 / 2;
        match (attempt, self.most_points) {
            (Attempt::Fewer { before_ms }, Some(fewer)) if is_late && mean_ms > 0.9 * before_ms => {
                self.try_later();
                self.change(fewer.checked_mul(2), Attempt::None);
            }
            (Attempt::More, _) if is_late => {
                self.try_later();
                self.change(Some(half), Attempt::None);
            }
            _ if is_late => {
                // A quarter less is the least that is worth a copy.
                let is_less = half >= FEWEST_POINTS && 4 * half as usize <= 3 * points;
                if is_less && !is_patient {
                    // Where pictures have just become slower, the mean is not there yet.
                    let before_ms = mean_ms.max(picture_ms);
                    self.change(Some(half), Attempt::Fewer { before_ms });
                }
            }
            (_, Some(points)) => {
                let is_sure = mean_ms < 0.45 * interval_ms;
                if is_sure || mean_ms < 0.8 * interval_ms && !is_patient {
                    self.change(points.checked_mul(2), Attempt::More);
                }
            }
            (_, None) => {}
        }
    }

    fn try_later(&mut self) {
        self.patience = (2 * self.patience).min(Self::MOST_PATIENCE);
    }

    fn change(&mut self, most_points: Option<u32>, attempt: Attempt) {
        self.most_points = most_points;
        self.attempt = attempt;
        self.pictures = 0;
        self.picture_ms = Average::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLION: usize = 1_000_000;

    fn played_at(fps: f64) -> Effort {
        let mut effort = Effort::new(2);
        effort.set_interval(Some(Duration::from_secs_f64(1.0 / fps)));
        effort
    }

    fn made(decode_ms: f64, ns_per_point: f64, points: usize) -> Made {
        Made {
            decode_ms: Some(decode_ms),
            rest_ms: ns_per_point * points as f64 / 1e6,
            points,
            points_in_file: MILLION,
        }
    }

    #[test]
    fn as_many_points_as_there_is_time_for() {
        let mut effort = played_at(25.0);
        assert_eq!(effort.in_time(), Detail::Full, "nothing is known yet");
        // Two workers have 80 ms between two frames, 68 of them planned: 8 to decode, 60 for points of 200 ns: 300,000.
        effort.note_made(&made(8.0, 200.0, MILLION));
        assert_eq!(effort.in_time(), Detail::at_most(1 << 18));
        assert_eq!(effort.at_best(), Detail::Full);
        // Paused, all are.
        effort.set_interval(None);
        assert_eq!(effort.in_time(), Detail::Full);
        // In slow motion there is time for all.
        effort.set_interval(Some(Duration::from_millis(160)));
        effort.note_made(&made(8.0, 200.0, MILLION));
        assert_eq!(effort.in_time(), Detail::Full);
    }

    #[test]
    fn a_little_more_time_changes_nothing() {
        let mut effort = played_at(25.0);
        effort.note_made(&made(8.0, 230.0, MILLION));
        assert_eq!(
            effort.in_time(),
            Detail::at_most(1 << 17),
            "260,000 fall short of 2^18"
        );
        for _ in 0..50 {
            effort.note_made(&made(8.0, 200.0, MILLION));
        }
        assert_eq!(
            effort.in_time(),
            Detail::at_most(1 << 17),
            "300,000 are not a third more"
        );
        for _ in 0..50 {
            effort.note_made(&made(8.0, 150.0, MILLION));
        }
        assert_eq!(effort.in_time(), Detail::at_most(1 << 18));
    }

    #[test]
    fn a_file_that_takes_too_long_to_read_leaves_the_fewest_points() {
        let mut effort = played_at(25.0);
        effort.note_made(&made(500.0, 1.0, MILLION));
        assert_eq!(effort.in_time(), Detail::at_most(FEWEST_POINTS));
        // Of small frames there is nothing to leave out.
        let mut small = played_at(25.0);
        small.note_made(&Made {
            points_in_file: 5000,
            ..made(500.0, 1.0, 5000)
        });
        assert_eq!(small.in_time(), Detail::Full);
    }

    /// Draws frames of the detail asked for on a machine that takes `ms(points)`.
    fn drawn(effort: &mut Effort, ms: impl Fn(usize) -> f64) -> Detail {
        effort.note_made(&made(0.1, 0.1, MILLION));
        for _ in 0..200 {
            let points = effort.at_best().most_points().min(MILLION);
            effort.note_drawn(points, ms(points));
        }
        effort.at_best()
    }

    #[test]
    fn drawing_that_is_too_slow_gets_fewer_points() {
        let mut effort = played_at(25.0);
        let detail = drawn(&mut effort, |points| 2.0 + points as f64 / 10_000.0);
        assert_eq!(detail, Detail::at_most(1 << 18), "28 of 40 ms");
        assert_eq!(effort.in_time(), detail);
        // The person comes near, and goes away again.
        let near = drawn(&mut effort, |points| 2.0 + points as f64 / 2_000.0);
        assert_eq!(near, Detail::at_most(1 << 16));
        assert_eq!(
            drawn(&mut effort, |points| points as f64 / 100_000.0),
            Detail::Full
        );
    }

    #[test]
    fn where_fewer_points_do_not_help_all_are_drawn() {
        let mut effort = played_at(25.0);
        assert_eq!(drawn(&mut effort, |_| 60.0), Detail::Full);
        effort.forget();
        assert_eq!(
            drawn(&mut effort, |points| points as f64 / 15_000.0),
            Detail::at_most(1 << 19)
        );
    }

    #[test]
    fn what_was_too_slow_once_is_tried_again() {
        let mut effort = played_at(25.0);
        effort.note_made(&made(0.1, 0.1, MILLION));
        // Workers take half of the machine at first; then a picture of all points takes 30 ms.
        for number in 0..400 {
            let points = effort.at_best().most_points().min(MILLION);
            let factor = if number < 60 { 2.0 } else { 1.0 };
            effort.note_drawn(points, factor * 30.0 * points as f64 / MILLION as f64);
        }
        assert_eq!(effort.at_best(), Detail::Full);
        // A picture that never fits is tried less and less often.
        effort.forget();
        let mut late = 0;
        for _ in 0..2000 {
            let points = effort.at_best().most_points().min(MILLION);
            let picture_ms = 41.0 * points as f64 / MILLION as f64;
            late += u32::from(picture_ms > 40.0);
            effort.note_drawn(points, picture_ms);
        }
        assert!(late < 100, "{late} of 2000 pictures were late");
    }

    #[test]
    fn slow_frames_are_prepared_farther_ahead() {
        let mut effort = played_at(10.0);
        assert_eq!(effort.ahead_frames(), 20);
        effort.note_made(&made(100.0, 0.0, MILLION));
        assert_eq!(effort.ahead_frames(), 24);
        effort.set_interval(None);
        assert_eq!(effort.ahead_frames(), usize::MAX);
    }
}
