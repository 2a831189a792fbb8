//! Cost and savings of merging points, before anything is written.
//!
//! How it works: a frame is encoded in memory twice, with every point and as the options specify. Its points and bytes
//! represent all frames.

use super::conversion::{Conversion, Output};
use super::error::ConvertError;
use super::estimate::{SampleFrame, megabytes};
use crate::messages::{counted, grouped};
use crate::reel::{Precision, ReelOptions};
use crate::sequence::Sequence;
use std::fmt;

/// Cost and savings of merging, estimated from one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MergePrice {
    /// The frame.
    pub frame: usize,
    /// Frames that are converted.
    pub frames: usize,
    /// Points of the frame.
    pub points: f64,
    /// Those that are left.
    pub left: f64,
    /// Bytes of all frames with their points merged.
    pub merged_bytes: f64,
    /// Bytes with every point retained.
    pub whole_bytes: f64,
}

impl MergePrice {
    /// Estimates the cost of merging in a conversion; `None` where it merges nothing, or writes no sequence file.
    ///
    /// # Errors
    /// A frame that cannot be read or encoded.
    pub fn of(conversion: &Conversion, sequence: &Sequence) -> Result<Option<Self>, ConvertError> {
        let Output::Reel(_, options) = &conversion.output else {
            return Ok(None);
        };
        let last = sequence.len().saturating_sub(1);
        let range = conversion.frames.clone().unwrap_or(0..=last);
        let frames = range.filter(|frame| *frame <= last).collect::<Vec<usize>>();
        let Some(&frame) = frames.get(frames.len() / 2).filter(|_| !options.keeps_points()) else {
            return Ok(None);
        };
        let converted = frames[0]..=frames[frames.len() - 1];
        let sample = SampleFrame::read_with(sequence, &converted, frame, |index| conversion.edited(sequence, index))?;
        let whole = sample.other(&ReelOptions {
            precision: Precision::PointSpacing,
            ..options.clone()
        })?;
        let merged = sample.other(options)?;
        let count = frames.len() as f64;
        Ok(Some(Self {
            frame,
            frames: frames.len(),
            points: whole.points,
            left: merged.points,
            merged_bytes: count * merged.bytes,
            whole_bytes: count * whole.bytes,
        }))
    }
}

impl fmt::Display for MergePrice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let merged = (self.points - self.left).max(0.0);
        write!(
            f,
            "merges {} of {} points per frame ({:.0} %): about {} instead of {} for {}, by frame {}",
            grouped(merged.round()),
            grouped(self.points.round()),
            100.0 * merged / self.points.max(1.0),
            megabytes(self.merged_bytes),
            megabytes(self.whole_bytes),
            counted(self.frames as i64, "frame"),
            self.frame
        )
    }
}
