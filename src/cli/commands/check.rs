//! `pointreel check`: possible problems of a sequence.

use crate::assumption::Subject;
use crate::check::{CheckReport, Severity, check};
use crate::cli::options::arguments::{ReadArgs, open_sequence_and_tell};
use crate::cli::terminal::output::{answer, say};
use crate::cli::terminal::progress::Bar;
use crate::cli::terminal::{assumptions, warnings};
use crate::messages::by_kind;
use anyhow::Context as _;
use clap::Args;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit code of errors and warnings.
const FOUND: u8 = 3;

/// Arguments of `pointreel check`.
#[derive(Debug, Args)]
pub(in crate::cli) struct CheckArgs {
    /// Folder, pattern or files; `demo:` and `example:lidar`, `depth` or `model` are built in
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

pub(in crate::cli) fn run(arguments: &CheckArgs, lists_all: bool) -> anyhow::Result<ExitCode> {
    let sequence = open_sequence_and_tell(&arguments.inputs, &arguments.read.open_options())?;
    let bar = Bar::new(sequence.len());
    let mut report = check(&sequence, &|done| bar.set(done));
    bar.clear();
    let look = assumptions::first_look(&sequence);
    // The up axis that an image would use, which is determined from several frames.
    report.probable_up = look.as_ref().map(|look| look.up.name()).or(report.probable_up);
    assumptions::print_guesses(&sequence, look.as_ref(), &[Subject::FrameTimes]);
    let mut guesses = assumptions::of(&sequence, look.as_ref());
    guesses.retain(|assumption| assumption.evidence.is_guess());
    if let Some(line) = assumptions::options_elsewhere::<CheckArgs>(&guesses) {
        warnings::remark(line);
    }
    if arguments.json {
        let json = serde_json::to_string_pretty(&report);
        answer(&json.context("the answer cannot be written as JSON")?);
    } else {
        answer(text(&report, lists_all).trim_end());
    }
    let counts = [Severity::Error, Severity::Warning, Severity::Note].map(|severity| {
        let findings = report.findings.iter().filter(|finding| finding.severity == severity);
        (severity, findings.count())
    });
    let words = counts.iter().filter(|(_, count)| *count > 0);
    let words: Vec<String> = words
        .map(|(severity, count)| format!("{count} {}{}", severity.name(), if *count == 1 { "" } else { "s" }))
        .collect();
    if !words.is_empty() {
        say(&words.join(", "));
    }
    let is_clean = report.findings.iter().all(|finding| finding.severity == Severity::Note);
    Ok(if is_clean {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(FOUND)
    })
}

/// The answer as text: one line per kind of finding, or each finding if all are to be listed, then the known facts.
fn text(report: &CheckReport, lists_all: bool) -> String {
    let mut text = String::new();
    let messages: Vec<String> = report
        .findings
        .iter()
        .map(|finding| format!("{}: {}", finding.severity.name(), finding.message))
        .collect();
    let messages = messages.iter().map(String::as_str);
    let lines = if lists_all {
        messages.map(|message| (message, 0)).collect()
    } else {
        by_kind(messages)
    };
    for (message, count) in lines {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "- {message}{}", warnings::more(count, "like it"));
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
        let _ = writeln!(text, "{fps:.3} frames per second by the time stamps");
    }
    text
}
