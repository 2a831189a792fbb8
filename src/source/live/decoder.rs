//! Frames of a stream → clouds.

use crate::cloud::RawCloud;
use crate::messages::frame_by_index;
use crate::progress::Progress;
use crate::rgbd::Sensor;
use crate::source::rgbd::{FramesBefore, GROUP_FRAMES, ReceivedFrames};
use crate::source::{DecodeFailure, DecodedFrame, Decoder, FrameEntry};
use crate::wire::{Content, Frame, RawImages};
use std::ops::Range;
use std::sync::Arc;

/// Storage of a stream's frames: in memory, or in a file.
pub(super) trait FrameStore: Send + Sync {
    /// Frame `index`; the error is a sentence.
    fn frame(&self, index: usize) -> Result<Frame, String>;
}

/// Decodes frames of a stream.
pub(super) struct StreamDecoder<S> {
    store: Arc<S>,
    received: Arc<ReceivedFrames>,
    before: FramesBefore,
}

impl<S: FrameStore> StreamDecoder<S> {
    pub(super) fn new(store: Arc<S>, received: Arc<ReceivedFrames>) -> Self {
        Self {
            store,
            received,
            before: FramesBefore::default(),
        }
    }

    fn cloud(&mut self, index: usize, progress: &Progress) -> Result<RawCloud, DecodeFailure> {
        let frame = self.store.frame(index)?;
        match &frame.content {
            Content::Points(points) => Ok(points.cloud()?),
            Content::Images(images) => {
                let before = |index| match self.store.frame(index).ok()?.content {
                    Content::Images(images) => Some(*images),
                    Content::Points(_) => None,
                };
                Ok(self.received.cloud(index, images, &mut self.before, before, progress)?)
            }
        }
    }
}

impl<S: FrameStore> Decoder for StreamDecoder<S> {
    fn decode(
        &mut self,
        index: usize,
        entry: &FrameEntry,
        _max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let cloud = self.cloud(index, progress);
        let cloud = cloud.map_err(|error| {
            let frame = frame_by_index(index);
            format!("{}, {frame}: {error}", entry.path.display())
        })?;
        Ok(cloud.into())
    }
}

/// Returns true if a frame consists of images, to which filters apply.
pub(super) fn has_images(frame: &Frame) -> bool {
    matches!(frame.content, Content::Images(_))
}

/// Returns the sensor that captured a frame.
pub(super) fn sensor(frame: &Frame) -> Option<Sensor> {
    match &frame.content {
        Content::Points(_) => None,
        Content::Images(images) => Some(Sensor {
            rig: Arc::new(images.rig.clone()),
            world_from_camera: images.world_from_camera,
        }),
    }
}

/// The images of a frame.
pub(super) fn raw_images(frame: &Frame, max_bytes: u64) -> Option<Result<RawImages, DecodeFailure>> {
    match &frame.content {
        Content::Points(_) => None,
        Content::Images(images) => Some(images.raw(max_bytes).map_err(DecodeFailure::from)),
    }
}

/// The frames that one decoder had best decode in their order, of those that are there.
pub(super) fn group(received: &ReceivedFrames, index: usize, frames: &Range<usize>) -> Range<usize> {
    if received.filters.temporal.is_none() {
        return index..index + 1;
    }
    let first = index / GROUP_FRAMES * GROUP_FRAMES;
    let end = (first + GROUP_FRAMES).min(frames.end).max(index + 1);
    first.max(frames.start).min(index)..end
}
