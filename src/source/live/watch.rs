//! Detection of lost and restored connections since the last check.

use super::status::{LiveState, LiveStatus};
use std::fmt;
use std::time::Duration;

/// Change in a connection's state.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConnectionChange {
    /// The connection has broken, for this reason.
    Broken(String),
    /// The connection is there again.
    Back {
        /// Duration of the disconnection; `None` if it was shorter than the interval between two checks.
        away: Option<Duration>,
    },
}

/// Watches the state of a stream, and reports each change once.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ConnectionWatch {
    /// Time when it was found broken.
    broken: Option<Duration>,
    /// `None` before the first check: earlier changes do not count.
    reconnects: Option<u64>,
}

impl ConnectionWatch {
    /// Returns the connection change since the last check. `now` is from any monotonic clock.
    pub fn look(&mut self, status: &LiveStatus, now: Duration) -> Option<ConnectionChange> {
        let before = self.reconnects.replace(status.reconnects);
        let is_another = before.is_some_and(|before| status.reconnects > before);
        match (&status.state, self.broken) {
            (LiveState::Reconnecting(_), Some(_)) => None,
            (LiveState::Reconnecting(problem), None) => {
                self.broken = Some(now);
                Some(ConnectionChange::Broken(problem.clone()))
            }
            (LiveState::Connected, Some(since)) => {
                self.broken = None;
                let away = Some(now.saturating_sub(since));
                Some(ConnectionChange::Back { away })
            }
            (LiveState::Connected, None) => is_another.then_some(ConnectionChange::Back { away: None }),
        }
    }
}

impl fmt::Display for ConnectionChange {
    /// The end of a sentence that begins with the stream.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Broken(problem) => write!(f, "the connection has broken and is made again by itself: {problem}"),
            Self::Back { away: None } => f.write_str("connected again, after a short while"),
            Self::Back { away: Some(away) } => write!(f, "connected again, after {:.1} s", away.as_secs_f64()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(problem: Option<&str>, reconnects: u64) -> LiveStatus {
        LiveStatus {
            state: problem.map_or(LiveState::Connected, |problem| {
                LiveState::Reconnecting(problem.to_owned())
            }),
            received_frames: 0,
            lost_frames: 0,
            bytes_per_s: 0.0,
            frames_per_s: 0.0,
            delay_s: None,
            buffered_s: 0.0,
            buffered_bytes: 0,
            reconnects,
            recording: None,
        }
    }

    #[test]
    fn an_interruption_and_its_end_are_reported_once() {
        let mut watch = ConnectionWatch::default();
        let looks = [
            (None, 0),
            (Some("it was reset"), 0),
            (Some("nothing can be reached"), 0),
            (None, 1),
            (None, 1),
            (Some("it was reset"), 1),
            (None, 2),
        ];
        let mut said = Vec::new();
        for (second, (problem, reconnects)) in (0..).zip(looks) {
            let change = watch.look(&status(problem, reconnects), Duration::from_secs(second));
            said.push(change.map_or_else(String::new, |change| change.to_string()));
        }
        let broken = "the connection has broken and is made again by itself: it was reset";
        let expected = [
            "",
            broken,
            "",
            "connected again, after 2.0 s",
            "",
            broken,
            "connected again, after 1.0 s",
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn an_interruption_between_two_polls_is_reported_too() {
        let mut watch = ConnectionWatch::default();
        assert_eq!(watch.look(&status(None, 3), Duration::ZERO), None);
        let change = watch.look(&status(None, 4), Duration::ZERO);
        assert_eq!(change, Some(ConnectionChange::Back { away: None }));
        assert_eq!(watch.look(&status(None, 4), Duration::ZERO), None);
    }
}
