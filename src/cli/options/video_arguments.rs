//! What `pointreel render` is told of a video.

use crate::scene::CameraPath;
use clap::Args;
use std::path::PathBuf;

/// What a video shows.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Video")]
pub(in crate::cli) struct VideoArgs {
    /// Video to write: .mp4 (by ffmpeg), .gif, .webp, or PNG files named by {frame}; what is there is replaced
    #[arg(long, value_name = "OUT")]
    pub(in crate::cli) video: Option<PathBuf>,

    /// Camera path: a JSON file of keyframes, saved in the window or written by hand
    #[arg(long, value_name = "PATH.json", requires = "video",
        conflicts_with_all = ["output", "turntable", "frame", "up", "azimuth", "elevation", "distance", "fov"])]
    pub(in crate::cli) path: Option<PathBuf>,

    /// The path of a session, where nothing is said.
    #[arg(skip)]
    pub(in crate::cli) path_of_session: Option<CameraPath>,

    /// Turn once about the up axis in so many pictures, while frames play or --frame is held
    #[arg(long, value_name = "PICTURES", requires = "video", conflicts_with = "output",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(in crate::cli) turntable: Option<u32>,

    /// Turns of the turntable, negative ones the other way round (usually 1)
    #[arg(long, value_name = "N", requires = "turntable", allow_negative_numbers = true, value_parser = turns)]
    pub(in crate::cli) turns: Option<f64>,

    /// Pictures a second (usually 30, or as the sequence plays)
    #[arg(long, value_name = "F", requires = "video", conflicts_with = "output", value_parser = rate)]
    pub(in crate::cli) fps: Option<f64>,

    /// How long the video lasts, in place of --fps or of the time of the path
    #[arg(long, value_name = "S", requires = "video", conflicts_with = "output", value_parser = seconds)]
    pub(in crate::cli) seconds: Option<f64>,
}

impl VideoArgs {
    /// True if the camera moves along a path, which has an up axis of its own.
    pub(in crate::cli) fn has_path(&self) -> bool {
        self.path.is_some() || self.path_of_session.is_some()
    }
}

fn number(text: &str, range: std::ops::RangeInclusive<f64>, expected: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value| range.contains(value))
        .ok_or_else(|| format!("expected {expected}"))
}

fn rate(text: &str) -> Result<f64, String> {
    number(text, 0.1..=1000.0, "pictures a second from 0.1 to 1000")
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text, 0.001..=1e6, "seconds from 0.001 to 1000000")
}

fn turns(text: &str) -> Result<f64, String> {
    number(text, -1000.0..=1000.0, "turns from -1000 to 1000")
}
