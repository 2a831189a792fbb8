//! How detailed frames can be at the rate that they are played at.
//!
//! **How it works.** Two things may be too slow for a frame rate. *Making* frames: what decoding takes and what a point takes after it
//! are averaged over the frames made lately, as they were measured, with whatever else the machine did meanwhile; the workers'
//! time between two frames, less decoding, says how many points there is time for. *Drawing* them: while pictures take longer than a
//! frame lasts, frames of fewer points are wanted, as long as that helps; now and then twice the points are tried. Playing begins with
//! few points, unless pictures were drawn before.
//!
//! Numbers of points are powers of two, and are raised only when there is time for a third more, so that they do not waver.
//!
//! What is made in a hurry is [`Effort::in_time`]; what may be made while all that is due soon is there already is
//! [`Effort::at_best`], which only drawing limits. Nothing here looks at a clock.

use super::Detail;
use std::time::Duration;

/// Frames of fewer points save nothing worth it.
const FEWEST_POINTS: u32 = 1 << 13;

/// Points of the first frames that are played, of which nothing is known.
const FIRST_POINTS: u32 = 1 << 14;

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
        match interval {
            None => self.made_for = None,
            Some(interval) if self.interval.is_none() => self.drawing.begin(milliseconds(interval)),
            Some(_) => {}
        }
        let is_other = std::mem::replace(&mut self.interval, interval) != interval;
        self.plan();
        is_other
    }

    /// Other pictures are wanted: what they take has to be measured again.
    pub(super) fn forget(&mut self) {
        self.rest_ns_per_point = Average::default();
        self.made_for = None;
        self.drawing = Drawing {
            most_points: self.drawing.most_points,
            is_known: self.drawing.is_known,
            ..Drawing::default()
        };
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
        let interval_ms = self.interval.map(milliseconds);
        let points_in_file = self.points_in_file;
        self.drawing
            .note(points, picture_ms, interval_ms, points_in_file);
    }

    /// The detail of frames that are due soon.
    pub(super) fn in_time(&self) -> Detail {
        let is_known = self.drawing.is_known && self.rest_ns_per_point.mean.is_some();
        let first = (!is_known).then_some(FIRST_POINTS);
        let fewest = [first, self.made_for, self.drawing.most_points];
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
            (Some(_), Some(points)) if !self.is_whole(points) => Detail::at_most(points),
            _ => Detail::Full,
        }
    }

    /// Whether no frame that is known of has more points.
    fn is_whole(&self, points: u32) -> bool {
        (1..=points as usize).contains(&self.points_in_file)
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

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
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

/// How many points can be drawn in the time of a frame.
///
/// Part of the time of a picture is spent whatever there is to draw, the rest goes with the points. How it goes with them is learned where
/// their number changes; until then what fits in proportion to them surely fits. So playing begins with few points, or with what
/// pictures drawn before tell, and goes to as many as fit at once. Where that says that no more fit, more are tried all the same, since
/// the workers, which are busiest at the beginning, slow drawing as well: after each attempt without success, the next waits twice
/// as long.
#[derive(Debug, Clone, Copy)]
struct Drawing {
    most_points: Option<u32>,
    picture_ms: Average,
    /// Of how many points those pictures are, about.
    of_points: usize,
    /// Pictures since the number was changed.
    pictures: u32,
    /// How many points pictures had before that, and what they took, milliseconds.
    before: Option<(usize, f64)>,
    /// What a point more takes, milliseconds.
    slope_ms: Option<f64>,
    attempt: Attempt,
    /// Pictures to wait for before something is tried again.
    patience: u32,
    /// Whether pictures have told anything yet.
    is_known: bool,
}

/// Why the number of points is what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Attempt {
    None,
    /// Fewer points than these, since their pictures took so many milliseconds.
    Fewer {
        before: Option<u32>,
        before_ms: f64,
    },
    /// Twice the points, or as many as should fit.
    More,
}

