//! What a document holds.

use super::{Draft, Reading};
use crate::kept::Fields;
use crate::scene::{Camera, Clip, FollowedPoint, Gauge, Label, Settings, UpAxis};
use crate::timeline::PlayRange;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// What is open, and all that a user made around it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Document {
    /// What was opened: folders, files, patterns, or words such as `demo:`; at least one.
    pub inputs: Vec<PathBuf>,
    /// How it was opened.
    pub reading: Reading,
    /// The axis that was chosen to be up; guessed if `None`.
    pub up: Option<UpAxis>,
    /// Index of the frame that was shown.
    pub frame: usize,
    /// Where it was seen from; where the sequence is first seen from if `None`.
    pub view: Option<Camera>,
    /// How it was drawn; what belongs to one sequence is not among them.
    pub settings: Settings,
    /// What of it was drawn.
    pub clip: Option<Clip>,
    /// In and out point.
    pub range: PlayRange,
    /// Named frames, by frame, one a frame at most.
    pub markers: Vec<Marker>,
    /// What was measured, oldest first.
    pub measurements: Vec<Measured>,
    /// Texts at points, oldest first.
    pub labels: Arc<Vec<Label>>,
    /// Paths of points through time.
    pub trails: ShownTrails,
    /// The camera path, or the beginning of one.
    pub path: Arc<Draft>,
    /// The sequence beside it.
    pub compare: Option<Compared>,
    /// Free text.
    pub notes: String,
    /// Fields that another version of the program wrote.
    pub unknown: Unknown,
}

impl Document {
    /// The settings with the clip.
    pub fn style(&self) -> Settings {
        self.settings.with(|style| style.clip = self.clip)
    }

    /// Takes the settings and the clip of `style`.
    pub fn set_style(&mut self, style: Settings) {
        self.clip = style.clip;
        self.settings = style.with(|style| style.clip = None);
    }
}

/// Trails that are shown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ShownTrails {
    /// Those of the points that were picked.
    pub of_picked: bool,
    /// Points whose trails stay when others are picked.
    pub kept: Vec<MeasuredPoint>,
    /// Those of points that are spread over the frame.
    pub spread: Option<SpreadTrails>,
}

/// Trails of points that are spread evenly over the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpreadTrails {
    /// Number of points.
    pub points: usize,
    /// Frames before the shown one.
    pub frames: usize,
}

/// A sequence next to that of the document.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// What was opened: as [`Document::inputs`].
    pub inputs: Vec<PathBuf>,
    /// Its topic, of a recording with several.
    pub topic: Option<String>,
    /// By what frames belong together; as is usual for the two if `None`.
    pub by: Option<ComparedBy>,
    /// Its frames are so many later.
    pub offset_frames: i64,
    /// How both are laid out.
    pub layout: ComparedLayout,
    /// Where the line between both is, as a share of the width.
    pub line: f64,
}

/// By what frames of two sequences belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparedBy {
    /// Their places in the sequences.
    Index,
    /// The numbers in their names.
    Number,
    /// When they were taken.
    Time,
}

/// How two pictures are laid out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparedLayout {
    /// Each in a half of its own.
    #[default]
    SideBySide,
    /// One over the other, with a line between them.
    Line,
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

/// A point of a measurement, or of a trail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Index of the frame in which it was clicked on.
    pub frame: usize,
    /// The point that it follows.
    pub point: FollowedPoint,
    /// Where it was last, in the coordinates of the file.
    pub place: DVec3,
}
