//! Timeouts for transferring a byte range of a file, independent of individual connections.

use crate::deadlines::MinRate;
use std::fmt;
use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

/// Bytes of a file that are waited for.
pub(super) struct Transfer<'a> {
    url: &'a str,
    /// The thing that is waited for.
    what: String,
    min: MinRate,
    begun: Instant,
    /// Time during which no more data was wanted because the rate was limited.
    paused: Duration,
    /// Bytes that have come.
    came: u64,
    /// Time when the last of them came, without pauses.
    last: Duration,
}

impl<'a> Transfer<'a> {
    /// Starts waiting for `what` of the file at `url`.
    pub(super) fn new(url: &'a str, what: String, min: MinRate) -> Self {
        Self {
            url,
            what,
            min,
            begun: Instant::now(),
            paused: Duration::ZERO,
            came: 0,
            last: Duration::ZERO,
        }
    }

    /// Records this many more bytes; `pause` waits until more are wanted.
    pub(super) fn came(&mut self, count: usize, pause: impl FnOnce()) {
        self.came += count as u64;
        self.last = self.waited();
        let begun = Instant::now();
        pause();
        self.paused += begun.elapsed();
    }

    fn waited(&self) -> Duration {
        self.begun.elapsed().saturating_sub(self.paused)
    }

    /// Returns the remaining time before timeout; `None` if the transfer as a whole is too slow, or nothing has arrived
    /// for too long.
    pub(super) fn time_left(&self) -> Option<Duration> {
        let waited = self.waited();
        let of_all = self.min.time_left(self.came, waited)?;
        let silent = waited.saturating_sub(self.last);
        let of_next = self.min.grace.checked_sub(silent).filter(|left| !left.is_zero())?;
        Some(of_all.min(of_next))
    }

    /// The reason for giving up; `error` is the last failure.
    pub(super) fn too_slow(&self, error: &io::Error) -> io::Error {
        let text = format!(
            "waited {:.0} seconds for {}: {} bytes came, expected at least {:.0} per second ({error}): check \
             the server and the network",
            self.waited().as_secs_f64(),
            self.what,
            self.came,
            self.min.bytes_per_s
        );
        io::Error::new(ErrorKind::TimedOut, text)
    }
}

impl fmt::Display for Transfer<'_> {
    /// The end of a sentence that begins with *waiting for*.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.min.grace.as_secs();
        write!(
            f,
            "{} from {} (up to {seconds} s without progress)",
            self.what, self.url
        )
    }
}
