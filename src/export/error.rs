//! Errors of image and video export.

use super::format::VideoFormat;
use super::limits::{MAX_EDGE_PX, MAX_PICTURES};
use super::picture_format::PictureFormat;
use crate::headless::HeadlessError;
use crate::render::RenderError;
use crate::scene::PathError;
use crate::sequence::{FrameError, SequenceError};
use std::path::PathBuf;

/// Errors of image and video export.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A frame cannot be shown or drawn.
    #[error(transparent)]
    Draw(#[from] HeadlessError),
    /// There are no frames, or no reader for them.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The camera has no such path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The output cannot be written.
    #[error("{} cannot be written ({reason}): check the folder, its permissions and the space left", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The name has no known extension.
    #[error(
        "{} is not a video: expected a name that ends in .mp4, .gif or .webp, a folder, or {{frame}}.png for one \
         file per image",
        path.display()
    )]
    UnknownFormat {
        /// The name.
        path: PathBuf,
    },
    /// The name has no image extension.
    #[error(
        "{} is not the name of an image format: expected a name that ends in {}",
        path.display(),
        PictureFormat::extensions().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ")
    )]
    UnknownPicture {
        /// The name.
        path: PathBuf,
    },
    /// The image format has no transparency.
    #[error("{format} has no transparency: choose .png, .webp or .tif, or a background colour")]
    OpaquePicture {
        /// The format.
        format: PictureFormat,
    },
    /// The image format does not support this size.
    #[error("{format} images have edges of at most {max_px} pixels, not {width}x{height}: choose .png")]
    LargePicture {
        /// The format.
        format: PictureFormat,
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
        /// Longest edge.
        max_px: u32,
    },
    /// The format does not support images of this size.
    #[error("{format} does not support images of {width}x{height} pixels: expected {expected}")]
    Size {
        /// The format.
        format: VideoFormat,
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
        /// Sizes that the format supports.
        expected: String,
    },
    /// The format has no such rate.
    #[error("{format} does not support {per_second} frames per second: expected {expected}")]
    Rate {
        /// The format.
        format: VideoFormat,
        /// Asked rate.
        per_second: f64,
        /// Rates that the format supports.
        expected: &'static str,
    },
    /// The format has no transparency.
    #[error("{format} has no soft transparency: choose .webp or PNG files, or a background colour")]
    Transparent {
        /// The format.
        format: VideoFormat,
    },
    /// The image is too large for any use.
    #[error(
        "an image of {width}x{height} pixels: edges are from 1 to {} pixels long",
        MAX_EDGE_PX
    )]
    PictureSize {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
    },
    /// An image that is drawn in parts cannot be scaled up.
    #[error(
        "an image of {width}x{height} pixels is drawn in tiles, which cannot be scaled up: omit --resolution, or draw \
         a smaller one"
    )]
    ScaledParts {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
    },
    /// Nothing encodes MP4.
    #[error(
        "MP4 is encoded by ffmpeg, which is not on the PATH: install it (`apt-get install ffmpeg`, `brew install \
         ffmpeg`), or choose .webp, .gif or PNG files"
    )]
    NoFfmpeg,
    /// The encoder failed.
    #[error("ffmpeg could not encode {}: {reason}", path.display())]
    Ffmpeg {
        /// The video.
        path: PathBuf,
        /// Error message of the encoder.
        reason: String,
    },
    /// Longer than any video.
    #[error("{count} frames are too many: a video has at most {max}", max = MAX_PICTURES)]
    TooLong {
        /// Number of frames.
        count: usize,
    },
    /// Larger than the format can hold.
    #[error("the video is larger than the 4 GiB of a WebP file: choose .mp4 or PNG files, or a smaller size")]
    TooManyBytes,
    /// Somebody cancelled it; nothing was written.
    #[error("the export was cancelled")]
    Cancelled,
}

impl From<FrameError> for ExportError {
    fn from(error: FrameError) -> Self {
        Self::Draw(error.into())
    }
}

impl From<RenderError> for ExportError {
    fn from(error: RenderError) -> Self {
        Self::Draw(error.into())
    }
}
