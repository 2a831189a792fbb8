//! Level-of-detail control: how detailed frames can be at their playback rate.
//!
//! **How it works.** Two things may be too slow for a frame rate. *Preparing* frames: the decoding time and the time
//! per point after it are averaged over recently prepared frames, as they were measured, including other load of the
//! machine; the workers' time between two frames, less decoding, determines how many points there is time for.
//! *Drawing* them: while images take longer than a frame lasts, frames of fewer points are wanted, as long as that
//! helps; now and then twice the points are tried. Playback begins with few points, unless images were drawn before.
//!
//! Numbers of points are powers of two, and are raised only when there is time for a third more, so that they do not
//! waver.
//!
//! Frames prepared in a hurry use [`Effort::in_time`]; frames prepared once all that are due soon are there use
//! [`Effort::at_best`], which only drawing limits. Nothing here looks at a clock.

mod average;
mod drawing;
mod points;

use super::Detail;
use average::Average;
use drawing::DrawingPace;
use points::power_of_two;
use std::time::Duration;

/// Points of the first frames that are played, with no measurements yet.
const FIRST_POINTS: u32 = 1 << 14;

/// Part of the workers' time that is planned with.
const PLANNED: f64 = 0.85;

/// Cost of preparing a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MakingCost {
    /// Decoding alone, milliseconds; `None` if nothing was decoded.
    pub(super) decode_ms: Option<f64>,
    /// Everything after it, milliseconds.
    pub(super) rest_ms: f64,
    /// Points that it was done for.
    pub(super) points: usize,
    /// Points of the file.
    pub(super) points_in_file: usize,
}

