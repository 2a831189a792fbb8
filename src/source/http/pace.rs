//! Rate limiter: caps the transfer rate at the allowed bytes per second.

use crate::locks::lock;
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

/// Rate limit in bytes per second, shared by all readers.
pub(super) struct BytePace {
    bytes_per_s: Option<f64>,
    /// Time at which the bytes read so far are within the rate.
    paid: Mutex<Option<Instant>>,
}

impl BytePace {
    /// Creates a rate limit of the given number of bytes per second; unlimited for `None`.
    pub(super) fn new(bytes_per_s: Option<f64>) -> Self {
        Self {
            bytes_per_s,
            paid: Mutex::default(),
        }
    }

    /// Waits until `count` bytes that were read now are due.
    pub(super) fn note(&self, count: usize) {
        let Some(bytes_per_s) = self.bytes_per_s else {
            return;
        };
        let now = Instant::now();
        let takes = Duration::from_secs_f64(count as f64 / bytes_per_s);
        let mut paid = lock(&self.paid);
        let due = paid.filter(|&due| due > now).unwrap_or(now) + takes;
        *paid = Some(due);
        drop(paid);
        thread::sleep(due.saturating_duration_since(now));
    }
}
