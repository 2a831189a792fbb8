//! `pointreel compare-frames`: how far the points of one frame are from another frame.

use crate::cli::options::arguments::{ReadArgs, open_sequence_and_tell};
use crate::cli::options::values::{FrameChoice, not_negative_f64};
use crate::cli::terminal::output::answer;
use crate::cli::terminal::warnings;
use crate::measure::Change;
use crate::messages::frame_with_index;
use anyhow::{Context as _, bail};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `pointreel compare-frames`.
#[derive(Debug, Args)]
pub(in crate::cli) struct CompareFramesArgs {
    /// Folder, pattern or files; `demo:` and `example:lidar`, `depth` or `model` are built in
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Frame whose points are measured, counted from 0; last or -1 is the last one
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    from: FrameChoice,

    /// Frame to measure the distances to, counted from 0
    #[arg(long, value_name = "B", allow_negative_numbers = true)]
    to: FrameChoice,

    /// Count points farther away than this, in scene units
    #[arg(long, value_name = "LENGTH", default_value = "0", value_parser = not_negative_f64)]
    threshold: f64,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

/// Distances in scene units.
#[derive(Serialize)]
struct Answer {
    from: usize,
    to: usize,
    points: usize,
    mean: f64,
    median: f32,
    quantile_95: f32,
    quantile_99: f32,
    max: f32,
    threshold: f64,
    share_above: f64,
}

pub(in crate::cli) fn run(arguments: &CompareFramesArgs) -> anyhow::Result<()> {
    let sequence = open_sequence_and_tell(&arguments.inputs, &arguments.read.picture_options())?;
    let CompareFramesArgs {
        from, to, threshold, ..
    } = *arguments;
    let count = sequence.len();
    let from = from.one_of("--from", count)?;
    let to = to.one_of("--to", count)?;
    let [pose, other] = [sequence.frame(from)?, sequence.frame(to)?];
    for warning in pose.warnings().iter().chain(other.warnings()) {
        warnings::warn_of_frame(warning);
    }
    let Some(change) = Change::between(pose.positions(), other.positions(), || true) else {
        bail!(
            "{} has no points, so nothing can be measured to it",
            frame_with_index(to, count)
        );
    };
    let found = Answer {
        from,
        to,
        points: pose.len(),
        mean: change.mean,
        median: change.quantile(0.5),
        quantile_95: change.quantile(0.95),
        quantile_99: change.quantile(0.99),
        max: change.largest(),
        threshold,
        share_above: change.share_above(threshold),
    };
    if arguments.json {
        let json = serde_json::to_string_pretty(&found).context("the answer cannot be written as JSON")?;
        answer(&json);
    } else {
        answer(&table(&found, count));
    }
    Ok(())
}

fn table(found: &Answer, count: usize) -> String {
    let [from, to] = [found.from, found.to].map(|index| frame_with_index(index, count));
    let rows = [
        ("points of", from),
        ("to", to),
        ("points", found.points.to_string()),
        ("mean", found.mean.to_string()),
        ("median", found.median.to_string()),
        ("95 %", found.quantile_95.to_string()),
        ("99 %", found.quantile_99.to_string()),
        ("largest", found.max.to_string()),
        (
            "farther away",
            format!("{:.2} % than {}", 100.0 * found.share_above, found.threshold),
        ),
    ];
    rows.map(|(name, value)| format!("{name:<20}{value}")).join("\n")
}
