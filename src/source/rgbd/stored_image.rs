//! Where an image is: in a file of its own, or in a message of a recording.

use super::error::RgbdError;
use super::text;
use crate::io::raster::{self, Raster};
use crate::io::recording::camera::CameraMessage;
use crate::io::{Message, ReadOptions, recording};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An image that is not read yet.
#[derive(Debug, Clone)]
pub(super) enum StoredImage {
    /// A file of its own.
    File(PathBuf),
    /// A message.
    Message(ImageMessage),
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
        }
    }

    /// Width and height, as far as they can be read; what cannot is said when it is decoded.
    pub(super) fn size_px(&self, options: &ReadOptions) -> Option<[u32; 2]> {
        match self {
            Self::File(path) => raster::size_px(&text::read_bytes(path, options.max_memory_bytes).ok()?).ok(),
            Self::Message(_) => Some(self.raster(options).ok()?.size_px),
        }
    }
}

impl From<PathBuf> for StoredImage {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}
