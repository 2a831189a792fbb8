//! Stopwatch: measures durations.

use std::time::Instant;

/// Wall time since `start` in milliseconds.
pub(crate) fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
