//! What a person chose to export.

use crate::export::{MAX_EDGE_PX, VideoFormat};
use std::path::PathBuf;

/// Longest edge of the pictures of a video: several of them are in memory at a time.
const MAX_VIDEO_EDGE_PX: u32 = 16_384;

/// Pictures a second of what moves by itself.
pub(super) const USUAL_RATE: f64 = 30.0;

/// What is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportSubject {
    /// What is on the screen, in any size.
    Picture,
    /// The camera turns about the up axis.
    Turntable,
    /// The camera path.
    Path,
    /// The sequence plays from in to out point while the camera stands still.
    Sequence,
}

impl ExportSubject {
    /// What files are called after.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Turntable => "turntable",
            Self::Path => "path",
            Self::Sequence => "sequence",
        }
    }
}

/// What a person chose, and what is known of the machine.
#[derive(Debug, Clone)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a check box, and one is known of the machine"
)]
pub struct Export {
    /// What is shown.
    pub subject: ExportSubject,
    /// Width and height of the pictures; those of the window if `None`.
    pub size_px: Option<[u32; 2]>,
    /// What videos are written as; pictures are PNG files.
    pub format: VideoFormat,
    /// Pictures a second.
    pub per_second: f64,
    /// Pictures of a turntable.
    pub pictures: usize,
    /// Its turns, negative the other way.
    pub turns: f64,
    /// The turntable holds the shown frame in place of playing.
    pub holds_frame: bool,
    /// Nothing is behind the cloud, where the format can say so.
    pub is_transparent: bool,
    /// What the colours mean is drawn over the pictures.
    pub has_legend: bool,
    /// A bar of a round length is at the lower left.
    pub has_scale_bar: bool,
    /// The folder of the file.
    pub folder: String,
    /// Its name without extension; made from sequence and subject if `None`.
    pub name: Option<String>,
    /// Whether MP4 can be written.
    pub has_ffmpeg: bool,
    /// Whether the last file that was looked for is there.
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
    /// Whether pictures are without background: as chosen, where the format can be.
    pub fn has_alpha(&self) -> bool {
        self.is_transparent && self.can_have_alpha()
    }

    /// Whether the format can be without background.
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

    /// What the file's name ends in.
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
