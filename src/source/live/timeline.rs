//! Times of frames, which go on where a server begins again.

use std::time::Duration;

/// The times of a stream.
#[derive(Debug, Default)]
pub(super) struct Timeline {
    session: u64,
    base: Duration,
    last: Option<Duration>,
}

impl Timeline {
    /// Returns the time of the next frame since the first: the server's timestamp, but `spacing` later than the frame
    /// before where another server, or the same one restarted, counts from the beginning.
    pub(super) fn next(&mut self, session: u64, time_ns: u64, spacing: Duration) -> Duration {
        let time = Duration::from_nanos(time_ns);
        let goes_on = self.session == session && self.last.is_some();
        let told = self.base.saturating_add(time);
        let next = match self.last {
            None => {
                self.base = Duration::ZERO;
                time
            }
            Some(last) if !goes_on || told <= last => {
                let next = last.saturating_add(spacing.max(Duration::from_nanos(1)));
                // A time that is too late to be counted leaves the base where it is.
                self.base = next.saturating_sub(time);
                next
            }
            Some(_) => told,
        };
        self.session = session;
        self.last = Some(next);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SPACING: Duration = Duration::from_millis(40);

    fn ms(millis: u64) -> u64 {
        1_000_000 * millis
    }

    #[test]
    fn times_continue_where_a_server_restarts() {
        let mut timeline = Timeline::default();
        let told = [(1, 500), (1, 540), (1, 700), (2, 0), (2, 33), (2, 20), (2, 60)];
        let times = told.map(|(session, time)| timeline.next(session, ms(time), SPACING).as_millis());
        assert_eq!(times, [500, 540, 700, 740, 773, 813, 853]);
    }

    proptest! {
        #[test]
        fn times_increase_whatever_a_server_sends(told in prop::collection::vec((0u64..3, 0..u64::MAX / 8), 1..50)) {
            let mut timeline = Timeline::default();
            let mut last = None;
            for (session, time) in told {
                let next = timeline.next(session, time, SPACING);
                prop_assert!(last.is_none_or(|last| next > last), "{next:?} after {last:?}");
                last = Some(next);
            }
        }
    }
}
