//! Options for opening inputs.

use super::rgbd::RgbdOptions;
use crate::cloud::{ColorDepth, NoData};
use crate::io::ReadOptions;
use crate::stereo::SharedMatcher;
use std::sync::Arc;

/// Keyword given instead of a pose file: frames stay where their files place them.
pub const NO_POSES: &str = "none";

/// Options for opening inputs.
#[derive(Debug, Clone, PartialEq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a choice of its own")]
pub struct OpenOptions {
    /// Options for reading files.
    pub read: ReadOptions,
    /// Handling of points that stand for no measurement.
    pub no_data: NoData,
    /// The minimum range of colours whose type does not determine it; the values decide if `None`.
    pub color_depth: Option<ColorDepth>,
    /// Frame rate in frames per second, overriding the timestamps.
    pub fps: Option<f64>,
    /// The scans of an E57 file are one frame, not a frame each.
    pub merge_scans: bool,
    /// The topic of recordings whose point clouds are the frames; of each the one that has the most if `None`.
    pub topic: Option<Arc<str>>,
    /// Pattern of the names of the files that are frames; all of one sequence if `None`.
    pub only: Option<Arc<str>>,
    /// An empty folder is waited for until its first frame comes.
    pub waits_for_first: bool,
    /// Maximum bit rate for reading from the web, in bits per second.
    pub max_bits_per_s: Option<f64>,
    /// True if dense points are computed from images by stereo even if sparse ones exist.
    pub dense: bool,
    /// Length of a live stream's history that can be rewound, in seconds; the default length if `None`.
    pub live_seconds: Option<f64>,
    /// True if a live stream is requested for the visible points (surfels), with normals and radii, instead of whole
    /// frames.
    pub live_surfels: bool,
    /// Stereo matcher for pairs of images.
    pub matcher: SharedMatcher,
    /// Options for reading recordings of depth images.
    pub rgbd: RgbdOptions,
    /// Permitted locations of the files named by a session.
    pub session_reach: SessionReach,
}

/// Files that a session may open in addition to those in its own folder: the person who opens one knows its name, not
/// its contents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SessionReach {
    /// Addresses: connections to other machines, and ports that are listened at.
    pub network: bool,
    /// Files outside of its folder.
    pub outside: bool,
}

impl SessionReach {
    /// All that it names.
    pub const ANYWHERE: Self = Self {
        network: true,
        outside: true,
    };
}
