//! No more bytes a second than are allowed.

use crate::locks::lock;
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

/// How many bytes a second are allowed, all readers together.
pub(super) struct BytePace {
    bytes_per_s: Option<f64>,
    /// When what was read so far is paid for.
    paid: Mutex<Option<Instant>>,
}

impl BytePace {
    /// So many bytes a second; as many as there are for `None`.
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
