//! The frames of another source as a sequence file with some options would give them back: what is lost can be seen
//! before a file is written.

use super::{About, Capabilities, DecodeFailure, DecodedFrame, Decoder, DepthImages, FrameEntry, Source};
use crate::progress::Progress;
use crate::reel::{NewFrame, ReelDecoder, ReelFile, ReelOptions, write_to_memory};
use crate::rgbd::{Filters, Sensor};
use crate::wire::RawImages;
use std::ops::Range;
use std::sync::Arc;

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

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(ThroughReel {
            decoder: self.source.decoder(),
            options: self.options.clone(),
        })
    }

    fn about(&self) -> About<'_> {
        let About {
            inputs: _,
            fps,
            reel: _,
            recordings: _,
            assumptions,
            notes,
            damage,
        } = self.source.about();
        About {
            // Nobody opened these frames: a session that names the inputs would open the original in their place.
            inputs: &[],
            fps,
            // The one that is open is not the one that would be written.
            reel: None,
            // Another topic is chosen by opening the inputs again.
            recordings: &[],
            assumptions,
            notes,
            damage,
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        let Capabilities {
            groups,
            meshes: _,
            samples: _,
            growth,
            live,
            depth_images,
            photographs,
            image_files,
        } = self.source.capabilities();
        Capabilities {
            groups,
            // A sequence file holds points, and no faces.
            meshes: None,
            // What is read of a frame alone has not gone through a file, and levels of a file are made of the whole.
            samples: None,
            growth,
            live,
            depth_images: depth_images.map(|_| self as &dyn DepthImages),
            photographs,
            image_files,
        }
    }
}

/// Frames that are no longer images: a file holds their points, and who took them can still be asked here.
impl DepthImages for AsReel {
    fn sensor(&self, index: usize) -> Option<Sensor> {
        self.source.sensor(index)
    }

    /// What was recorded before any filter does not go through the file.
    fn raw_images(&self, _index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        None
    }

    fn filters(&self) -> Option<Filters> {
        self.source.filters()
    }

    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        let filtered = self.source.filtered(filters)?;
        Some(Arc::new(Self::new(filtered, self.options.clone())))
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
