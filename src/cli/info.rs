//! `pointreel info`: what is in the frames of a sequence, in the coordinates of the files.

use super::arguments::open_sequence;
use super::{answer, say};
use crate::sequence::Sequence;
use anyhow::{Context as _, bail};
use clap::Args;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Arguments of `pointreel info`.
#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    /// A folder, a pattern, or files; `demo:` is the built-in sequence
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Answer in JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Info {
    frames: Vec<FrameInfo>,
    origin: [f64; 3],
}

#[derive(Serialize)]
struct FrameInfo {
    index: usize,
    file: String,
    #[serde(flatten)]
    content: Content,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Content {
    Read {
        points: usize,
        finite_points: usize,
        /// Null without a finite point.
        min: Option<[f64; 3]>,
        max: Option<[f64; 3]>,
        attributes: Vec<&'static str>,
    },
    Failed {
        error: String,
    },
}

pub(super) fn run(arguments: &InfoArgs) -> anyhow::Result<()> {
    let sequence = open_sequence(&arguments.inputs)?;
    // Rayon decodes as many frames at once as there are cores, and keeps none.
    let frames: Vec<FrameInfo> = (0..sequence.len())
        .into_par_iter()
        .map(|index| frame_info(&sequence, index))
        .collect();
    let failures: Vec<&String> = frames
        .iter()
        .filter_map(|frame| match &frame.content {
            Content::Failed { error } => Some(error),
            Content::Read { .. } => None,
        })
        .collect();
    if let (true, Some(first)) = (failures.len() == frames.len(), failures.first()) {
        match failures.len() {
            1 => bail!("{first}"),
            count => bail!("none of the {count} frames can be read; the first: {first}"),
        }
    }
    for error in failures {
        say(&format!("warning: {error}"));
    }
    let info = Info {
        frames,
        origin: sequence.origin().to_array(),
    };
    if arguments.json {
        answer(
            &serde_json::to_string_pretty(&info).context("the answer cannot be written as JSON")?,
        );
    } else {
        answer(table(&info).trim_end());
    }
    Ok(())
}

fn frame_info(sequence: &Sequence, index: usize) -> FrameInfo {
    let content = match sequence.decode(index) {
        Ok(raw) => {
            let (finite_points, bounds) = raw.positions.finite_bounds();
            Content::Read {
                points: raw.positions.len(),
                finite_points,
                min: bounds.map(|(min, _)| min.to_array()),
                max: bounds.map(|(_, max)| max.to_array()),
                attributes: raw.attributes(),
            }
        }
        Err(error) => Content::Failed {
            error: error.to_string(),
        },
    };
    FrameInfo {
        index,
        file: sequence.source(index).path.display().to_string(),
        content,
    }
}

/// The answer for people: a line a frame.
fn table(info: &Info) -> String {
    let mut text = format!(
        "{:>6} {:>10} {:>10}  {:<52} attributes, file\n",
        "frame", "points", "finite", "bounds"
    );
    for frame in &info.frames {
        // Writing to a String cannot fail.
        let _ = match &frame.content {
            Content::Read {
                points,
                finite_points,
                min,
                max,
                attributes,
            } => {
                let bounds = match (min, max) {
                    (Some(min), Some(max)) => (0..3)
                        .map(|axis| format!("{}..{}", short(min[axis]), short(max[axis])))
                        .collect::<Vec<_>>()
                        .join(" "),
                    _ => "none".to_owned(),
                };
                writeln!(
                    text,
                    "{:>6} {points:>10} {finite_points:>10}  {bounds:<52} {}, {}",
                    frame.index,
                    attributes.join(" "),
                    frame.file
                )
            }
            Content::Failed { error } => {
                writeln!(text, "{:>6} cannot be read: {error}", frame.index)
            }
        };
    }
    let [x, y, z] = info.origin;
    let _ = writeln!(text, "{} frames, origin {x} {y} {z}", info.frames.len());
    text
}

/// A coordinate with as many digits as fit a column.
fn short(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e7) {
        format!("{value:.3e}")
    } else {
        format!("{value:.3}")
    }
}
