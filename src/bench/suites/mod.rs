//! The table of suites: the paper's tables in their order, then further ones.
//!
//! A suite is a file here, which has its [`Suite`] and its loop, and a row.

mod accuracy;
mod coded;
mod draw;
mod error;
mod lod;
mod octree;
mod paper_style;
mod pass_samples;
mod play;
mod primitives;
mod reel;
mod render;
mod rgbd;
mod stability;
mod temporal;
mod torus_mesh;
mod traversals;
mod turning;
mod vdts;
mod window;

pub use accuracy::ACCURACY;
pub use coded::CODED;
pub use draw::{SURFELS, VOXELS};
pub use error::ERROR;
pub use lod::LOD;
pub use octree::OCTREE;
pub use play::PLAY;
pub use primitives::PRIMITIVES;
pub use reel::{RATE, REEL};
pub use render::RENDER;
pub use rgbd::RGBD;
pub use stability::STABILITY;
pub use temporal::TEMPORAL;
pub use vdts::VDTS;
pub use window::{WINDOW, WindowAction, window_report, window_report_of_json};

use super::error::BenchError;
use super::run::Run;
use super::suite::Suite;
use crate::messages::listed;

/// Adds its rows to the report of a run.
type Measure = fn(&mut Run<'_>) -> Result<(), BenchError>;

const TABLE: &[(&Suite, Measure)] = &[
    (SURFELS, draw::measure_surfels),
    (OCTREE, octree::measure),
    (VOXELS, draw::measure_voxels),
    (ACCURACY, accuracy::measure),
    (RENDER, render::measure),
    (PLAY, play::measure),
    (WINDOW, window::measure),
    (ERROR, error::measure),
    (TEMPORAL, temporal::measure),
    (LOD, lod::measure),
    (PRIMITIVES, primitives::measure),
    (CODED, coded::measure),
    (REEL, reel::measure),
    (RATE, reel::measure_rates),
    (RGBD, rgbd::measure),
    (VDTS, vdts::measure),
    (STABILITY, stability::measure),
];

/// Every suite.
pub fn all() -> impl Iterator<Item = &'static Suite> {
    TABLE.iter().map(|(suite, _)| *suite)
}

/// The suite with this name.
pub fn named(name: &str) -> Result<&'static Suite, ParseSuiteError> {
    let named = all().find(|suite| suite.name == name);
    named.ok_or_else(|| ParseSuiteError(name.to_owned()))
}

/// Measures the suite that the options of `run` select.
pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let wanted = run.options.suite;
    let row = TABLE.iter().find(|(suite, _)| *suite == wanted);
    let (_, measure) = row.ok_or(BenchError::NoSuite(wanted.name))?;
    measure(run)
}

/// A word that names no suite.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a suite: expected {names}", names = names())]
pub struct ParseSuiteError(String);

fn names() -> String {
    listed(&all().map(Suite::to_string).collect::<Vec<_>>(), "or")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_suite_is_parsed_from_its_name() {
        for suite in all() {
            assert_eq!(named(suite.name()), Ok(suite));
        }
        let error = named("disks").unwrap_err();
        assert_eq!(
            error.to_string(),
            "`disks` is not a suite: expected surfels, octree, voxels, accuracy, render, play, window, error, \
             temporal, lod, primitives, coded, reel, rate, rgbd, vdts or stability"
        );
    }

    #[test]
    fn every_headline_is_a_column() {
        for suite in all() {
            let mut columns = suite.columns.iter();
            assert!(columns.any(|column| column.key == suite.headline), "{suite}");
        }
    }
}
