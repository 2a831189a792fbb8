//! Where an image is: in a file of its own, in a message of a recording, or in memory as it was received.

use super::error::RgbdError;
use super::text;
use crate::io::raster::{self, Raster, Samples};
use crate::io::recording::camera::CameraMessage;
use crate::io::{Message, ReadOptions, recording};
use crate::wire::{PackedImage, RawColor};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An image that is not read yet.
#[derive(Debug, Clone)]
pub(super) enum StoredImage {
    /// A file of its own.
    File(PathBuf),
    /// A message.
    Message(ImageMessage),
    /// In memory.
    Received(ReceivedImage),
}

/// An image that a live stream has sent.
#[derive(Debug, Clone)]
pub(super) struct ReceivedImage {
    /// The address or the file that it is from.
    pub(super) input: Arc<Path>,
    pub(super) image: PackedImage,
}

/// An image in a message of a recording.
#[derive(Debug, Clone)]
pub(super) struct ImageMessage {
    /// The recording.
    pub(super) path: Arc<Path>,
    /// The topic, for people.
    pub(super) topic: Arc<str>,
    pub(super) kind: CameraMessage,
    pub(super) message: Message,
}

impl StoredImage {
    /// The file that it is in.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Message(image) => &image.path,
            Self::Received(image) => &image.input,
        }
    }

    /// Its pixels.
    pub(super) fn raster(&self, options: &ReadOptions) -> Result<Raster, RgbdError> {
        match self {
            Self::File(path) => {
                let bytes = text::read_bytes(path, options.max_memory_bytes)?;
                raster::decode(&bytes, options.max_memory_bytes).map_err(|reason| RgbdError::Image {
                    path: path.clone(),
                    reason,
                })
            }
            Self::Message(image) => {
                recording::read_image(&image.path, &image.message, image.kind, options).map_err(|reason| {
                    RgbdError::Message {
                        topic: image.topic.to_string(),
                        reason,
                    }
                })
            }
            Self::Received(ReceivedImage { input, image }) => {
                image
                    .raster(options.max_memory_bytes)
                    .map_err(|reason| RgbdError::Received {
                        input: input.to_path_buf(),
                        reason,
                    })
            }
        }
    }

    /// Its colours as they are stored, and its size; `None` of what cannot be read.
    pub(super) fn raw_color(&self, options: &ReadOptions) -> Option<(RawColor, [u32; 2])> {
        /// What a JPEG begins with.
        const JPEG: &[u8] = b"\xff\xd8\xff";
        if let Self::File(path) = self {
            let bytes = text::read_bytes(path, options.max_memory_bytes).ok()?;
            if bytes.starts_with(JPEG) {
                let size_px = raster::size_px(&bytes).ok()?;
                return Some((RawColor::Jpeg(size_px, bytes), size_px));
            }
        }
        let raster = self.raster(options).ok()?;
        let size_px = raster.size_px;
        let is_color = !matches!(raster.samples, Samples::GrayF32(_));
        is_color.then_some((RawColor::Pixels(raster), size_px))
    }

    /// Width and height, as far as they can be read; what cannot is said when it is decoded.
    pub(super) fn size_px(&self, options: &ReadOptions) -> Option<[u32; 2]> {
        match self {
            Self::File(path) => raster::size_px(&text::read_bytes(path, options.max_memory_bytes).ok()?).ok(),
            Self::Message(_) => Some(self.raster(options).ok()?.size_px),
            Self::Received(image) => Some(image.image.size_px()),
        }
    }
}

impl From<PathBuf> for StoredImage {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}
