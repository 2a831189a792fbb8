//! Checks for possible defects of a sequence: gaps, frames that fail, attributes that change, points that are not
//! valid.
//!
//! **How it works.** Every frame is decoded once, on as many threads as there are cores, and reduced to its
//! [`FrameFacts`] at once, so that a sequence of any length takes the memory of a few frames. Rules about one frame
//! look at its facts, rules about the sequence at the facts of all. The result of a rule is a [`Finding`]: its kind,
//! the frames affected, and a message of one sentence.

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

/// Report on a sequence after all frames were inspected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// Number of frames, unreadable ones included.
    pub frame_count: usize,
    /// Points of all readable frames.
    pub point_count: u64,
    /// Attributes of the first readable frame.
    pub attributes: Vec<String>,
    /// Probable up axis, of most frames.
    pub probable_up: Option<&'static str>,
    /// Frames per second according to the timestamps; `None` without.
    pub stamped_fps: Option<f64>,
    /// Smallest and largest corner of all frames in file coordinates.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Findings to look at, the gravest first, then in the order of the frames.
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
        probable_up: rules::max_common_up(&facts).map(UpAxis::name),
        stamped_fps: (!sequence.pace().is_even()).then(|| sequence.fps()),
        bounds: bounds.map(|(min, max)| [min.to_array(), max.to_array()]),
        findings,
    }
}

#[cfg(test)]
mod tests;
