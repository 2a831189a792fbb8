//! Stub for the suite that opens a window, in a build without one.

#![allow(
    clippy::needless_pass_by_value,
    reason = "functions take what those of the real module take"
)]

use crate::bench::{BenchOptions, Input, Report};
use crate::cli::options::usage::UsageError;
use crate::scene::{Choice, RendererChoice};
use std::str::FromStr;

const ABSENT: &str = "this build has no window: build with `--features window`";

/// Presentation backend of a window: none can be named.
#[derive(Debug, Clone, Copy)]
pub(super) enum PresentChoice {}

impl FromStr for PresentChoice {
    type Err = &'static str;

    fn from_str(_text: &str) -> Result<Self, Self::Err> {
        Err(ABSENT)
    }
}

/// Refuses.
pub(super) fn measure_window(
    _inputs: &[Input],
    _options: BenchOptions,
    _present: Option<PresentChoice>,
    _renderer: Option<Choice<RendererChoice>>,
) -> anyhow::Result<Report> {
    Err(UsageError(ABSENT.to_owned()).into())
}
