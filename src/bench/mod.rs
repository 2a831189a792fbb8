//! The program measures itself by the protocol of paper 000 §VII: pictures of 1920×1280 from viewpoints around the
//! object, 25 to 85 % of the pixels covered, after a warm-up, by CPU and GPU clocks.
//!
//! | suite | the paper's | one row |
//! |---|---|---|
//! | [`Suite::Surfels`] | Table II | sequence × instancing strategy: drawing surfels, two-pass enlarged, factor 2 |
//! | [`Suite::Octree`] | Table III | sequence × δ of 2, 10, 50 %: loss, depth, nodes, leaves, build, traverse |
//! | [`Suite::Voxels`] | Table IV | sequence × instancing strategy: drawing the visible set |
//! | [`Suite::Accuracy`] | – | normals by noise and neighbours; leaves by δ; levels of detail by threshold τ: error beside time |
//! | [`Suite::Render`] | 001, Table 1 | sequence × primitive × distance: processor beside adapter |
//! | [`Suite::Play`] | – | sequence × primitive: rate held, points shown, frames late and skipped, memory |
//! | [`Suite::Window`] | – | sequence × primitive × action: pictures presented, latency, processor time by part |
//! | [`Suite::Error`] | – | sequence × way to draw: error against the truth beside time |
//!
//! `scenario` places the viewpoints by what the suite draws (the octree's by surfels) and `cover` counts their pixels,
//! `runner` holds the clocks, `suites` are the loops, `report` the answer. The command line and the window's benchmark
//! menu both call [`run`]; nothing else of the program runs meanwhile: frames are prepared on the calling thread before
//! they are measured, since a loader's workers would take its cores.

mod cover;
mod environment;
mod lab;
mod modes;
pub mod report;
mod runner;
mod scenario;
mod statistics;
mod suites;
mod truth_cache;

pub use environment::Environment;
pub use lab::{LabPoint, Quality, QualityChoice, QualityKey, mark_front};
pub use modes::{Modes, ParseModeError};
pub use report::{Cell, Column, Report, Row, SequenceSummary, Table};
pub use scenario::{COVERAGE_BAND, Coverage};
pub use statistics::Quantiles;
pub use suites::window::{WindowAction, window_report, window_report_of_json};

use crate::kept;
use crate::measure::{SizeMismatch, SsimError, SurfaceMismatch};
use crate::progress::Progress;
use crate::render::RenderError;
use crate::render::gpu::Context;
use crate::sequence::{Sequence, SequenceError, Shape};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Suite {
    /// Drawing surfels by each instancing strategy.
    Surfels,
    /// Building and traversing octrees of three depths.
    Octree,
    /// Drawing voxels by each instancing strategy.
    Voxels,
    /// Errors of normals, octrees and levels of detail.
    Accuracy,
    /// Drawing on the processor and on the adapter, from three distances.
    Render,
    /// Playing by the clock: what rate is held, with how many points, in how much memory.
    Play,
    /// A real window that plays, is turned and scrubbed: what it presents, how late, and what that costs.
    Window,
    /// Errors of pictures beside their times, for every way to draw.
    Error,
}

impl Suite {
    /// Every suite: the paper's tables in their order, then what is beyond them.
    pub const ALL: &'static [Self] = &[
        Self::Surfels,
        Self::Octree,
        Self::Voxels,
        Self::Accuracy,
        Self::Render,
        Self::Play,
        Self::Window,
        Self::Error,
    ];

    /// The word for it on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surfels => "surfels",
            Self::Octree => "octree",
            Self::Voxels => "voxels",
            Self::Accuracy => "accuracy",
            Self::Render => "render",
            Self::Play => "play",
            Self::Window => "window",
            Self::Error => "error",
        }
    }

    /// One line for people.
    pub fn description(self) -> &'static str {
        match self {
            Self::Surfels => "drawing surfels, two-pass-enlarged (2x), by instancing strategy",
            Self::Octree => "building and traversing octrees by acceptable loss",
            Self::Voxels => "drawing voxels of the visible set by instancing strategy",
            Self::Accuracy => {
                "errors of normals, octree leaves and levels of detail, beside their times"
            }
            Self::Render => "drawing on the processor and on the adapter, from three distances",
            Self::Play => {
                "playing by the clock, drawn but not presented: rate held, points shown, late and skipped frames, memory"
            }
            Self::Window => {
                "a real window, played, turned and scrubbed: rate presented, latency, processor time by part"
            }
            Self::Error => {
                "errors of pictures against the truth beside their times, for every way to draw"
            }
        }
    }
}

impl fmt::Display for Suite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// A word that names no suite.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no suite: expected surfels, octree, voxels, accuracy, render, play, window or error"
)]
pub struct ParseSuiteError(String);

impl FromStr for Suite {
    type Err = ParseSuiteError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.iter().copied().find(|suite| suite.name() == text);
        named.ok_or_else(|| ParseSuiteError(text.to_owned()))
    }
}

/// How to measure.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct BenchOptions {
    /// What to measure.
    pub suite: Suite,
    /// Picture size; at least 1×1.
    pub viewport_px: [u32; 2],
    /// Directions from which each frame is seen; at least 1. The protocol wants 8.
    pub viewpoints: usize,
    /// Frames of each sequence, spread evenly; at least 1. For [`Suite::Play`] and [`Suite::Window`] how many are
    /// shown, turn after turn.
    pub frames: usize,
    /// Memory for prepared frames of [`Suite::Play`], bytes; the loader's default if `None`.
    pub budget_bytes: Option<usize>,
    /// Rounds over all viewpoints before the clocks count.
    pub warmup: usize,
    /// Rounds over all viewpoints that count; at least 1.
    pub repeat: usize,
    /// Which ways to draw [`Suite::Error`] compares; all by default.
    pub modes: Modes,
    /// Where true pictures are kept for the next run; `None` keeps none.
    #[serde(skip)]
    pub truth_folder: Option<PathBuf>,
}

