//! What may be wrong with a sequence: gaps, frames that fail, attributes that change, points that are no points.
//!
//! **How it works.** Every frame is decoded once, on as many threads as there are cores, and shrinks to its
//! [`FrameFacts`] at once, so that a sequence of any length takes the memory of a few frames. Rules about one frame
//! look at its facts, rules about the sequence at the facts of all. What a rule finds is a [`Finding`]: of which kind,
//! in which frames, said in one sentence.

mod cameras;
mod facts;
mod finding;
mod rules;

pub use facts::FrameFacts;
pub use finding::{Finding, FindingKind, Severity};
pub(crate) use rules::changed_attributes;

use crate::scene::UpAxis;
use crate::sequence::{FrameError, Sequence};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What is known of a sequence after all frames were looked at.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// Number of frames, unreadable ones included.
    pub frame_count: usize,
    /// Points of all readable frames.
    pub point_count: u64,
    /// Attributes of the first readable frame.
    pub attributes: Vec<String>,
    /// Which axis is probably up, of most frames.
    pub probable_up: Option<&'static str>,
    /// Frames a second by the time stamps; `None` without.
    pub stamped_fps: Option<f64>,
    /// Smallest and largest corner of all frames in file coordinates.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// What should be looked at, the gravest first, then in the order of the frames.
    pub findings: Vec<Finding>,
}

/// Looks at every frame of `sequence`; `progress` is called from several threads with how many are done.
pub fn check(sequence: &Sequence, progress: &(dyn Fn(usize) + Sync)) -> CheckReport {
    let done = AtomicUsize::new(0);
    let facts: Vec<Result<FrameFacts, FrameError>> = (0..sequence.len())
        .into_par_iter()
        .map(|index| {
            let facts = sequence.decode(index);
            let facts = facts.map(|raw| FrameFacts::of(raw, sequence.no_data()));
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            facts
        })
        .collect();
    let mut findings = rules::findings(sequence, &facts);
    findings.sort_by_key(|finding| (std::cmp::Reverse(finding.severity), finding.frames.first().copied()));
    let readable = || facts.iter().flatten();
    let bounds = readable()
        .filter_map(|facts| facts.bounds)
        .reduce(|(min, max), (other_min, other_max)| (min.min(other_min), max.max(other_max)));
    CheckReport {
        frame_count: facts.len(),
        point_count: readable().map(|facts| facts.point_count as u64).sum(),
        attributes: readable()
            .next()
            .map_or_else(Vec::new, |facts| facts.attributes.clone()),
        probable_up: rules::most_common_up(&facts).map(UpAxis::name),
        stamped_fps: (!sequence.pace().is_even()).then(|| sequence.fps()),
        bounds: bounds.map(|(min, max)| [min.to_array(), max.to_array()]),
        findings,
    }
}

#[cfg(test)]
mod tests;
