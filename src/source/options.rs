//! How inputs are opened.

use super::rgbd::RgbdOptions;
use crate::cloud::{ColorDepth, NoData};
use crate::io::ReadOptions;
use crate::stereo::SharedMatcher;
use std::sync::Arc;

/// In place of a file with poses: frames stay where their files have them.
pub const NO_POSES: &str = "none";

/// How inputs are opened.
#[derive(Debug, Clone, PartialEq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a choice of its own")]
pub struct OpenOptions {
    /// How files are read.
    pub read: ReadOptions,
    /// Handling of points that stand for no measurement.
    pub no_data: NoData,
    /// The least range of colours whose type does not say it; the values decide if `None`.
    pub color_depth: Option<ColorDepth>,
    /// Frames a second, in place of what time stamps say.
    pub fps: Option<f64>,
    /// The scans of an E57 file are one frame, not a frame each.
    pub merge_scans: bool,
    /// The topic of recordings whose point clouds are the frames; of each the one that has the most if `None`.
    pub topic: Option<Arc<str>>,
    /// Pattern of the names of the files that are frames; all of one sequence if `None`.
    pub only: Option<Arc<str>>,
    /// An empty folder is waited for until its first frame comes.
    pub waits_for_first: bool,
    /// Bits a second that are read from the web, at most.
    pub most_bits_per_s: Option<f64>,
    /// Points of photographs are made by stereo, also where there are sparse ones.
    pub dense: bool,
    /// How much of a live stream can be gone back to, seconds; as much as usual if `None`.
    pub live_seconds: Option<f64>,
    /// A live stream is asked for the points that are seen, with normals and radii, in place of whole frames.
    pub live_surfels: bool,
    /// Who matches pairs of photographs.
    pub matcher: SharedMatcher,
    /// How recordings of depth images are read.
    pub rgbd: RgbdOptions,
    /// Where the files that a session names may be.
    pub session_reach: SessionReach,
}

/// What a session may open beside the files in its own folder: who opens one knows its name, not what is in it.
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
