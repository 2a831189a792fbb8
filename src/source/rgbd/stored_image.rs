//! Image storage: in a file of its own, in a message of a recording, in a block of a video, or in memory as received.

use super::error::RgbdError;
use super::member_image::MemberImage;
use super::text;
use crate::io::recordings::matroska::Block;
use crate::io::recordings::recording;
use crate::io::recordings::recording::camera::{self, CameraMessage};
use crate::io::{Message, ReadOptions};
use crate::raster::{self, Raster, Samples};
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
    /// A block of a Matroska file.
    Block(BlockImage),
    /// A file of an archive.
    Member(MemberImage),
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

/// An image in a block of a Matroska file.
#[derive(Debug, Clone)]
pub(super) struct BlockImage {
    /// The recording.
    pub(super) path: Arc<Path>,
    /// The name of the track, for people.
    pub(super) track: Arc<str>,
    /// As stated by the track.
    pub(super) size_px: [u32; 2],
    pub(super) pixels: BlockPixels,
    pub(super) block: Block,
}

/// Pixel format of the bytes in a block.
#[derive(Debug, Clone, Copy)]
pub(super) enum BlockPixels {
    /// An image as stored in a file.
    File,
    /// Pixels in rows, by the names of ROS; the high byte of 16 bits comes first.
    Bare(&'static str),
}

impl BlockImage {
    fn raster(&self, options: &ReadOptions) -> Result<Raster, String> {
        let bytes = self.block.read(&self.path, options.max_memory_bytes)?;
        let raster = match self.pixels {
            BlockPixels::File => raster::decode(&bytes, options.max_memory_bytes)?,
            BlockPixels::Bare(encoding) => {
                camera::bare_image(encoding, self.size_px, true, &bytes, options.max_memory_bytes)?
            }
        };
        let [width, height] = self.size_px;
        if raster.size_px != self.size_px {
            return Err(format!(
                "it has {} × {} pixels, and its track {width} × {height}",
                raster.size_px[0], raster.size_px[1]
            ));
        }
        Ok(raster)
    }
}

impl StoredImage {
    /// The file that it is in.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Message(image) => &image.path,
            Self::Block(image) => &image.path,
            Self::Member(image) => &image.path,
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
            Self::Block(image) => image.raster(options).map_err(|problem| RgbdError::Block {
                path: image.path.to_path_buf(),
                track: image.track.to_string(),
                offset: image.block.offset,
                problem,
            }),
            Self::Member(image) => image.raster(options),
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

    /// Its colours as they are stored, and its size; `None` if unreadable.
    pub(super) fn raw_color(&self, options: &ReadOptions) -> Option<(RawColor, [u32; 2])> {
        /// JPEG signature.
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

    /// Width and height, as far as they can be read; failures are reported on decoding.
    pub(super) fn size_px(&self, options: &ReadOptions) -> Option<[u32; 2]> {
        match self {
            Self::File(path) => raster::size_px(&text::read_bytes(path, options.max_memory_bytes).ok()?).ok(),
            Self::Message(_) => Some(self.raster(options).ok()?.size_px),
            Self::Block(image) => Some(image.size_px),
            Self::Member(image) => image.size_px(options),
            Self::Received(image) => Some(image.image.size_px()),
        }
    }
}

impl From<PathBuf> for StoredImage {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}
