//! Pauses of a server that can take no connection: descriptors are used up, or a client has left already.
//!
//! **How it works.** The connection that could not be accepted stays in the queue of the system, so that the next
//! attempt fails at once: a loop without a pause would occupy a CPU core. Pauses double up to a quarter of a second; it
//! is reported once, and once more when connections are accepted again.

use std::io::{self, ErrorKind};
use std::time::Duration;

/// The first pause, and the longest.
const PAUSES: [Duration; 2] = [Duration::from_millis(10), Duration::from_millis(250)];

/// True for the error of a process, or a system, at its limit of open files: on Unix `EMFILE` and `ENFILE`.
pub(super) fn is_out_of_descriptors(error: &io::Error) -> bool {
    cfg!(unix) && matches!(error.raw_os_error(), Some(23 | 24))
}

/// Back-off delay after connections could not be accepted.
#[derive(Debug, Default)]
pub(super) struct AcceptBackOff {
    /// `None` while connections are taken.
    pause: Option<Duration>,
}

impl AcceptBackOff {
    /// A connection could not be taken: how long to wait before the next. Zero where only that one is lost.
    pub(super) fn failed(&mut self, error: &io::Error) -> Duration {
        if matches!(
            error.kind(),
            ErrorKind::ConnectionAborted | ErrorKind::ConnectionReset | ErrorKind::Interrupted
        ) {
            log::debug!("a client has left before it was taken: {error}");
            return Duration::ZERO;
        }
        let [first, longest] = PAUSES;
        if self.pause.is_none() {
            log::warn!(
                "no connection can be taken ({error}): idle clients are closed, and it goes on once some have left. \
                 Raise the limit of open files (`ulimit -n`) if that happens often"
            );
        }
        let pause = self.pause.map_or(first, |pause| (2 * pause).min(longest));
        self.pause = Some(pause);
        pause
    }

    /// A connection was taken.
    pub(super) fn works(&mut self) {
        if self.pause.take().is_some() {
            log::warn!("connections are taken again");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn back_off_grows_while_descriptors_are_exhausted_and_resets_on_success() {
        let mut back_off = AcceptBackOff::default();
        // EMFILE, on all systems that have it.
        let used_up = io::Error::from_raw_os_error(24);
        let pauses: Vec<u128> = (0..10).map(|_| back_off.failed(&used_up).as_millis()).collect();
        assert_eq!(pauses, [10, 20, 40, 80, 160, 250, 250, 250, 250, 250]);
        back_off.works();
        assert_eq!(back_off.failed(&used_up).as_millis(), 10);
        let aborted = io::Error::from(ErrorKind::ConnectionAborted);
        assert_eq!(back_off.failed(&aborted), Duration::ZERO);
    }
}
