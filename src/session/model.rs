//! What a session holds.

use super::Reading;
use crate::kept::Fields;
use crate::scene::{Camera, CameraPath, Clip, FollowedPoint, Gauge, Label, Style};
use crate::timeline::PlayRange;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// All that a person made around a sequence.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Session {
    /// What was opened: folders, files, patterns, or words such as `demo:`; at least one.
    pub inputs: Vec<PathBuf>,
    /// How it was opened.
    pub reading: Reading,
    /// Index of the frame that was shown.
    pub frame: usize,
    /// Where it was seen from; where the sequence is first seen from if `None`.
    pub view: Option<Camera>,
    /// How it was drawn; what belongs to one sequence is not among them.
    pub settings: Style,
    /// What of it was drawn.
    pub clip: Option<Clip>,
    /// In and out point.
    pub range: PlayRange,
    /// Named frames, by frame, one a frame at most.
    pub markers: Vec<Marker>,
    /// What was measured, oldest first.
    pub measurements: Vec<Measured>,
    /// Texts at points, oldest first.
    pub labels: Vec<Label>,
    /// The camera path.
    pub path: Option<CameraPath>,
    /// What another version of the program wrote beside it.
    pub unknown: Unknown,
}

impl Session {
    /// The settings with the clip.
    pub fn style(&self) -> Style {
        self.settings.with(|style| style.of_sequence.clip = self.clip)
    }
}

/// Fields of a file that are not known here, and are written again.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Unknown {
    pub(super) session: Fields,
    pub(super) settings: Fields,
}

/// A named frame.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Marker {
    /// Which frame.
    pub frame: usize,
    /// What a person calls it; may be empty.
    #[serde(default)]
    pub name: String,
}

/// A measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// What was measured.
    pub gauge: Gauge,
    /// Its points, as many as the gauge takes.
    pub points: Vec<MeasuredPoint>,
}

/// A point of a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Index of the frame in which it was clicked on.
    pub frame: usize,
    /// The point that it follows.
    pub point: FollowedPoint,
    /// Where it was last, in the coordinates of the file.
    pub place: DVec3,
}
