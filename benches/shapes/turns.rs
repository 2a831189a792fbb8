//! Times of alternating cases, so that a machine that slows down meanwhile slows all of them.

use std::time::Instant;

/// Milliseconds of `work`; its result is dropped afterwards. It has run once before, so that memory is warm.
pub(crate) fn time_ms<T>(work: impl Fn() -> T) -> f64 {
    drop(work());
    let begin = Instant::now();
    let outcome = work();
    let elapsed = begin.elapsed();
    drop(outcome);
    elapsed.as_secs_f64() * 1e3
}

/// The median of `values`, the upper of two. Precondition: there is one.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
