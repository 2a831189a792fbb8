//! What `pointreel render` is told.

use super::arguments::{FrameRange, PictureArgs, ReadArgs, size_px};
use super::camera_arguments::CameraArgs;
use super::poses::PosesArgs;
use super::video_arguments::VideoArgs;
use crate::export::PictureSize;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `pointreel render`.
#[derive(Debug, Clone, Args)]
pub(in crate::cli) struct RenderArgs {
    /// A folder, a pattern, files, or a session (.pointreel); `demo:` and `example:lidar` are built in
    #[arg(required = true, value_name = "INPUT")]
    pub(in crate::cli) inputs: Vec<PathBuf>,

    /// Picture to write: .png, .jpg, .webp or .tif, or - for a PNG on stdout; of a range of frames the name
    /// must contain {frame}. Pictures that are there are replaced
    #[arg(
        short,
        long,
        verbatim_doc_comment,
        value_name = "OUT",
        required_unless_present = "video",
        conflicts_with = "video"
    )]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Frame, or range A..B with both ends included, counted from 0 [default: 0, of a video all]
    #[arg(long, value_name = "N|A..B")]
    pub(in crate::cli) frame: Option<FrameRange>,

    /// Picture size in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size_px)]
    pub(in crate::cli) size: [u32; 2],

    /// Draw what the colours mean over the picture
    #[arg(long)]
    pub(super) legend: bool,
    /// Draw a bar of a round length, true at the distance of what the camera looks at
    #[arg(long)]
    pub(super) scale_bar: bool,

    /// JSON file to write counters and times to
    #[arg(long, value_name = "STATS.json")]
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

impl RenderArgs {
    /// How large pictures are, and what is behind the cloud.
    pub(in crate::cli) fn picture_size(&self) -> PictureSize {
        PictureSize {
            is_transparent: self.picture.is_transparent(),
            has_legend: self.legend,
            has_scale_bar: self.scale_bar,
            ..PictureSize::opaque(self.size)
        }
    }
}