/// Performance measurements, and the level of detail that follows from them.
#[derive(Debug, Clone)]
pub(super) struct Effort {
    workers: usize,
    /// Wall time of a frame that is played; `None` when nothing is due.
    interval: Option<Duration>,
    decode_ms: Average,
    rest_ns_per_point: Average,
    /// Number of points in the largest frame.
    points_in_file: usize,
    made_for: Option<u32>,
    drawing: DrawingPace,
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
            drawing: DrawingPace::default(),
        }
    }

    /// Sets the duration of a frame while playing, or that nothing is played. True if that changes anything.
    pub(super) fn set_interval(&mut self, interval: Option<Duration>) -> bool {
        match interval {
            None => self.made_for = None,
            Some(interval) if self.interval.is_none() => self.drawing.begin(milliseconds(interval)),
            Some(_) => {}
        }
        let is_other = std::mem::replace(&mut self.interval, interval) != interval;
        self.plan();
        is_other
    }

    /// Returns true if playback is stopped.
    pub(super) fn is_at_rest(&self) -> bool {
        self.interval.is_none()
    }

    /// Other images are wanted: their time has to be measured again.
    pub(super) fn forget(&mut self) {
        self.rest_ns_per_point = Average::default();
        self.made_for = None;
        self.drawing = self.drawing.forgetful();
    }

    /// Records a frame that was made.
    pub(super) fn note_made(&mut self, made: &MakingCost) {
        self.points_in_file = self.points_in_file.max(made.points_in_file);
        if let Some(decode_ms) = made.decode_ms {
            self.decode_ms.add(decode_ms);
        }
        if made.points > 0 {
            self.rest_ns_per_point.add(made.rest_ms * 1e6 / made.points as f64);
        }
        self.plan();
    }

    /// Records an image of a frame with this number of points.
    pub(super) fn note_drawn(&mut self, points: usize, picture_ms: f64) {
        let interval_ms = self.interval.map(milliseconds);
        let points_in_file = self.points_in_file;
        self.drawing.note(points, picture_ms, interval_ms, points_in_file);
    }

    /// The detail of frames that are due soon.
    pub(super) fn in_time(&self) -> Detail {
        let is_known = self.drawing.is_known && self.rest_ns_per_point.mean.is_some();
        let first = (!is_known).then_some(FIRST_POINTS);
        let min = [first, self.made_for, self.drawing.max_points];
        self.detail(min.into_iter().flatten().min())
    }

    /// The detail of frames that there is time for.
    pub(super) fn at_best(&self) -> Detail {
        self.detail(self.drawing.max_points)
    }

    /// Returns the number of frames to buffer ahead, so that slow ones among them cause no waiting anywhere.
    pub(super) fn ahead_frames(&self) -> usize {
        const SPAN: Duration = Duration::from_secs(2);
        const MIN: f64 = 8.0;
        let Some(interval) = self.interval else {
            return usize::MAX;
        };
        let interval_ms = (interval.as_secs_f64() * 1e3).max(1e-3);
        let frame_ms = self.decode_ms.worst + self.rest_ns_per_point.worst * self.points_in_file as f64 / 1e6;
        let span_ms = SPAN.as_secs_f64() * 1e3 + 4.0 * frame_ms;
        (span_ms / interval_ms).max(MIN) as usize
    }

    fn detail(&self, max_points: Option<u32>) -> Detail {
        match (self.interval, max_points) {
            (Some(_), Some(points)) if !self.is_whole(points) => Detail::at_most(points),
            _ => Detail::Full,
        }
    }

    /// Returns true if no known frame has more points.
    fn is_whole(&self, points: u32) -> bool {
        (1..=points as usize).contains(&self.points_in_file)
    }

    /// Plans the number of points that there is time to prepare frames with.
    fn plan(&mut self) {
        let (Some(interval), Some(ns_per_point)) = (self.interval, self.rest_ns_per_point.mean) else {
            return;
        };
        let time_ms = PLANNED * self.workers as f64 * interval.as_secs_f64() * 1e3;
        let left_ms = time_ms - self.decode_ms.mean.unwrap_or(0.0);
        let points = (left_ms * 1e6 / ns_per_point.max(1e-3)).max(0.0);
        let affordable = power_of_two(points);
        let at_present = self.made_for.unwrap_or(u32::MAX);
        // Upwards only with a third to spare, so that the number does not oscillate.
        if affordable < at_present || power_of_two(points / 1.33) > at_present {
            self.made_for = Some(affordable);
        }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::points::MIN_POINTS;
    use super::*;

    const MILLION: usize = 1_000_000;

    fn opened_at(fps: f64) -> Effort {
        let mut effort = Effort::new(2);
        effort.set_interval(Some(Duration::from_secs_f64(1.0 / fps)));
        effort
    }

    /// If the first images have taken no time.
    fn played_at(fps: f64) -> Effort {
        let mut effort = opened_at(fps);
        for _ in 0..DrawingPace::LOOKED_AT_IF_CLEAR {
            effort.note_drawn(FIRST_POINTS as usize, 0.0);
        }
        effort
    }

    fn made(decode_ms: f64, ns_per_point: f64, points: usize) -> MakingCost {
        MakingCost {
            decode_ms: Some(decode_ms),
            rest_ms: ns_per_point * points as f64 / 1e6,
            points,
            points_in_file: MILLION,
        }
    }

    #[test]
    fn playback_starts_with_few_points() {
        let mut effort = opened_at(25.0);
        assert_eq!(effort.in_time(), Detail::at_most(FIRST_POINTS));
        assert_eq!(effort.at_best(), Detail::Full);
        effort.note_made(&made(1.0, 1.0, FIRST_POINTS as usize));
        assert_eq!(effort.in_time(), Detail::at_most(FIRST_POINTS));
        // 32 of 40 ms are planned: proportionally, they are enough for eight times the points, and slightly less.
        for _ in 0..DrawingPace::LOOKED_AT_IF_CLEAR {
            effort.note_drawn(FIRST_POINTS as usize, 3.0);
        }
        assert_eq!(effort.in_time(), Detail::at_most(8 * FIRST_POINTS));
        assert_eq!(effort.at_best(), effort.in_time());
    }

    #[test]
    fn previous_draw_times_determine_the_starting_point_count() {
        let opened = |picture_ms| {
            let mut effort = Effort::new(2);
            effort.note_made(&made(0.1, 0.1, MILLION));
            assert_eq!(effort.in_time(), Detail::Full);
            effort.note_drawn(MILLION, picture_ms);
            assert_eq!(effort.in_time(), Detail::Full);
            effort.set_interval(Some(Duration::from_millis(40)));
            effort.in_time()
        };
        assert_eq!(opened(20.0), Detail::Full);
        assert_eq!(opened(160.0), Detail::at_most(1 << 17), "a fifth of them");
    }

    #[test]
    fn the_point_count_fills_the_available_time() {
        let mut effort = played_at(25.0);
        // Two workers have 80 ms between two frames, 68 of them planned: 8 to decode, 60 for points of 200 ns: 300,000.
        effort.note_made(&made(8.0, 200.0, MILLION));
        assert_eq!(effort.in_time(), Detail::at_most(1 << 18));
        assert_eq!(effort.at_best(), Detail::Full);
        // When paused, all of them.
        effort.set_interval(None);
        assert_eq!(effort.in_time(), Detail::Full);
        // In slow motion there is time for all points.
        effort.set_interval(Some(Duration::from_millis(160)));
        effort.note_made(&made(8.0, 200.0, MILLION));
        assert_eq!(effort.in_time(), Detail::Full);
    }

    #[test]
    fn a_little_more_time_changes_nothing() {
        let mut effort = played_at(25.0);
        effort.note_made(&made(8.0, 230.0, MILLION));
        assert_eq!(effort.in_time(), Detail::at_most(1 << 17), "260,000 fall short of 2^18");
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
    fn slow_reading_leaves_the_minimum_point_count() {
        let mut effort = played_at(25.0);
        effort.note_made(&made(500.0, 1.0, MILLION));
        assert_eq!(effort.in_time(), Detail::at_most(MIN_POINTS));
        // Small frames cannot be reduced.
        let mut small = played_at(25.0);
        small.note_made(&MakingCost {
            points_in_file: 5000,
            ..made(500.0, 1.0, 5000)
        });
        assert_eq!(small.in_time(), Detail::Full);
    }

    /// Draws frames of the requested detail on a machine that takes `ms(points)`.
    fn drawn(effort: &mut Effort, ms: impl Fn(usize) -> f64) -> Detail {
        effort.note_made(&made(0.1, 0.1, MILLION));
        for _ in 0..200 {
            let points = effort.at_best().max_points().min(MILLION);
            effort.note_drawn(points, ms(points));
        }
        effort.at_best()
    }

    #[test]
    fn slow_drawing_gets_fewer_points() {
        let mut effort = played_at(25.0);
        let detail = drawn(&mut effort, |points| 2.0 + points as f64 / 10_000.0);
        assert_eq!(detail, Detail::at_most(1 << 18), "28 of 40 ms");
        assert_eq!(effort.in_time(), detail);
        // The person comes closer, and goes away again.
        let near = drawn(&mut effort, |points| 2.0 + points as f64 / 2_000.0);
        assert_eq!(near, Detail::at_most(1 << 16));
        assert_eq!(drawn(&mut effort, |points| points as f64 / 100_000.0), Detail::Full);
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
    fn point_counts_once_too_slow_are_retried() {
        let mut effort = played_at(25.0);
        effort.note_made(&made(0.1, 0.1, MILLION));
        // At first workers take half of the machine; then an image of all points takes 30 ms.
        for number in 0..400 {
            let points = effort.at_best().max_points().min(MILLION);
            let factor = if number < 60 { 2.0 } else { 1.0 };
            effort.note_drawn(points, factor * 30.0 * points as f64 / MILLION as f64);
        }
        assert_eq!(effort.at_best(), Detail::Full);
        // If more points never fit in time, they are tried less and less often.
        effort.forget();
        let mut late = 0;
        for _ in 0..2000 {
            let points = effort.at_best().max_points().min(MILLION);
            let picture_ms = 41.0 * points as f64 / MILLION as f64;
            late += u32::from(picture_ms > 40.0);
            effort.note_drawn(points, picture_ms);
        }
        assert!(late < 100, "{late} of 2000 pictures were late");
    }

    #[test]
    fn costs_independent_of_the_point_count_are_learned() {
        let mut effort = Effort::new(2);
        effort.set_interval(Some(Duration::from_secs_f64(1.0 / 60.0)));
        effort.note_made(&made(0.1, 0.1, MILLION));
        // Most of the draw time is independent of the points. While workers are busy, everything takes longer.
        let mut drawn = |pictures, factor: f64| {
            for _ in 0..pictures {
                let points = effort.at_best().max_points().min(MILLION);
                effort.note_drawn(points, factor * (8.0 + points as f64 / 16_000.0));
            }
            effort.at_best()
        };
        assert_eq!(
            drawn(200, 1.3),
            Detail::at_most(1 << 15),
            "13.1 of 16.7 ms, and 15.7 for twice the points"
        );
        // They are tried again when they fit, 12.1 ms, not when it is their turn.
        assert_eq!(drawn(12, 1.0), Detail::at_most(1 << 16));
    }

    #[test]
    fn frames_drawn_earlier_do_not_count_for_a_trial() {
        let mut effort = played_at(25.0);
        let ms = |points: usize| 3.0 + points as f64 / 8_700.0;
        assert_eq!(drawn(&mut effort, ms), Detail::at_most(1 << 18), "33 of 40 ms");
        for _ in 0..100 {
            effort.note_drawn(1 << 17, ms(1 << 17));
            effort.note_drawn(1 << 18, ms(1 << 18));
            effort.note_drawn(1 << 19, ms(1 << 19));
            assert_eq!(effort.at_best(), Detail::at_most(1 << 18));
        }
        // If even few points are late, that is evidence enough.
        for _ in 0..20 {
            let points = effort.at_best().max_points().min(1 << 17);
            effort.note_drawn(points, points as f64 / 2_080.0);
        }
        assert_eq!(effort.at_best(), Detail::at_most(1 << 16), "63 ms for 2^17, 32 planned");
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
