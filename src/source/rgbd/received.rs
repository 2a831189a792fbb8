//! Images of live streams become clouds by the decoder for files: the same filters, registration and cameras.

use super::calibration::Calibration;
use super::decoder::Recorded;
use super::depth_code::DepthCode;
use super::error::RgbdError;
use super::frames_before::{FilteredDepth, FramesBefore};
use super::layouts::FrameImages;
use super::stored_image::{ReceivedImage, StoredImage};
use crate::cloud::RawCloud;
use crate::io::ReadOptions;
use crate::locks::lock;
use crate::progress::Progress;
use crate::rgbd::Filters;
use crate::source::OpenOptions;
use crate::wire::{PackedImage, ReceivedImages};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Decodes images that were received. Shared between threads.
#[derive(Debug)]
pub(in crate::source) struct ReceivedFrames {
    input: Arc<Path>,
    pub(in crate::source) filters: Filters,
    filters_are_automatic: bool,
    read: ReadOptions,
    /// One for each unit of depths received; a stream has one.
    decoders: Mutex<Vec<Arc<Recorded>>>,
}

impl ReceivedFrames {
    /// Creates the frames received from the stream at `input`.
    pub(in crate::source) fn new(input: &Path, options: &OpenOptions) -> Self {
        Self {
            input: input.into(),
            filters: options.rgbd.filters,
            filters_are_automatic: options.rgbd.filters_are_automatic,
            read: options.read,
            decoders: Mutex::default(),
        }
    }

    /// Returns a copy with other filters.
    pub(in crate::source) fn filtered(&self, filters: Filters) -> Self {
        Self {
            input: Arc::clone(&self.input),
            filters,
            filters_are_automatic: false,
            read: self.read,
            decoders: Mutex::default(),
        }
    }

    /// The cloud of `images` of frame `index`. `before` gives the images of earlier frames, as far as they are still
    /// there; it is called only if there is a temporal filter.
    pub(in crate::source) fn cloud(
        &self,
        index: usize,
        images: &ReceivedImages,
        filter: &mut FramesBefore,
        before: impl Fn(usize) -> Option<ReceivedImages>,
        progress: &Progress,
    ) -> Result<RawCloud, RgbdError> {
        let recorded = self.recorded(images.units_per_metre);
        let with_frames_before = |depth| {
            let before = |index: usize| self.depth(&before(index)?);
            filter.filtered(self.filters.temporal, index, depth, before, progress)
        };
        recorded.frame_cloud(&self.frame(images), with_frames_before)
    }

    fn depth(&self, images: &ReceivedImages) -> Option<FilteredDepth> {
        let recorded = self.recorded(images.units_per_metre);
        Some(recorded.depth(&self.frame(images)).ok()?.0)
    }

    fn frame(&self, images: &ReceivedImages) -> FrameImages {
        let stored = |image: &PackedImage| {
            StoredImage::Received(ReceivedImage {
                input: Arc::clone(&self.input),
                image: image.clone(),
            })
        };
        FrameImages {
            depth: stored(&images.depth),
            color: images.color.as_ref().map(stored),
            time: None,
            world_from_camera: images.world_from_camera,
            calibration: Arc::new(Calibration::of_rig(&images.rig, self.input.display().to_string())),
        }
    }

    /// Returns the decoder for depths of this unit, with the cameras that were prepared for it.
    fn recorded(&self, units_per_metre: f64) -> Arc<Recorded> {
        /// Maximum number of cached decoders: a stream that changes its unit with every frame prepares its cameras
        /// again.
        const MAX_RETAINED: usize = 4;
        let code = DepthCode::per_metre(units_per_metre);
        let mut decoders = lock(&self.decoders);
        if let Some(known) = decoders.iter().find(|known| known.code == code) {
            return Arc::clone(known);
        }
        let made = Recorded::of_no_frames(code, self.filters, self.filters_are_automatic, self.read);
        let made = Arc::new(made);
        decoders.truncate(MAX_RETAINED - 1);
        decoders.insert(0, Arc::clone(&made));
        made
    }
}
