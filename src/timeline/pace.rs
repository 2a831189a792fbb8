//! Pace of playback: frame durations, either constant or following the timestamps.
//!
//! **How it works.** Durations are counted in the duration of the median frame, so that a frame rate means the same for
//! both kinds: frames per second for most of the time. The distance between two steps of a playhead is a sum of
//! durations along its path; a whole loop iteration is added at once, so that no sum is longer than one iteration.
//!
//! **Pauses.** Recordings stop and go on a day later. No viewer waits for that: a frame lasts at most
//! [`LONGEST_FRAME`].

use super::travel::{Direction, LoopMode, Travel};
use std::ops::Range;
use std::sync::Arc;

/// Longest duration of a frame, in median frames.
const LONGEST_FRAME: f64 = 8.0;

/// Minimum frame rate taken from timestamps, in frames per second: daily scans are played like slides.
const SLOWEST_FPS: f64 = 2.0;

/// Durations of the frames of a sequence.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pace {
    /// In median frames; empty where all last equally long.
    durations: Arc<[f64]>,
}

impl Pace {
    /// Creates the pace of frames with these time intervals between them, and returns it with its rate in frames per
    /// second; `None` without any. Precondition: the median is positive.
    pub(crate) fn of_spacings(spacings_s: &[f64], median_s: f64) -> Option<(Self, f64)> {
        if spacings_s.is_empty() {
            return None;
        }
        let durations = spacings_s
            .iter()
            .map(|spacing_s| (spacing_s / median_s).min(LONGEST_FRAME));
        // The end of the last frame is unknown.
        let durations = durations.chain([1.0]).collect();
        Some((Self { durations }, (1.0 / median_s).max(SLOWEST_FPS)))
    }

    /// Returns true if all frames have the same duration.
    pub fn is_even(&self) -> bool {
        self.durations.is_empty()
    }

    /// Returns the duration of a frame, in median frame durations.
    pub(crate) fn duration(&self, frame: usize) -> f64 {
        self.durations.get(frame).copied().unwrap_or(1.0)
    }

    /// Returns the number of steps that a playhead is due to have made when `elapsed` median frames have passed since
    /// frame `start` began.
    pub(crate) fn steps_within(&self, travel: &Travel, start: usize, direction: Direction, elapsed: f64) -> u64 {
        if self.is_even() {
            return elapsed.floor() as u64;
        }
        if !travel.plays(start) {
            // Counted from the first frame of the range.
            let rest = elapsed - self.duration(start);
            return if rest < 0.0 || travel.frame_count == 0 {
                0
            } else {
                1 + self.steps_within(travel, travel.start(direction), direction, rest)
            };
        }
        let turn = self.turn(travel);
        let (mut steps, mut left) = match turn {
            Some((steps, duration)) => {
                let turns = (elapsed / duration).floor();
                (turns as u64 * steps, elapsed - turns * duration)
            }
            None => (0, elapsed),
        };
        loop {
            let arrival = travel.after(start, direction, steps);
            let duration = self.duration(arrival.index);
            // If the range ends earlier, one extra step shows that.
            if left < duration || arrival.steps < steps {
                return steps;
            }
            left -= duration;
            steps += 1;
        }
    }

    /// Median frames from the beginning of frame `start` until the playhead has made `steps`.
    pub(crate) fn elapsed_at(&self, travel: &Travel, start: usize, direction: Direction, steps: u64) -> f64 {
        if self.is_even() {
            return steps as f64;
        }
        if !travel.plays(start) && steps > 0 && travel.frame_count > 0 {
            let begin = travel.start(direction);
            return self.duration(start) + self.elapsed_at(travel, begin, direction, steps - 1);
        }
        let (turns, rest, turn_duration) = match self.turn(travel) {
            Some((turn_steps, duration)) => (steps / turn_steps, steps % turn_steps, duration),
            None => (0, steps, 0.0),
        };
        let along_the_way = (0..rest).map(|step| {
            let index = travel.after(start, direction, step).index;
            self.duration(index)
        });
        turns as f64 * turn_duration + along_the_way.sum::<f64>()
    }

    /// Steps and duration of the path that ends where it began, if the playhead comes back.
    fn turn(&self, travel: &Travel) -> Option<(u64, f64)> {
        let Range { start, end } = travel.frames();
        let steps = (end - start).checked_sub(1).filter(|&steps| steps > 0)? as u64;
        let total: f64 = (start..end).map(|frame| self.duration(frame)).sum();
        match travel.loop_mode {
            LoopMode::Off => None,
            LoopMode::Loop => Some((steps + 1, total)),
            LoopMode::PingPong => {
                let ends = self.duration(start) + self.duration(end - 1);
                Some((2 * steps, 2.0 * total - ends))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::PlayRange;
    use proptest::prelude::*;
    use std::time::Duration;

    fn millis(times: &[u64]) -> Vec<Duration> {
        times.iter().copied().map(Duration::from_millis).collect()
    }

    #[test]
    fn timestamps_determine_frame_durations() {
        let (pace, fps) = Pace::of_times(&millis(&[100, 200, 300, 600, 700, 99_700])).unwrap();
        assert_eq!(fps, 10.0);
        let durations: Vec<f64> = (0..6).map(|frame| pace.duration(frame)).collect();
        let expected = [1.0, 1.0, 3.0, 1.0, LONGEST_FRAME, 1.0];
        for (duration, expected) in durations.iter().zip(expected) {
            assert!((duration - expected).abs() < 1e-9, "{durations:?}");
        }
    }

    #[test]
    fn timestamps_that_do_not_increase_give_no_pace() {
        for times in [&[5, 5][..], &[5, 4], &[1], &[]] {
            assert_eq!(Pace::of_times(&millis(times)), None, "{times:?}");
        }
        let (_, fps) = Pace::of_times(&millis(&[0, 86_400_000])).unwrap();
        assert_eq!(fps, SLOWEST_FPS);
    }

    proptest! {
        /// The two questions are each other's inverse, and a walk step by step gives the same.
        #[test]
        fn steps_are_due_when_their_time_has_come(
            spacings_ms in prop::collection::vec(1u64..50, 1..12),
            start in 0usize..12, backward: bool, mode in 0usize..3, steps in 0u64..100,
            ends in prop::option::of((0usize..14, 0usize..14)),
        ) {
            let mut times = vec![0];
            for spacing in spacings_ms {
                times.push(times[times.len() - 1] + spacing);
            }
            let (pace, _) = Pace::of_times(&millis(&times)).unwrap();
            let range = ends.map_or_else(PlayRange::default, |(first, last)| {
                PlayRange::default().beginning_at(first).ending_at(last)
            });
            let travel = Travel { range, ..Travel::whole(times.len(), LoopMode::ALL[mode]) };
            let start = start % times.len();
            let direction = if backward { Direction::Backward } else { Direction::Forward };
            let walked: f64 = (0..steps)
                .map(|step| pace.duration(travel.after(start, direction, step).index))
                .sum();
            let elapsed = pace.elapsed_at(&travel, start, direction, steps);
            prop_assert!((elapsed - walked).abs() < 1e-6, "{elapsed} {walked}");
            let possible = travel.after(start, direction, steps).steps;
            let due = pace.steps_within(&travel, start, direction, elapsed + 1e-6);
            prop_assert_eq!(due.min(possible), possible);
            if possible == steps {
                prop_assert_eq!(due, steps);
            }
        }
    }
}
