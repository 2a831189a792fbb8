//! What takes the pictures of a video, whatever its format.

use super::ExportError;
use super::gif::GifFile;
use super::mp4::Mp4File;
use super::png_files::{FRAME_PLACEHOLDER, PngFiles};
use super::webp::WebpFile;
use image::RgbaImage;
use std::fmt;
use std::path::Path;

/// Takes the pictures of a video one after the other. What is dropped before it is finished leaves nothing.
pub trait FrameSink: Send {
    /// Appends a picture of the size that the sink was opened for.
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError>;

    /// All pictures are there: the video gets its name, in place of a file that has it.
    fn finish(self: Box<Self>) -> Result<(), ExportError>;
}

/// The pictures of a video.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VideoStream {
    /// Width and height of all of them.
    pub size_px: [u32; 2],
    /// How many are shown a second.
    pub per_second: f64,
    /// How many there will be.
    pub count: usize,
    /// Whether their alpha counts; else they are opaque.
    pub is_transparent: bool,
}

impl VideoStream {
    /// How long picture `index` is shown, in ticks of `1 / ticks_per_second`: whole numbers whose sums are never off by
    /// more than half a tick.
    pub(super) fn ticks(&self, index: usize, ticks_per_second: f64) -> u64 {
        let start = |index: usize| (index as f64 * ticks_per_second / self.per_second).round();
        (start(index + 1) - start(index)) as u64
    }
}

/// What a video is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VideoFormat {
    /// A PNG file a picture.
    PngFiles,
    /// 256 colours a picture.
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
    /// Whether it can hold soft transparency.
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::PngFiles | Self::Webp)
    }

    /// The format that a name says: by its extension, or as a folder (an existing one, or a name without extension).
    pub fn of_name(path: &Path) -> Result<Self, ExportError> {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            _ if path.is_dir() => Ok(Self::PngFiles),
            None => Ok(Self::PngFiles),
            Some("png") if path.to_string_lossy().contains(FRAME_PLACEHOLDER) => Ok(Self::PngFiles),
            Some("gif") => Ok(Self::Gif),
            Some("webp") => Ok(Self::Webp),
            Some("mp4") => Ok(Self::Mp4),
            Some(_) => Err(ExportError::UnknownFormat {
                path: path.to_owned(),
            }),
        }
    }

    /// What the format cannot hold is refused before anything is drawn.
    ///
    /// # Errors
    /// Of sizes, rates and transparency that it has not.
    pub fn check(self, stream: &VideoStream) -> Result<(), ExportError> {
        let [width, height] = stream.size_px;
        let size = |max: u32, multiple: u32| {
            let fits = |edge: u32| (1..=max).contains(&edge) && edge.is_multiple_of(multiple);
            let expected = match multiple {
                1 => format!("edges of 1 to {max}"),
                _ => format!("even edges of 2 to {max}"),
            };
            let is_fine = fits(width) && fits(height);
            is_fine.then_some(()).ok_or(ExportError::Size {
                format: self,
                width,
                height,
                expected,
            })
        };
        let at_most = |max: f64, expected: &'static str| {
            let is_fine = stream.per_second > 0.0 && stream.per_second <= max;
            is_fine.then_some(()).ok_or(ExportError::Rate {
                format: self,
                per_second: stream.per_second,
                expected,
            })
        };
        if stream.is_transparent && !self.has_alpha() {
            return Err(ExportError::Transparent { format: self });
        }
        match self {
            Self::PngFiles => size(super::MAX_EDGE_PX, 1),
            // Viewers show shorter delays as a tenth of a second.
            Self::Gif => size(65_535, 1).and(at_most(50.0, "at most 50")),
            Self::Webp => size(16_383, 1).and(at_most(1000.0, "at most 1000")),
            Self::Mp4 => size(16_384, 2).and(at_most(1000.0, "at most 1000")),
        }
    }
}

/// Opens the video that `output` names, in the format that its name says.
///
/// # Errors
/// What the format has not (sizes, rates, transparency), and what stands in the way of writing.
pub fn open_sink(output: &Path, stream: &VideoStream) -> Result<Box<dyn FrameSink>, ExportError> {
    let format = VideoFormat::of_name(output)?;
    format.check(stream)?;
    Ok(match format {
        VideoFormat::PngFiles => Box::new(PngFiles::create(output, stream)?),
        VideoFormat::Gif => Box::new(GifFile::create(output, stream)?),
        VideoFormat::Webp => Box::new(WebpFile::create(output, stream)?),
        VideoFormat::Mp4 => Box::new(Mp4File::create(output, stream)?),
    })
}
