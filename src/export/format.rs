//! Video formats.

use std::fmt;

/// Output format of a video.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VideoFormat {
    /// One PNG file per image.
    PngFiles,
    /// 256 colours per image.
    Gif,
    /// Lossless.
    Webp,
    /// H.264, by `ffmpeg`.
    Mp4,
}

impl fmt::Display for VideoFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::PngFiles => "PNG",
            Self::Gif => "GIF",
            Self::Webp => "WebP",
            Self::Mp4 => "MP4",
        })
    }
}

impl VideoFormat {
    /// Returns true if the format supports an alpha channel with soft transparency.
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::PngFiles | Self::Webp)
    }
}
