//! Sequence-file section of `info`, in addition to its frames.

use crate::reel::{ReelFile, StreamKind};
use serde::Serialize;
use std::collections::BTreeMap;

/// A sequence file.
#[derive(Serialize)]
pub(in crate::cli) struct ReelInfo {
    bytes: u64,
    /// Points of all frames.
    points: usize,
    /// Points of the clouds that were written: those of one cell are one point unless they are stored one by one.
    points_written: u64,
    /// True if the file is truncated within its last group.
    ends_early: bool,
    /// Frames of each group.
    groups: Vec<usize>,
    /// Bits per point of all bytes, the directory included.
    bits_per_point: f64,
    bits_by_stream: BTreeMap<&'static str, f64>,
    /// Encoder settings recorded in the file.
    settings: BTreeMap<String, String>,
}

impl ReelInfo {
    pub(in crate::cli) fn of(file: &ReelFile) -> Self {
        let frames = || (0..file.frame_count()).filter_map(|index| file.frame(index));
        let points: usize = frames().map(|frame| frame.points).sum();
        let bits = |bytes: u64| 8.0 * bytes as f64 / points.max(1) as f64;
        let of_stream = |(place, kind): (usize, StreamKind)| {
            let bytes: u64 = frames().map(|frame| frame.bytes_by_stream[place]).sum();
            (bytes > 0).then_some((kind.name(), bits(bytes)))
        };
        Self {
            bytes: file.byte_size(),
            points,
            ends_early: file.is_cut(),
            points_written: frames().map(|frame| frame.points_written).sum(),
            groups: file.groups().map(|group| group.len()).collect(),
            bits_per_point: bits(file.byte_size()),
            bits_by_stream: StreamKind::ALL.into_iter().enumerate().filter_map(of_stream).collect(),
            settings: file.settings().iter().cloned().collect(),
        }
    }

    /// For people.
    pub(in crate::cli) fn line(&self) -> String {
        let streams = self
            .bits_by_stream
            .iter()
            .map(|(name, bits)| format!("{name} {bits:.2}"));
        let settings = self.settings.iter().map(|(name, value)| format!("{name} {value}"));
        let merged = if self.points as u64 == self.points_written {
            String::new()
        } else if self.ends_early {
            format!(" (of {}: the file ends early)", self.points_written)
        } else {
            format!(" (of {}: those of a cell are merged)", self.points_written)
        };
        format!(
            "{} points{merged}, {} bytes in {} groups, {:.2} bits per point ({}); {}",
            self.points,
            self.bytes,
            self.groups.len(),
            self.bits_per_point,
            streams.collect::<Vec<_>>().join(", "),
            settings.collect::<Vec<_>>().join(", ")
        )
    }
}
