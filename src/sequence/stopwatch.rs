//! How long things took.

use std::time::Instant;

/// Wall time since `start` in milliseconds.
pub(crate) fn milliseconds_since(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}