impl BenchOptions {
    /// Viewpoints that the protocol asks for.
    pub const PROTOCOL_VIEWPOINTS: usize = 8;

    /// The paper's protocol for `suite`; for those that are not the paper's, what takes minutes instead of hours.
    pub fn new(suite: Suite) -> Self {
        let (viewport_px, viewpoints, frames) = match suite {
            Suite::Surfels | Suite::Octree | Suite::Voxels | Suite::Accuracy => {
                ([1920, 1280], Self::PROTOCOL_VIEWPOINTS, 3)
            }
            Suite::Render => ([1920, 1080], 2, 1),
            Suite::Play => ([1280, 720], 1, 300),
            Suite::Window => ([1280, 800], 1, 300),
            Suite::Error => ([1280, 720], 2, 1),
        };
        Self {
            suite,
            viewport_px,
            viewpoints,
            frames,
            budget_bytes: None,
            warmup: 1,
            repeat: 3,
            modes: Modes::default(),
            truth_folder: None,
        }
    }

    /// The folder of this person for [`BenchOptions::truth_folder`]; `None` where the system has no such place.
    pub fn truth_folder_of_person() -> Option<PathBuf> {
        kept::cached_place_of("truth")
    }
}

impl serde::Serialize for Suite {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// What a run says of itself.
#[derive(Debug, Clone, Default)]
pub struct Step {
    /// Steps done.
    pub done: usize,
    /// Steps of the whole run; 0 while unknown.
    pub total: usize,
    /// What is being measured now.
    pub label: String,
    /// What [`Suite::Error`] has just measured, if this is said because of it.
    pub measured: Option<Arc<LabPoint>>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// Cancelled before the end.
    #[error("the benchmark was cancelled")]
    Cancelled,
    /// No input, or a sequence without frames.
    #[error("there is nothing to measure: {0}")]
    Nothing(String),
    /// None of the frames chosen from a sequence can be measured.
    #[error("none of the frames chosen from {sequence} can be measured; the first: {reason}")]
    NoFrame {
        /// Name of the sequence.
        sequence: String,
        /// What is wrong with the first of them.
        reason: String,
    },
    /// A window measures itself.
    #[error("`window` is measured by a window, not without one")]
    NeedsWindow,
    /// An option is 0.
    #[error("the number of {0} must be at least 1")]
    ZeroOption(&'static str),
    /// Two pictures of one run differ in size.
    #[error(transparent)]
    Compare(#[from] SizeMismatch),
    /// A picture is too small for SSIM.
    #[error(transparent)]
    Ssim(#[from] SsimError),
    /// Depths that cannot be compared.
    #[error(transparent)]
    Surface(#[from] SurfaceMismatch),
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The threads that load frames do not start.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The thread to build octrees on does not start.
    #[error(transparent)]
    Thread(#[from] rayon::ThreadPoolBuildError),
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

/// Measures `inputs` on the adapter of `context`; without one, on the processor.
///
/// Blocks until everything is measured; `say` is called before each step, and whether `progress` is cancelled is looked
/// at before each picture. Frames that cannot be read or have no points are skipped, which [`Report::notes`] say.
pub fn run(
    inputs: &[Input],
    options: &BenchOptions,
    context: Option<&Arc<Context>>,
    say: &dyn Fn(Step),
    progress: &Progress,
) -> Result<Report, BenchError> {
    let at_least_1 = [
        ("viewpoints", options.viewpoints),
        ("repetitions", options.repeat),
        ("frames", options.frames),
        (
            "pixels",
            options.viewport_px.into_iter().min().unwrap_or(0) as usize,
        ),
    ];
    if let Some((name, _)) = at_least_1.into_iter().find(|&(_, value)| value == 0) {
        return Err(BenchError::ZeroOption(name));
    }
    if inputs.is_empty() {
        return Err(BenchError::Nothing("no sequence was named".to_owned()));
    }
    let mut run = suites::Run::new(inputs, options, context, say, progress)?;
    match options.suite {
        Suite::Surfels | Suite::Voxels => suites::draw::measure(&mut run)?,
        Suite::Octree => suites::octree::measure(&mut run)?,
        Suite::Accuracy => suites::accuracy::measure(&mut run)?,
        Suite::Render => suites::render::measure(&mut run)?,
        Suite::Play => suites::play::measure(&mut run)?,
        Suite::Window => return Err(BenchError::NeedsWindow),
        Suite::Error => suites::error::measure(&mut run)?,
    }
    Ok(run.into_report())
}

/// Fails once nobody waits for it any more.
fn check_cancelled(progress: &Progress) -> Result<(), BenchError> {
    if progress.is_cancelled() {
        return Err(BenchError::Cancelled);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_suite_reads_back_from_its_name() {
        for &suite in Suite::ALL {
            assert_eq!(suite.name().parse(), Ok(suite));
        }
        let error = "disks".parse::<Suite>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "`disks` is no suite: expected surfels, octree, voxels, accuracy, render, play, window or error"
        );
    }
}
