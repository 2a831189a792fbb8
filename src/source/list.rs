//! A list of frames and a function that decodes them: sensors, generators, slow or broken files in tests.

use super::{About, Capabilities, DecodeFailure, Decoder, FrameEntry, FrameSample, Samples, Source};
use crate::cloud::RawCloud;
use crate::progress::Progress;
use std::ops::Range;
use std::sync::Arc;

type DecodeFn = dyn Fn(&FrameEntry, &Progress) -> Result<RawCloud, DecodeFailure> + Send + Sync;

/// Reads some points of a frame alone: see [`Samples::sample`].
type SampleFn = dyn Fn(&FrameEntry, usize, usize) -> Result<Option<FrameSample>, DecodeFailure> + Send + Sync;

/// Frames that one function decodes, called from several threads at once.
pub struct FrameList {
    entries: Vec<Arc<FrameEntry>>,
    decode: Arc<DecodeFn>,
    sample: Option<Box<SampleFn>>,
}

impl FrameList {
    /// The frames that `decode` makes of `entries`.
    pub fn new(
        entries: Vec<FrameEntry>,
        decode: impl Fn(&FrameEntry, &Progress) -> Result<RawCloud, DecodeFailure> + Send + Sync + 'static,
    ) -> Self {
        Self {
            entries: entries.into_iter().map(Arc::new).collect(),
            decode: Arc::new(decode),
            sample: None,
        }
    }

    /// Returns the same list of frames with `sample` as the reader of a subsample of their points.
    #[must_use]
    pub fn with_sample<S>(mut self, sample: S) -> Self
    where
        S: Fn(&FrameEntry, usize, usize) -> Result<Option<FrameSample>, DecodeFailure> + Send + Sync + 'static,
    {
        self.sample = Some(Box::new(sample));
        self
    }
}

impl std::fmt::Debug for FrameList {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("FrameList")
            .field("entries", &self.entries)
            .finish_non_exhaustive()
    }
}

impl Source for FrameList {
    fn frames(&self) -> Range<usize> {
        0..self.entries.len()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&self.entries[index])
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        let decode = Arc::clone(&self.decode);
        Box::new(move |entry: &FrameEntry, progress: &Progress| decode(entry, progress))
    }

    fn about(&self) -> About<'_> {
        About::default()
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            samples: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Samples for FrameList {
    fn sample(&self, index: usize, max_points: usize, min_points: usize) -> Result<Option<FrameSample>, DecodeFailure> {
        match &self.sample {
            Some(sample) => sample(&self.entries[index], max_points, min_points),
            None => Ok(None),
        }
    }
}
