//! Arguments of `pointreel render`.

use super::arguments::{PictureArgs, ReadArgs};
use super::camera_arguments::CameraArgs;
use super::poses::PosesArgs;
use super::size_arguments::SizeArgs;
use super::values::FrameChoice;
use super::video_arguments::VideoArgs;
use crate::export::PictureSize;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `pointreel render`.
#[derive(Debug, Clone, Args)]
pub(in crate::cli) struct RenderArgs {
    /// Folder, pattern, files or session (.pointreel); `demo:` and `example:lidar` are built in
    #[arg(required = true, value_name = "INPUT")]
    pub(in crate::cli) inputs: Vec<PathBuf>,

    /// Image to write: .png, .jpg, .webp or .tif, or - for a PNG on stdout; name a range of frames with {frame} or
    /// {frame:04}. Existing images are replaced
    #[arg(
        short,
        long,
        value_name = "OUT",
        required_unless_present = "video",
        conflicts_with = "video"
    )]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Frame or inclusive range A..B, counted from 0; last or -1 is the last one [default: 0, for videos all]
    #[arg(long, value_name = "N|A..B", allow_hyphen_values = true)]
    pub(in crate::cli) frame: Option<FrameChoice>,

    #[command(flatten)]
    pub(in crate::cli) size: SizeArgs,

    /// Draw the colour legend
    #[arg(long)]
    pub(super) legend: bool,

    /// Draw a scale bar (exact at the focus distance)
    #[arg(long, hide_short_help = true)]
    pub(super) scale_bar: bool,

    /// Write counters and timings to this JSON file
    #[arg(long, value_name = "FILE.json", hide_short_help = true)]
    pub(in crate::cli) stats: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) video: VideoArgs,

    #[command(flatten)]
    pub(in crate::cli) read: ReadArgs,

    #[command(flatten)]
    pub(in crate::cli) picture: PictureArgs,

    #[command(flatten)]
    pub(in crate::cli) poses: PosesArgs,

    #[command(flatten)]
    pub(in crate::cli) camera: CameraArgs,
}

/// Size of images where none is given.
const DEFAULT_SIZE_PX: [u32; 2] = [1280, 720];

impl RenderArgs {
    /// Width and height of images.
    pub(in crate::cli) fn size_px(&self) -> [u32; 2] {
        self.size.of(DEFAULT_SIZE_PX).unwrap_or(DEFAULT_SIZE_PX)
    }

    /// Returns the image size, and the background behind the cloud.
    pub(in crate::cli) fn picture_size(&self) -> PictureSize {
        PictureSize {
            is_transparent: self.picture.is_transparent(),
            has_legend: self.legend,
            has_scale_bar: self.scale_bar,
            ..PictureSize::opaque(self.size_px())
        }
    }
}
