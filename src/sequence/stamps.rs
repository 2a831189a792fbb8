//! Pace from timestamps, which may arrive one after the other.
//!
//! How it works: a frame that arrives adds one spacing. The median, which durations are counted in, is recomputed once
//! there are an eighth more, so that a stream of any length sorts nothing when a frame arrives.

use crate::timeline::Pace;
use std::time::Duration;

/// The median of this many spacings serves until there are this many eighths of them.
const MEDIAN_SERVES_EIGHTHS: usize = 9;

/// Statistics of the timestamps of the first frames.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    /// Frames that were looked at.
    count: usize,
    last: Duration,
    spacings_s: Vec<f64>,
    median_s: f64,
    /// Number of spacings in the median.
    median_of: usize,
    /// A frame has no time, or is not later than the one before.
    are_useless: bool,
    found: Option<(Pace, f64)>,
}

impl Stamps {
    /// Returns the pace of `count` frames, and its frames per second; `None` unless each was taken later than the one
    /// before. Queries the times of those that arrived since the last call.
    pub(super) fn pace(&mut self, count: usize, time_of: impl Fn(usize) -> Option<Duration>) -> Option<(Pace, f64)> {
        if count > self.count && !self.are_useless {
            self.are_useless = self.take(count, time_of).is_none();
            self.found = (!self.are_useless)
                .then(|| Pace::of_spacings(&self.spacings_s, self.median_s))
                .flatten();
        }
        self.found.clone()
    }

    fn take(&mut self, count: usize, time_of: impl Fn(usize) -> Option<Duration>) -> Option<()> {
        for index in self.count..count {
            let time = time_of(index)?;
            if index > 0 {
                let spacing = time.checked_sub(self.last).filter(|spacing| !spacing.is_zero());
                self.spacings_s.push(spacing?.as_secs_f64());
            }
            self.last = time;
        }
        self.count = count;
        let spacings = self.spacings_s.len();
        if 8 * spacings >= MEDIAN_SERVES_EIGHTHS * self.median_of && spacings > 0 {
            let mut sorted = self.spacings_s.clone();
            let (_, median_s, _) = sorted.select_nth_unstable_by(spacings / 2, f64::total_cmp);
            (self.median_s, self.median_of) = (*median_s, spacings);
        }
        Some(())
    }
}

#[cfg(test)]
impl Pace {
    /// Returns the pace of frames that were taken at `times`, and its frames per second; `None` unless each is later
    /// than the one before.
    pub(crate) fn of_times(times: &[Duration]) -> Option<(Self, f64)> {
        Stamps::default().pace(times.len(), |index| Some(times[index]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn each_timestamp_is_requested_once_and_the_pace_is_that_of_all() {
        let asked = RefCell::new(Vec::new());
        // Every fifth frame takes three times as long.
        let times: Vec<Duration> = (0..400_u64)
            .map(|frame| Duration::from_millis(40 * frame + 80 * (frame / 5)))
            .collect();
        let time_of = |index: usize| {
            asked.borrow_mut().push(index);
            Some(times[index])
        };
        let mut stamps = Stamps::default();
        assert_eq!(stamps.pace(1, time_of), None, "one frame has no pace");
        for count in 2..=times.len() {
            let (pace, fps) = stamps.pace(count, time_of).unwrap();
            assert_eq!((pace, fps), Pace::of_times(&times[..count]).unwrap());
            assert_eq!(stamps.pace(count, time_of).unwrap().1, fps);
        }
        assert_eq!(*asked.borrow(), (0..times.len()).collect::<Vec<_>>());
    }

    #[test]
    fn a_missing_or_decreasing_timestamp_ends_the_pace() {
        for wrong in [None, Some(Duration::ZERO), Some(Duration::from_secs(2))] {
            let time_of = |index: usize| match index {
                3 => wrong,
                _ => Some(Duration::from_secs(index as u64)),
            };
            let mut stamps = Stamps::default();
            assert!(stamps.pace(3, time_of).is_some());
            assert_eq!(stamps.pace(4, time_of), None);
            assert_eq!(stamps.pace(9, time_of), None);
        }
    }
}
