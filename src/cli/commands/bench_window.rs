//! The suite of `pointreel bench` that opens a window.

pub(in crate::cli) use crate::app::PresentChoice;

use crate::app;
use crate::bench::{self, BenchOptions, Input, Report};
use crate::scene::{Choice, RendererChoice};

/// Measures the window.
pub(super) fn measure_window(
    inputs: &[Input],
    options: BenchOptions,
    present: Option<PresentChoice>,
    renderer: Option<Choice<RendererChoice>>,
) -> anyhow::Result<Report> {
    let present = present.unwrap_or_default();
    let renderer = renderer.unwrap_or_default();
    let actions = app::bench_window(inputs, &options, present, renderer)?;
    Ok(bench::window_report(inputs, options, &actions))
}
