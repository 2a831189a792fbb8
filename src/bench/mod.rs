//! Benchmarks by the protocol of the 4D media paper §VII: images of 1920×1280 from viewpoints around the object, 25 to
//! 85 % of the pixels covered, after a warm-up, by CPU and GPU clocks.
//!
//! A [`Suite`] is a row of the table in [`suites`], with a file that has its columns, its texts and its loop. `run` has
//! the code common to loops; `scenario` places the viewpoints by the suite's primitive (the octree's by surfels),
//! `cover` counts their pixels, `runner` holds the clocks, `report` is the result. The command line and the window's
//! benchmark menu both call [`run`]; no other part of the program runs meanwhile: frames are prepared on the calling
//! thread before they are measured, since a loader's workers would take its cores.

mod cover;
mod environment;
mod error;
mod excluded;
mod lab;
mod modes;
mod options;
mod point_share;
pub mod rate;
mod report;
mod run;
mod runner;
mod scenario;
mod small_picture;
mod statistics;
mod subject;
mod suite;
pub mod suites;
mod truth_cache;

pub use environment::Environment;
pub use error::BenchError;
pub use excluded::{Excluded, ParseExcludedError};
pub use lab::{LabError, LabPoint, Quality, QualityChoice, QualityKey, mark_fronts};
pub use modes::{Modes, ParseModeError};
pub use options::{BenchOptions, Input, Measured, Step};
pub use point_share::{ParsePointShareError, PointShare};
pub use rate::{RatePoint, Sweep};
pub use report::{Cell, Column, Report, Row, SequenceSummary, Table};
pub use scenario::{COVERAGE_BAND, Coverage};
pub use statistics::Quantiles;
pub use suite::{OptionGroup, Suite};
pub use suites::{WindowAction, window_report, window_report_of_json};

use crate::progress::Progress;
use crate::render::gpu::Context;
use run::Run;
use std::sync::Arc;

/// Measures `inputs` on the adapter of `context`; without one, on the CPU.
///
/// Blocks until everything is measured; `say` is called before each step; `progress` is checked for cancellation before
/// each image. Frames that cannot be read or have no points are skipped, which [`Report::notes`] say.
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
        ("pixels", options.viewport_px.into_iter().min().unwrap_or(0) as usize),
    ];
    if let Some((name, _)) = at_least_1.into_iter().find(|&(_, value)| value == 0) {
        return Err(BenchError::ZeroOption(name));
    }
    if inputs.is_empty() {
        return Err(BenchError::Nothing("no sequence was named".to_owned()));
    }
    let clouds = options.cloud_points.iter().copied().map(Input::torus);
    let inputs: Vec<Input> = clouds.chain(inputs.iter().cloned()).collect();
    let mut run = Run::new(&inputs, options, context, say, progress)?;
    suites::measure(&mut run)?;
    Ok(run.into_report())
}
