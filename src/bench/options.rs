//! Benchmark options: the subject and the method of measurement.

use super::excluded::Excluded;
use super::lab::LabPoint;
use super::modes::Modes;
use super::point_share::PointShare;
use super::rate::RatePoint;
use super::suite::{Defaults, OptionGroup, Suite};
use crate::persist;
use crate::sequence::{Sequence, Shape};
use std::path::PathBuf;
use std::sync::Arc;

/// Options of a benchmark run.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct BenchOptions {
    /// Suite to run.
    pub suite: &'static Suite,
    /// Image size; at least 1×1.
    pub viewport_px: [u32; 2],
    /// Directions from which each frame is seen; at least 1. The protocol wants 8.
    pub viewpoints: usize,
    /// Frames of each sequence, spread evenly; at least 1. For suites that play, the number of shown frames, looping.
    pub frames: usize,
    /// The frame that is chosen first, by suites that take it.
    pub first_frame: usize,
    /// Memory for prepared frames of suites that play, bytes; the loader's default if `None`.
    pub budget_bytes: Option<usize>,
    /// Rounds over all viewpoints before the clocks count.
    pub warmup: usize,
    /// Rounds over all viewpoints that count; at least 1.
    pub repeat: usize,
    /// Render modes compared by the suite that compares them; all by default.
    pub modes: Modes,
    /// Share of the points of each frame that is drawn, by the suite that compares it with the truth of all of them;
    /// all by default.
    pub subsample: Option<PointShare>,
    /// Point counts of the clouds that are generated in addition to the inputs, by the suite that generates some.
    pub cloud_points: Vec<usize>,
    /// Images held out by the suite that compares with them.
    pub leave_out: Excluded,
    /// Folder in which ground-truth images are cached for the next run; `None` caches none.
    #[serde(skip)]
    pub truth_folder: Option<PathBuf>,
}

impl BenchOptions {
    /// The paper's protocol for `suite`; for other suites, options that take minutes instead of hours.
    pub fn new(suite: &'static Suite) -> Self {
        let Defaults {
            viewport_px,
            viewpoints,
            frames,
        } = suite.defaults;
        Self {
            suite,
            viewport_px,
            viewpoints,
            frames,
            first_frame: 0,
            budget_bytes: None,
            warmup: 1,
            repeat: 3,
            modes: Modes::default(),
            subsample: None,
            cloud_points: if suite.takes(OptionGroup::Clouds) {
                vec![1_000_000, 4_000_000]
            } else {
                Vec::new()
            },
            leave_out: Excluded::default(),
            truth_folder: None,
        }
    }

    /// The folder of this user for [`BenchOptions::truth_folder`]; `None` where the system has no such place.
    pub fn truth_folder_of_person() -> Option<PathBuf> {
        persist::cached_place_of("truth")
    }
}

/// A sequence to measure.
#[derive(Debug, Clone)]
pub struct Input {
    /// Its name in reports.
    pub name: String,
    /// Its frames.
    pub sequence: Arc<Sequence>,
    /// The shape that it was sampled from, if its truth is known.
    pub shape: Option<Shape>,
}

impl Input {
    /// One frame of a torus with this many points.
    pub(super) fn torus(points: usize) -> Self {
        Self {
            name: format!("torus of {points}"),
            sequence: Arc::new(Sequence::of(Shape::Torus.frame(points))),
            shape: Some(Shape::Torus),
        }
    }
}

/// Progress report of a run.
#[derive(Debug, Clone, Default)]
pub struct Step {
    /// Steps done.
    pub done: usize,
    /// Steps of the whole run; 0 while unknown.
    pub total: usize,
    /// Label of the current measurement.
    pub label: String,
    /// Result that has just been measured, if it is the reason for this report.
    pub measured: Option<Measured>,
}

/// Intermediate result that can be shown before a run is over.
#[derive(Debug, Clone)]
pub enum Measured {
    /// Render mode by time and error.
    Way(Arc<LabPoint>),
    /// An encoding of a frame, by rate and distortion.
    Rate(Arc<RatePoint>),
}

impl Measured {
    /// The encoding in a few words.
    pub fn label(&self) -> &str {
        match self {
            Self::Way(point) => &point.label,
            Self::Rate(point) => &point.label,
        }
    }
}

impl From<LabPoint> for Measured {
    fn from(point: LabPoint) -> Self {
        Self::Way(Arc::new(point))
    }
}

impl From<RatePoint> for Measured {
    fn from(point: RatePoint) -> Self {
        Self::Rate(Arc::new(point))
    }
}
