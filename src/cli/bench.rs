//! `pointreel bench`: the suites of the benchmark menu, without a window.

use super::arguments::{DEMO_INPUT, open_sequence, size_px};
use super::{answer, say};
use crate::bench::{self, BenchOptions, Progress, Suite};
use crate::render::gpu::{Context, ContextOptions};
use anyhow::Context as _;
use clap::Args;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Arguments of `pointreel bench`.
#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    /// surfels, octree or voxels (Tables II, III and IV of the paper), or accuracy (errors beside times)
    #[arg(value_name = "SUITE")]
    suite: Suite,

    /// Folders, patterns or files, each a sequence of its own; `demo:` is the built-in one
    #[arg(default_value = DEMO_INPUT, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// JSON file to write the report to
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,

    /// CSV file to write the rows to
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,

    /// Frames of each sequence, spread evenly
    #[arg(long, value_name = "N", default_value_t = BenchOptions::DEFAULT_FRAMES, value_parser = count)]
    frames: usize,

    /// Picture size in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1280", value_parser = size_px)]
    size: [u32; 2],

    /// Directions from which each frame is seen
    #[arg(long, value_name = "N", default_value_t = BenchOptions::PROTOCOL_VIEWPOINTS, value_parser = count)]
    viewpoints: usize,

    /// Timed rounds over all viewpoints
    #[arg(long, value_name = "N", default_value = "3", value_parser = count)]
    repeat: usize,
}

pub(super) fn run(arguments: &BenchArgs) -> anyhow::Result<()> {
    let mut inputs = Vec::new();
    for input in &arguments.inputs {
        let sequence = open_sequence(std::slice::from_ref(input))?;
        inputs.push((sequence_name(input), Arc::new(sequence)));
    }
    let options = BenchOptions {
        viewport_px: arguments.size,
        viewpoints: arguments.viewpoints,
        frames: Some(arguments.frames),
        repeat: arguments.repeat,
        ..BenchOptions::new(arguments.suite)
    };
    let context = Context::headless(&ContextOptions::default())?;
    let report = bench::run(
        &inputs,
        &options,
        &context,
        &show_progress,
        &AtomicBool::new(false),
    );
    clear_progress();
    let report = report?;
    answer(report.to_table().trim_end());
    write(arguments.json.as_deref(), &report.to_json())?;
    write(arguments.csv.as_deref(), &report.to_csv())
}

/// The name of the folder or file, which is what tells sequences apart in a table.
fn sequence_name(input: &Path) -> String {
    if input == Path::new(DEMO_INPUT) {
        return "demo".to_owned();
    }
    let absolute = std::path::absolute(input).unwrap_or_else(|_| input.to_owned());
    let name = if absolute.is_dir() {
        absolute.file_name()
    } else {
        absolute.file_stem()
    };
    name.unwrap_or(input.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn write(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    let Some(path) = path else { return Ok(()) };
    std::fs::write(path, text).with_context(|| format!("{} cannot be written", path.display()))?;
    say(&format!("wrote {}", path.display()));
    Ok(())
}

/// One line that is written over; nothing where nobody looks.
fn show_progress(progress: Progress) {
    let mut stderr = std::io::stderr().lock();
    if stderr.is_terminal() {
        let Progress { done, total, label } = progress;
        // A terminal that has gone is no failure.
        let _ = write!(stderr, "\r\x1b[K[{done}/{total}] {label}");
        let _ = stderr.flush();
    }
}

fn clear_progress() {
    let mut stderr = std::io::stderr().lock();
    if stderr.is_terminal() {
        let _ = write!(stderr, "\r\x1b[K");
    }
}

fn count(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|&count| count > 0)
        .ok_or_else(|| "expected a whole number from 1 up".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sequences_are_named_after_their_folder_or_file() {
        let folder = tempfile::tempdir().unwrap();
        let scans = folder.path().join("walk.v2");
        std::fs::create_dir(&scans).unwrap();
        assert_eq!(sequence_name(&scans), "walk.v2");
        assert_eq!(sequence_name(Path::new("a/scan_0001.ply")), "scan_0001");
        assert_eq!(sequence_name(Path::new("demo:")), "demo");
    }
}
