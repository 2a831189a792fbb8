//! Frame schedule: the due time of each frame.

use std::time::Duration;

/// Due times of the frames of a sequence, played repeatedly.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Since the first frame, ascending; at least one.
    begins: Vec<Duration>,
    /// Duration of one loop iteration.
    length: Duration,
    fps: f64,
}

impl Schedule {
    /// Creates a schedule of `count` frames, each lasting `durations` frames at a rate of `fps`. The schedule has at
    /// least one frame, and lasts at least one millisecond in total.
    pub fn new(count: usize, fps: f64, durations: impl Fn(usize) -> f64) -> Self {
        let fps = if fps.is_finite() { fps.clamp(1e-3, 1e4) } else { 30.0 };
        let mut begins = Vec::with_capacity(count.max(1));
        let mut end = Duration::ZERO;
        for frame in 0..count.max(1) {
            begins.push(end);
            let seconds = Duration::try_from_secs_f64(durations(frame) / fps);
            end = end.saturating_add(seconds.unwrap_or_default());
        }
        Self {
            begins,
            length: end.max(Duration::from_millis(1)),
            fps,
        }
    }

    /// Returns the frame rate in frames per second that applies for most of the time.
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// Frames of a turn.
    pub fn count(&self) -> usize {
        self.begins.len()
    }

    /// Returns the index in the sequence of the frame with this number.
    pub(super) fn index(&self, number: u64) -> usize {
        (number % self.begins.len() as u64) as usize
    }

    /// Time at which the frame with this number is due.
    pub(super) fn due(&self, number: u64) -> Duration {
        let turns = u32::try_from(number / self.begins.len() as u64).unwrap_or(u32::MAX);
        let within = self.begins[self.index(number)];
        self.length.saturating_mul(turns).saturating_add(within)
    }

    /// The number of the last frame that is due after this time.
    pub(super) fn due_by(&self, elapsed: Duration) -> u64 {
        let turns = elapsed.as_nanos() / self.length.as_nanos();
        let rest = Duration::from_nanos((elapsed.as_nanos() % self.length.as_nanos()) as u64);
        let within = self.begins.partition_point(|begin| *begin <= rest).saturating_sub(1);
        turns as u64 * self.begins.len() as u64 + within as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn frames_are_due_at_their_rate_in_a_loop() {
        let schedule = Schedule::new(3, 10.0, |frame| if frame == 1 { 2.0 } else { 1.0 });
        let due: Vec<u128> = (0..7).map(|number| schedule.due(number).as_millis()).collect();
        assert_eq!(due, [0, 100, 300, 400, 500, 700, 800]);
        assert_eq!(schedule.index(4), 1);
        assert_eq!(schedule.due_by(Duration::from_millis(299)), 1);
        assert_eq!(schedule.due_by(Duration::from_millis(450)), 3);
    }

    #[test]
    fn invalid_rates_give_a_valid_schedule() {
        for (count, fps) in [(0, 24.0), (1, 0.0), (5, f64::NAN), (2, -1.0), (3, f64::INFINITY)] {
            let schedule = Schedule::new(count, fps, |_| f64::NAN);
            assert!(schedule.length > Duration::ZERO && schedule.fps() > 0.0 && schedule.count() > 0);
            assert!(schedule.due(1_000_000) >= schedule.due(0));
        }
    }

    proptest! {
        #[test]
        fn due_and_due_by_are_inverse(
            durations in prop::collection::vec(0.1f64..5.0, 1..20), fps in 1.0f64..100.0, number in 0u64..10_000,
        ) {
            let schedule = Schedule::new(durations.len(), fps, |frame| durations[frame]);
            prop_assert_eq!(schedule.due_by(schedule.due(number)), number);
            prop_assert!(schedule.due(number + 1) > schedule.due(number));
        }
    }
}
