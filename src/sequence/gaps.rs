//! Numbers that are missing between the names of frames.

use super::FrameEntry;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Numbers that no file has, between two frames that follow each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NumberGap {
    /// The index of the frame before it.
    pub after: usize,
    /// Number of missing frames.
    pub count: u64,
    /// From the first number that is missing to the last.
    pub numbers: RangeInclusive<u64>,
}

/// Returns the gaps in the frame numbers, in order. Every second frame may have been selected on purpose: the smallest
/// step is the rule. Times of a sensor may be counters as well, but values between them are not missing frames.
pub fn number_gaps(entries: &[Arc<FrameEntry>]) -> Vec<NumberGap> {
    let numbers: Option<Vec<u64>> = entries.iter().map(|entry| entry.number).collect();
    let numbers = numbers.unwrap_or_default();
    let steps: Vec<u64> = numbers.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
    let usual = steps.iter().copied().min().unwrap_or(0);
    let is_counter = usual > 0 && steps.iter().all(|step| step % usual == 0);
    let has_times = entries.iter().any(|entry| entry.time.is_some());
    if !is_counter || has_times {
        return Vec::new();
    }
    let gaps = steps.iter().enumerate().filter(|&(_, &step)| step > usual);
    gaps.map(|(after, step)| NumberGap {
        after,
        count: step / usual - 1,
        numbers: numbers[after] + usual..=numbers[after + 1] - usual,
    })
    .collect()
}
