//! The frames of another source as a sequence file with some options would give them back: what is lost can be seen
//! before a file is written.

use super::{DecodeFailure, DecodedFrame, Decoder, FrameEntry, SequenceError, Source};
use crate::progress::Progress;
use crate::reel::{NewFrame, ReelDecoder, ReelFile, ReelOptions, write_to_memory};
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// Frames of another source, each encoded and decoded by itself whenever it is asked for.
pub struct AsReel {
    source: Arc<dyn Source>,
    options: ReelOptions,
}

impl AsReel {
    /// The frames of `source`, kept with these options.
    pub fn new(source: Arc<dyn Source>, options: ReelOptions) -> Self {
        Self { source, options }
    }
}

impl std::fmt::Debug for AsReel {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("AsReel")
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl Source for AsReel {
    fn frames(&self) -> Range<usize> {
        self.source.frames()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        self.source.entry(index)
    }

    fn group(&self, index: usize) -> Range<usize> {
        self.source.group(index)
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(ThroughReel {
            decoder: self.source.decoder(),
            options: self.options.clone(),
        })
    }

    fn fps(&self) -> Option<f64> {
        self.source.fps()
    }

    fn is_live(&self) -> bool {
        self.source.is_live()
    }

    fn may_grow(&self) -> bool {
        self.source.may_grow()
    }

    fn look_again(&self) -> Result<usize, SequenceError> {
        self.source.look_again()
    }

    fn changed_since(&self, since: usize) -> Vec<usize> {
        self.source.changed_since(since)
    }

    fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        self.source.wait_for_more(at_most)
    }
}

/// Decodes, encodes, and decodes that.
struct ThroughReel {
    decoder: Box<dyn Decoder>,
    options: ReelOptions,
}

impl Decoder for ThroughReel {
    fn decode(
        &mut self,
        index: usize,
        entry: &FrameEntry,
        _most_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let original = self.decoder.decode(index, entry, usize::MAX, progress)?.cloud;
        let frame = NewFrame {
            cloud: &original,
            name: &entry.name,
            time: entry.time,
        };
        let file = ReelFile::of_bytes(write_to_memory(&[frame], &self.options)?)?;
        let decoded = ReelDecoder::new(Arc::new(file), u64::MAX).decode(0, usize::MAX, progress)?;
        Ok(decoded.cloud.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use crate::reel::Precision;
    use crate::source::FrameList;

    #[test]
    fn frames_are_those_that_a_file_would_give() {
        let kept = |precision| {
            let options = ReelOptions {
                precision,
                ..ReelOptions::default()
            };
            let list: Arc<dyn Source> = Arc::new(FrameList::new(vec![FrameEntry::file("a.ply")], |_, _| {
                let places = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.01, 0.0, 0.0]];
                Ok(RawCloud::from_positions(Positions::F32(places.to_vec())))
            }));
            let source = AsReel::new(list, options);
            let entry = source.entry(0);
            let decoded = source.decoder().decode(0, &entry, usize::MAX, &Progress::default());
            decoded.unwrap().cloud
        };
        assert_eq!(kept(Precision::Bits(2)).positions.len(), 2, "two points share a cell");
        let lossless = kept(Precision::Lossless).positions;
        assert_eq!(lossless.len(), 3);
        assert!(matches!(lossless, Positions::F32(_)));
    }
}
