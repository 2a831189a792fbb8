//! `pointreel check`: what may be wrong with a sequence.

use super::arguments::{ReadArgs, open_sequence};
use super::progress::Bar;
use super::{answer, say};
use crate::check::{CheckReport, check};
use anyhow::Context as _;
use clap::Args;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit code when something was found.
const FOUND: u8 = 3;

/// Arguments of `pointreel check`.
#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// A folder, a pattern, or files; `demo:` is the built-in sequence
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Answer in JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

pub(super) fn run(arguments: &CheckArgs) -> anyhow::Result<ExitCode> {
    let sequence = open_sequence(&arguments.inputs, &arguments.read.open_options())?;
    let bar = Bar::new(sequence.len());
    let report = check(&sequence, &|done| bar.set(done));
    bar.clear();
    if arguments.json {
        let json = serde_json::to_string_pretty(&report);
        answer(&json.context("the answer cannot be written as JSON")?);
    } else {
        answer(text(&report).trim_end());
    }
    Ok(if report.findings.is_empty() {
        ExitCode::SUCCESS
    } else {
        say(&match report.findings.len() {
            1 => "1 finding".to_owned(),
            count => format!("{count} findings"),
        });
        ExitCode::from(FOUND)
    })
}

/// The answer for people: a finding a line, then what is known.
fn text(report: &CheckReport) -> String {
    let mut text = String::new();
    for finding in &report.findings {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "- {}", finding.message);
    }
    if report.findings.is_empty() {
        text.push_str("nothing was found\n");
    }
    let _ = writeln!(
        text,
        "{} frames, {} points; {}",
        report.frame_count,
        report.point_count,
        report.attributes.join(", ")
    );
    if let Some([min, max]) = report.bounds {
        let _ = writeln!(text, "from {min:?} to {max:?}");
    }
    if let Some(up) = report.probable_up {
        let _ = writeln!(text, "{up} is probably up");
    }
    if let Some(fps) = report.stamped_fps {
        let _ = writeln!(text, "{fps:.3} frames a second by the time stamps");
    }
    text
}