impl Default for Drawing {
    fn default() -> Self {
        Self {
            most_points: None,
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

impl Drawing {
    /// Pictures that are looked at before the number is changed again.
    const LOOKED_AT: u32 = 6;
    /// Pictures that tell what is far from the time of a frame.
    const LOOKED_AT_IF_CLEAR: u32 = 3;
    const MOST_PATIENCE: u32 = 1 << 11;
    /// Part of the time of a frame that pictures may take if it is to be held.
    const PLANNED: f64 = 0.8;
    /// Part of the time of a frame beyond which pictures do not hold it: some take longer than the mean.
    const LATE: f64 = 0.9;
    /// Part of the time of a picture that goes with its points, at least: measured slopes may be anything where little changed.
    const LEAST_SLOPE: f64 = 0.25;

    /// Playing begins.
    fn begin(&mut self, interval_ms: f64) {
        let is_late = |mean_ms: f64| mean_ms > Self::PLANNED * interval_ms;
        if self.most_points.is_none()
            && let Some(mean_ms) = self.picture_ms.mean.filter(|&mean_ms| is_late(mean_ms))
        {
            self.most_points = Some(self.fitting_points(mean_ms, interval_ms));
        }
        self.is_known |= self.picture_ms.mean.is_some();
        self.change(self.most_points, Attempt::None);
    }

    /// Takes notice of a picture, and of how long a frame lasts while playing. While frames of before are shown, since others are not
    /// made yet, or files have fewer points, pictures say nothing of what is tried, unless they are late with few points.
    fn note(
        &mut self,
        points: usize,
        picture_ms: f64,
        interval_ms: Option<f64>,
        points_in_file: usize,
    ) {
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
            // Where pictures have just become slower, the mean is not there yet.
            self.draw_fewer(mean_ms, mean_ms.max(picture_ms), fitting, is_patient);
            return;
        }
        self.attempt = Attempt::None;
        match self.most_points {
            Some(most_points) if fits_twice && fitting > most_points => {
                self.change(Some(fitting), Attempt::More);
            }
            Some(most_points) if mean_ms < Self::PLANNED * interval_ms && !is_patient => {
                self.change(most_points.checked_mul(2), Attempt::More);
            }
            // The first pictures, of few points.
            None if (fitting as usize) < points_in_file && points < points_in_file => {
                self.change(Some(fitting), Attempt::More);
            }
            _ => {}
        }
    }

    /// Pictures take longer than a frame lasts.
    fn draw_fewer(&mut self, mean_ms: f64, before_ms: f64, fitting: u32, is_patient: bool) {
        let attempt = std::mem::replace(&mut self.attempt, Attempt::None);
        match (attempt, self.most_points) {
            (Attempt::Fewer { before, before_ms }, _) if mean_ms > 0.9 * before_ms => {
                self.try_later();
                self.change(before, Attempt::None);
            }
            (Attempt::More, Some(more)) => {
                self.try_later();
                self.change(Some((more / 2).max(FEWEST_POINTS)), Attempt::None);
            }
            // A quarter less is the least that is worth a copy.
            _ if 4 * fitting as usize <= 3 * self.of_points && !is_patient => {
                let before = self.most_points;
                self.change(Some(fitting), Attempt::Fewer { before, before_ms });
            }
            _ => {}
        }
    }

    /// Points of the largest frames as they are wanted; those of the frame that is shown while all are.
    fn wanted_points(&self, points: usize, points_in_file: usize) -> usize {
        let most_points = self.most_points.map(|most| most as usize);
        most_points.map_or(points, |most| most.min(points_in_file.max(points)))
    }

    /// What a point more takes, from the first of these pictures and the last ones before the number was changed: later, other things
    /// may have changed as well.
    fn learn_slope(&mut self, mean_ms: f64) {
        if let Some((points, before_ms)) = self.before
            && points != self.of_points
            && self.pictures <= Self::LOOKED_AT
        {
            self.slope_ms = Some((mean_ms - before_ms) / (self.of_points as f64 - points as f64));
        }
    }

    /// How many points fit into the time of a frame, from what pictures take now. Fewer are chosen in proportion: what has just become
    /// slower need not go with the points as it did.
    fn fitting_points(&self, mean_ms: f64, interval_ms: f64) -> u32 {
        let of_points = self.of_points as f64;
        let left_ms = Self::PLANNED * interval_ms - mean_ms;
        let in_proportion_ms = mean_ms.max(1e-3) / of_points;
        let slope_ms = match self.slope_ms {
            Some(slope_ms) if left_ms > 0.0 => {
                slope_ms.clamp(Self::LEAST_SLOPE * in_proportion_ms, in_proportion_ms)
            }
            _ => in_proportion_ms,
        };
        power_of_two(of_points + left_ms / slope_ms)
    }

    fn try_later(&mut self) {
        self.patience = (2 * self.patience).min(Self::MOST_PATIENCE);
    }

    fn change(&mut self, most_points: Option<u32>, attempt: Attempt) {
        let is_settled = self.pictures >= Self::LOOKED_AT_IF_CLEAR;
        if let Some(mean_ms) = self.picture_ms.mean.filter(|_| is_settled) {
            self.before = Some((self.of_points, mean_ms));
        }
        self.most_points = most_points;
        self.attempt = attempt;
        self.pictures = 0;
        self.picture_ms = Average::default();
        self.of_points = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLION: usize = 1_000_000;

    fn opened_at(fps: f64) -> Effort {
        let mut effort = Effort::new(2);
        effort.set_interval(Some(Duration::from_secs_f64(1.0 / fps)));
        effort
    }

    /// Where the first pictures have taken no time.
    fn played_at(fps: f64) -> Effort {
        let mut effort = opened_at(fps);
        for _ in 0..Drawing::LOOKED_AT_IF_CLEAR {
            effort.note_drawn(FIRST_POINTS as usize, 0.0);
        }
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
    fn playing_begins_with_few_points() {
        let mut effort = opened_at(25.0);
        assert_eq!(effort.in_time(), Detail::at_most(FIRST_POINTS));
        assert_eq!(effort.at_best(), Detail::Full);
        effort.note_made(&made(1.0, 1.0, FIRST_POINTS as usize));
        assert_eq!(effort.in_time(), Detail::at_most(FIRST_POINTS));
        // 32 of 40 ms are planned: in proportion, they are enough for eight times the points, and for a little less.
        for _ in 0..Drawing::LOOKED_AT_IF_CLEAR {
            effort.note_drawn(FIRST_POINTS as usize, 3.0);
        }
        assert_eq!(effort.in_time(), Detail::at_most(8 * FIRST_POINTS));
        assert_eq!(effort.at_best(), effort.in_time());
    }

    #[test]
    fn pictures_of_before_tell_what_to_begin_with() {
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
    fn as_many_points_as_there_is_time_for() {
        let mut effort = played_at(25.0);
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
    fn what_does_not_go_with_the_points_is_learned() {
        let mut effort = Effort::new(2);
        effort.set_interval(Some(Duration::from_secs_f64(1.0 / 60.0)));
        effort.note_made(&made(0.1, 0.1, MILLION));
        // Most of a picture is the same for any points. While workers are busy, everything takes longer.
        let mut drawn = |pictures, factor: f64| {
            for _ in 0..pictures {
                let points = effort.at_best().most_points().min(MILLION);
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
    fn frames_of_before_say_nothing_of_what_is_tried() {
        let mut effort = played_at(25.0);
        let ms = |points: usize| 3.0 + points as f64 / 8_700.0;
        assert_eq!(
            drawn(&mut effort, ms),
            Detail::at_most(1 << 18),
            "33 of 40 ms"
        );
        for _ in 0..100 {
            effort.note_drawn(1 << 17, ms(1 << 17));
            effort.note_drawn(1 << 18, ms(1 << 18));
            effort.note_drawn(1 << 19, ms(1 << 19));
            assert_eq!(effort.at_best(), Detail::at_most(1 << 18));
        }
        // Few points that are late say enough.
        for _ in 0..30 {
            let points = effort.at_best().most_points().min(1 << 17);
            effort.note_drawn(points, points as f64 / 2_000.0);
        }
        assert_eq!(effort.at_best(), Detail::at_most(1 << 16), "33 ms");
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
