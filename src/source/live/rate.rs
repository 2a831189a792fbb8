//! Data rate in bytes and frames per second, over the last two seconds.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Sliding window of the rate: older data does not count.
const WINDOW: Duration = Duration::from_secs(2);

/// Maximum number of entries: more come only from streams of tiny frames, whose rate then covers a shorter time.
const MAX_ENTRIES: usize = 1024;

/// Data rate received recently.
#[derive(Debug, Default)]
pub(super) struct Rate {
    came: VecDeque<(Instant, usize)>,
}

impl Rate {
    /// Records received bytes of a frame.
    pub(super) fn add(&mut self, now: Instant, bytes: usize) {
        if self.came.len() == MAX_ENTRIES {
            self.came.pop_front();
        }
        self.came.push_back((now, bytes));
    }

    /// Returns the rates in bytes and frames per second.
    pub(super) fn per_s(&self, now: Instant) -> (f64, f64) {
        let recent = self
            .came
            .iter()
            .filter(|(at, _)| now.saturating_duration_since(*at) < WINDOW);
        let (mut bytes, mut frames, mut first) = (0, 0, None);
        for (at, count) in recent {
            first = first.or(Some(*at));
            (bytes, frames) = (bytes + count, frames + 1);
        }
        // The first one ends an interval that was not observed.
        let Some(first) = first.filter(|_| frames > 1) else {
            return (0.0, 0.0);
        };
        let span_s = now.saturating_duration_since(first).as_secs_f64().max(1e-3);
        (bytes as f64 / span_s, f64::from(frames) / span_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_cover_the_last_seconds() {
        let mut rate = Rate::default();
        let begun = Instant::now();
        assert_eq!(rate.per_s(begun), (0.0, 0.0));
        for frame in 0..100 {
            rate.add(begun + Duration::from_millis(50 * frame), 1000);
        }
        let (bytes, frames) = rate.per_s(begun + Duration::from_secs(5));
        assert!(
            (bytes - 20_000.0).abs() < 600.0 && (frames - 20.0).abs() < 0.6,
            "{bytes} {frames}"
        );
        assert_eq!(rate.per_s(begun + Duration::from_mins(1)), (0.0, 0.0));
    }
}
