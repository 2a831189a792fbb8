//! Video format by file name, the limits of each format, and its writer.

use super::error::ExportError;
use super::format::VideoFormat;
use super::gif::GifFile;
use super::limits::MAX_EDGE_PX;
use super::mp4::Mp4File;
use super::png_files::{PngFiles, has_placeholder};
use super::sink::{FrameSink, VideoStream};
use super::webp::WebpFile;
use std::path::Path;

impl VideoFormat {
    /// The format by the name: by its extension, or as a folder (an existing one, or a name without extension).
    pub fn of_name(path: &Path) -> Result<Self, ExportError> {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            // Elsewhere `-` means stdout, to which no video is written.
            None if path.as_os_str() == "-" => Err(ExportError::UnknownFormat { path: path.to_owned() }),
            _ if path.is_dir() => Ok(Self::PngFiles),
            None => Ok(Self::PngFiles),
            Some("png") if has_placeholder(path) => Ok(Self::PngFiles),
            Some("gif") => Ok(Self::Gif),
            Some("webp") => Ok(Self::Webp),
            Some("mp4") => Ok(Self::Mp4),
            Some(_) => Err(ExportError::UnknownFormat { path: path.to_owned() }),
        }
    }

    /// Checks the stream against the limits of the format before anything is drawn.
    ///
    /// # Errors
    /// If the format does not support the size, rate or transparency.
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
            Self::PngFiles => size(MAX_EDGE_PX, 1),
            // Viewers replace shorter delays by a tenth of a second.
            Self::Gif => size(65_535, 1).and(at_most(50.0, "at most 50")),
            Self::Webp => size(16_383, 1).and(at_most(1000.0, "at most 1000")),
            Self::Mp4 => size(16_384, 2).and(at_most(1000.0, "at most 1000")),
        }
    }
}

/// Opens the video `output`, in the format of its name.
///
/// # Errors
/// Sizes, rates or transparency that the format lacks, and failures to write.
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
