//! Video arguments of `pointreel render`.

use crate::scene::CameraPath;
use clap::Args;
use std::path::PathBuf;

/// Video options.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Video")]
pub(in crate::cli) struct VideoArgs {
    /// Video to write: .mp4, .gif, .webp, or PNG files named with {frame}; .mp4 needs ffmpeg; existing files are
    /// replaced
    #[arg(long, value_name = "OUT")]
    pub(in crate::cli) video: Option<PathBuf>,

    /// Move the camera along the keyframes of this file, saved in the window or written by hand
    #[arg(long, value_name = "FILE.json", hide_short_help = true, requires = "video",
        conflicts_with_all = ["output", "turntable", "frame", "up", "azimuth", "elevation", "distance", "fov"])]
    pub(in crate::cli) path: Option<PathBuf>,

    /// The path of a session, where nothing is said.
    #[arg(skip)]
    pub(in crate::cli) path_of_session: Option<CameraPath>,

    /// Orbit the cloud once in N video frames; meanwhile the sequence plays, or --frame stands still
    #[arg(long, value_name = "N", requires = "video", conflicts_with = "output",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(in crate::cli) turntable: Option<u32>,

    /// Revolutions of the turntable; negative ones turn the other way [default: 1]
    #[arg(
        long,
        value_name = "N",
        hide_short_help = true,
        requires = "turntable",
        allow_negative_numbers = true,
        value_parser = turns,
    )]
    pub(in crate::cli) turns: Option<f64>,

    /// Frames per second [default: 30, or that of the sequence]
    #[arg(long, value_name = "FPS", requires = "video", conflicts_with = "output", value_parser = rate)]
    pub(in crate::cli) fps: Option<f64>,

    /// Play the sequence at a multiple of its speed [default: 1]
    #[arg(long, value_name = "FACTOR", requires = "video", conflicts_with_all = ["output", "seconds"],
        hide_short_help = true, value_parser = super::values::positive_f64)]
    pub(in crate::cli) speed: Option<f64>,

    /// Duration of the video, instead of --fps or the duration of the path
    #[arg(
        long,
        alias = "duration",
        hide_short_help = true,
        value_name = "SECONDS",
        requires = "video",
        conflicts_with = "output",
        value_parser = seconds,
    )]
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
    number(text, 0.1..=1000.0, "frames per second from 0.1 to 1000")
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text, 0.001..=1e6, "seconds from 0.001 to 1000000")
}

fn turns(text: &str) -> Result<f64, String> {
    number(text, -1000.0..=1000.0, "turns from -1000 to 1000")
}
