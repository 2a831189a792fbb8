//! Data model of a document.

use super::{Draft, Reading};
use crate::persist::Fields;
use crate::scene::{Camera, Clip, FollowedPoint, Label, MeasurementKind, Settings, UpAxis};
use crate::timeline::PlayRange;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// Document: the opened sequence, and everything that a user made around it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Document {
    /// Opened inputs: folders, files, patterns, or words such as `demo:`; at least one.
    pub inputs: Vec<PathBuf>,
    /// Options with which the inputs were opened.
    pub reading: Reading,
    /// The axis that was chosen to be up; guessed if `None`.
    pub up: Option<UpAxis>,
    /// Index of the frame that was shown.
    pub frame: usize,
    /// Camera of the view; the initial camera of the sequence if `None`.
    pub view: Option<Camera>,
    /// Render settings; those that belong to one sequence are not included.
    pub settings: Settings,
    /// Clip region: the part of the scene that was drawn.
    pub clip: Option<Clip>,
    /// In and out point.
    pub range: PlayRange,
    /// Named frames, by frame, one a frame at most.
    pub markers: Vec<Marker>,
    /// Measurements, oldest first.
    pub measurements: Vec<Measured>,
    /// Texts at points, oldest first.
    pub labels: Arc<Vec<Label>>,
    /// Paths of points through time.
    pub trails: ShownTrails,
    /// The camera path, or the beginning of one.
    pub path: Arc<Draft>,
    /// Sequence shown for comparison.
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
    /// Visibility of the trails of the picked points.
    pub of_picked: bool,
    /// Points whose trails stay when others are picked.
    pub pinned: Vec<MeasuredPoint>,
    /// Trails of points that are spread over the frame.
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

/// A sequence next to the document's.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Opened inputs: as [`Document::inputs`].
    pub inputs: Vec<PathBuf>,
    /// Its topic, of a recording with several.
    pub topic: Option<String>,
    /// Pairing of frames; the default for the two sequences if `None`.
    pub by: Option<ComparedBy>,
    /// Offset of its frames, in frames.
    pub offset_frames: i64,
    /// Layout of the two sequences.
    pub layout: ComparedLayout,
    /// Position of the divider between both, as a fraction of the width.
    pub line: f64,
}

/// Pairing of the frames of two sequences.
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

/// Layout of two compared images.
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
    /// Index of the frame.
    pub frame: usize,
    /// User-defined name; may be empty.
    #[serde(default)]
    pub name: String,
}

/// A measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Kind of measurement.
    pub kind: MeasurementKind,
    /// Its points, the number that the tool takes.
    pub points: Vec<MeasuredPoint>,
}

/// A point of a measurement, or of a trail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Index of the frame in which it was clicked on.
    pub frame: usize,
    /// The point that it follows.
    pub point: FollowedPoint,
    /// Last known position, in the coordinates of the file.
    pub place: DVec3,
}
