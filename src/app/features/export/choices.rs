//! Export settings of the user.

use crate::export::{MAX_EDGE_PX, VideoFormat};
use std::path::PathBuf;

/// Max edge of the images of a video: several of them are in memory at a time.
const MAX_VIDEO_EDGE_PX: u32 = 16_384;

/// Default frame rate in frames per second of animations that move by themselves.
pub(super) const USUAL_RATE: f64 = 30.0;

/// Subject of the export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportSubject {
    /// Image on the screen, in any size.
    Picture,
    /// The camera orbits about the up axis.
    Turntable,
    /// The camera path.
    Path,
    /// The sequence plays from in to out point with a fixed camera.
    Sequence,
}

impl ExportSubject {
    /// Returns the base name of files.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Turntable => "turntable",
            Self::Path => "path",
            Self::Sequence => "sequence",
        }
    }
}

/// Export settings of the user, and capabilities of the machine.
#[derive(Debug, Clone)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a check box, and one is known of the machine"
)]
pub struct Export {
    /// Subject that is shown.
    pub subject: ExportSubject,
    /// Width and height of the images; the window's if `None`.
    pub size_px: Option<[u32; 2]>,
    /// Video format; images are PNG files.
    pub format: VideoFormat,
    /// Frame rate in frames per second.
    pub per_second: f64,
    /// Number of images of a turntable.
    pub pictures: usize,
    /// Its revolutions, negative in the other direction.
    pub turns: f64,
    /// True if the turntable holds the shown frame instead of playing.
    pub holds_frame: bool,
    /// Nothing is behind the cloud, where the format can say so.
    pub is_transparent: bool,
    /// True if the colour legend is drawn over the images.
    pub has_legend: bool,
    /// A bar of a round length is at the lower left.
    pub has_scale_bar: bool,
    /// The folder of the file.
    pub folder: String,
    /// Its name without extension; made from sequence and subject if `None`.
    pub name: Option<String>,
    /// True if MP4 can be written.
    pub has_ffmpeg: bool,
    /// Last checked file and its existence.
    pub(in crate::app) taken: Option<(PathBuf, bool)>,
}

impl Default for Export {
    fn default() -> Self {
        Self {
            subject: ExportSubject::Picture,
            size_px: None,
            format: VideoFormat::Gif,
            per_second: USUAL_RATE,
            pictures: 120,
            turns: 1.0,
            holds_frame: false,
            is_transparent: false,
            has_legend: false,
            has_scale_bar: false,
            folder: String::new(),
            name: None,
            has_ffmpeg: false,
            taken: None,
        }
    }
}

impl Export {
    /// Returns true if images have a transparent background: as chosen, where the format supports it.
    pub fn has_alpha(&self) -> bool {
        self.is_transparent && self.can_have_alpha()
    }

    /// Returns true if the format supports a transparent background.
    pub fn can_have_alpha(&self) -> bool {
        self.subject == ExportSubject::Picture || self.format.has_alpha()
    }

    /// Longest edge that is offered.
    pub(in crate::app) fn max_edge_px(&self) -> u32 {
        match self.subject {
            ExportSubject::Picture => MAX_EDGE_PX,
            _ => MAX_VIDEO_EDGE_PX,
        }
    }

    /// Returns the suffix of the file name.
    pub(in crate::app) fn suffix(&self) -> &'static str {
        match (self.subject, self.format) {
            (ExportSubject::Picture, _) => ".png",
            (_, VideoFormat::PngFiles) => "-{frame}.png",
            (_, VideoFormat::Gif) => ".gif",
            (_, VideoFormat::Webp) => ".webp",
            (_, VideoFormat::Mp4) => ".mp4",
        }
    }
}
