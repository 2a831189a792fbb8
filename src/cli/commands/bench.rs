//! `pointreel bench`: the suites of the benchmark menu, without a window.

use super::bench_window::{PresentChoice, measure_window};
use crate::bench::{self, BenchOptions, Input, LeaveOut, Modes, OptionGroup, Report, Step, Suite, suites};
use crate::cli::options::arguments::{FrameRange, ReadArgs, byte_count, frame_rate, open_sequence_and_tell, size_px};
use crate::cli::options::sources::{check_sources, write_text};
use crate::cli::terminal::output::{answer, say};
use crate::messages::listed;
use crate::printable;
use crate::progress::Progress;
use crate::render::gpu::{Context, ContextOptions};
use crate::scene::{Choice, RendererChoice};
use crate::sequence::OpenOptions;
use crate::source::{DEMO_INPUT, Shape};
use anyhow::bail;
use clap::Args;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of `pointreel bench`.
#[derive(Debug, Args)]
pub(in crate::cli) struct BenchArgs {
    #[arg(value_name = "SUITE", value_parser = suites::named, help = help_of_suites())]
    suite: &'static Suite,

    /// Folders, patterns or files, each a sequence of its own; `demo:` is built in, and `sphere:`, `torus:`, `cube:` and
    /// `saddle:` are sampled shapes whose ground truth `error` knows (`sphere:20000` has 20,000 points instead of
    /// 100,000)
    #[arg(default_value = DEMO_INPUT, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Write the report to this JSON file; without a name, print it instead of the table
    #[arg(long, value_name = "FILE.json", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,

    /// Write the rows to this CSV file
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,

    #[arg(long, value_name = "FILE.html", help = format!(
        "Write time and error, with images, to this self-contained page ({} only)",
        names(OptionGroup::Modes)
    ))]
    html: Option<PathBuf>,

    #[arg(long, value_name = "MODES", help = format!(
        "Render modes that {} compares, comma-separated: cpu, gpu, surfel, voxel, point, two-pass, vertex …",
        names(OptionGroup::Modes)
    ))]
    modes: Option<Modes>,

    #[arg(long, value_name = "N,…", value_parser = count, value_delimiter = ',', help = format!(
        "Points of the clouds that {} generates in addition to the inputs [default: {}]",
        names(OptionGroup::Clouds),
        cloud_points()
    ))]
    points: Option<Vec<usize>>,

    #[arg(long, value_name = "N", value_parser = count, help = format!(
        "Frames of each sequence, spread evenly; for {}, frames shown [default: {}]",
        names(OptionGroup::Playing),
        defaults(|suite| suite.defaults.frames.to_string())
    ))]
    frames: Option<usize>,

    #[arg(long, alias = "frame", value_name = "N", help = format!(
        "First frame of {}, counted from 0 [default: 0]",
        names(OptionGroup::FirstFrame)
    ))]
    first_frame: Option<usize>,

    #[arg(long, value_name = "N,…|every:K", help = format!(
        "Input images that {} holds out for comparison, counted from 0 [default: every:8]",
        names(OptionGroup::Photographs)
    ))]
    leave_out: Option<LeaveOut>,

    #[arg(long, value_name = "FPS", value_parser = frame_rate, help = format!(
        "Frames per second of {}, instead of those of the sequence",
        names(OptionGroup::Playing)
    ))]
    fps: Option<f64>,

    #[arg(long, value_name = "SIZE", value_parser = byte_count, help = format!(
        "Memory for prepared frames in {}: bytes, or a number with MB, MiB, GB or GiB",
        names(OptionGroup::Playing)
    ))]
    budget: Option<u64>,

    #[arg(long, value_name = "WxH", value_parser = size_px, help = format!(
        "Image size in pixels; for {}, of the window itself [default: {}]",
        names(OptionGroup::Window),
        defaults(|suite| suite.defaults.viewport_px.map(|side_px| side_px.to_string()).join("x"))
    ))]
    size: Option<[u32; 2]>,

    #[arg(long, value_name = "auto|gpu|cpu", help = format!(
        "Paint the window that {} measures on the GPU or the CPU",
        names(OptionGroup::Window)
    ))]
    present: Option<PresentChoice>,

    /// Render the images in it on the GPU or the CPU
    #[arg(long, value_name = "auto|gpu|cpu")]
    renderer: Option<Choice<RendererChoice>>,

    #[arg(long, value_name = "N", value_parser = count, help = format!(
        "Viewpoints per frame [default: {}]",
        defaults(|suite| suite.defaults.viewpoints.to_string())
    ))]
    viewpoints: Option<usize>,

    /// Timed rounds over all viewpoints
    #[arg(long, value_name = "N", default_value = "3", value_parser = count)]
    repeat: usize,

    #[command(flatten)]
    read: ReadArgs,
}

/// The list of suites, each with what it is.
fn help_of_suites() -> String {
    let suites = suites::all().map(|suite| format!("{suite} ({})", suite.brief));
    listed(&suites.collect::<Vec<_>>(), "or")
}

/// The suites that have a use for these options.
fn names(group: OptionGroup) -> String {
    let suites = suites::all().filter(|suite| suite.takes(group));
    let quoted = suites.map(|suite| format!("`{suite}`"));
    listed(&quoted.collect::<Vec<_>>(), "and")
}

/// The usual points of clouds, as they are given.
fn cloud_points() -> String {
    let points = BenchOptions::new(suites::PRIMITIVES).cloud_points;
    points.iter().map(usize::to_string).collect::<Vec<_>>().join(",")
}

/// Each value that suites have, with those that have it; the first says nothing of who has it.
fn defaults(value_of: impl Fn(&Suite) -> String) -> String {
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for suite in suites::all() {
        let value = value_of(suite);
        match groups.iter_mut().find(|(other, _)| *other == value) {
            Some((_, names)) => names.push(suite.to_string()),
            None => groups.push((value, vec![suite.to_string()])),
        }
    }
    let group = |(place, (value, names)): (usize, &(String, Vec<String>))| match place {
        0 => value.clone(),
        _ => format!("{value} for {}", listed(names, "and")),
    };
    let groups = groups.iter().enumerate().map(group);
    groups.collect::<Vec<_>>().join("; ")
}

/// Fails where an option was given for which the suite has no use.
fn refuse_foreign_options(arguments: &BenchArgs) -> anyhow::Result<()> {
    let suite = arguments.suite;
    for (group, options, is_given) in [
        (
            OptionGroup::Modes,
            "--modes and --html",
            arguments.modes.is_some() || arguments.html.is_some(),
        ),
        (
            OptionGroup::Playing,
            "--fps and --budget",
            arguments.fps.is_some() || arguments.budget.is_some(),
        ),
        (OptionGroup::Clouds, "--points", arguments.points.is_some()),
        (
            OptionGroup::FirstFrame,
            "--first-frame",
            arguments.first_frame.is_some(),
        ),
        (OptionGroup::Photographs, "--leave-out", arguments.leave_out.is_some()),
        (
            OptionGroup::Window,
            "--present and --renderer",
            arguments.present.is_some() || arguments.renderer.is_some(),
        ),
    ] {
        if is_given && !suite.takes(group) {
            let takers = suites::all().filter(|suite| suite.takes(group));
            let takers: Vec<String> = takers.map(|suite| format!("`bench {suite}`")).collect();
            let takers = listed(&takers, "and");
            bail!("{options} belong to {takers}, not to `bench {suite}`");
        }
    }
    Ok(())
}

pub(in crate::cli) fn run(arguments: &BenchArgs) -> anyhow::Result<()> {
    refuse_foreign_options(arguments)?;
    let open = OpenOptions {
        fps: arguments.fps,
        ..if arguments.suite.takes(OptionGroup::Photographs) {
            arguments.read.picture_options()
        } else {
            arguments.read.open_options()
        }
    };
    let leave_out = arguments.leave_out.clone().unwrap_or_default();
    let inputs = arguments.inputs.iter().map(|input| {
        let opened = open_input(input, &open)?;
        if arguments.suite.takes(OptionGroup::Photographs) {
            return with_photographs(opened, input, &open, &leave_out);
        }
        Ok(opened)
    });
    let inputs = inputs.collect::<anyhow::Result<Vec<Input>>>()?;
    let written = [&arguments.json, &arguments.html, &arguments.csv].into_iter().flatten();
    let written: Vec<PathBuf> = written.cloned().collect();
    for Input { sequence, .. } in &inputs {
        check_sources(sequence, written.iter().cloned())?;
    }
    if let Some(first) = arguments.first_frame {
        for Input { sequence, .. } in &inputs {
            FrameRange::one(first).check("--first-frame", sequence.len())?;
        }
    }
    let default = BenchOptions::new(arguments.suite);
    let options = BenchOptions {
        viewport_px: arguments.size.unwrap_or(default.viewport_px),
        viewpoints: arguments.viewpoints.unwrap_or(default.viewpoints),
        frames: arguments.frames.unwrap_or(default.frames),
        first_frame: arguments.first_frame.unwrap_or(default.first_frame),
        repeat: arguments.repeat,
        budget_bytes: arguments.budget.map(|bytes| bytes as usize),
        truth_folder: BenchOptions::truth_folder_of_person(),
        cloud_points: arguments.points.clone().unwrap_or(default.cloud_points),
        modes: arguments.modes.clone().unwrap_or_default(),
        leave_out,
        ..default
    };
    let report = if arguments.suite.takes(OptionGroup::Window) {
        measure_window(&inputs, options, arguments.present, arguments.renderer)?
    } else {
        measure(&inputs, &options)?
    };
    if arguments.json.as_deref() == Some(Path::new("-")) {
        answer(&report.to_json());
    } else {
        answer(report.to_table().trim_end());
        write(arguments.json.as_deref(), &report.to_json())?;
    }
    write(arguments.html.as_deref(), &report.to_html())?;
    write(arguments.csv.as_deref(), &report.to_csv())
}

/// Runs a suite that needs no window.
fn measure(inputs: &[Input], options: &BenchOptions) -> anyhow::Result<Report> {
    let context = match Context::headless(&ContextOptions::default()) {
        Ok(context) => Some(context),
        Err(error) => {
            say(&format!("the software renderer is measured alone: {error}"));
            None
        }
    };
    let report = bench::run(inputs, options, context.as_ref(), &show_progress, &Progress::default());
    clear_progress();
    Ok(report?)
}

/// Opens an input; of a shape the truth is known.
fn open_input(input: &Path, open: &OpenOptions) -> anyhow::Result<Input> {
    let shape = Shape::of_input(input);
    Ok(Input {
        name: shape.map_or_else(|| sequence_name(input), |shape| shape.name().to_owned()),
        sequence: Arc::new(open_sequence_and_tell(&[input.to_owned()], open)?),
        shape,
    })
}

/// Depth images with poses become one cloud, whose photographs are their colours; points of those that are left out are
/// not in it.
fn with_photographs(opened: Input, path: &Path, open: &OpenOptions, leave_out: &LeaveOut) -> anyhow::Result<Input> {
    let source = opened.sequence.source();
    let count = opened.sequence.len();
    let is_posed = source
        .sensor(0)
        .is_some_and(|sensor| sensor.world_from_camera.is_some());
    if source.photographs(0).is_some() || !is_posed {
        return Ok(opened);
    }
    let mut open = open.clone();
    open.rgbd.merge = Some((0, count - 1));
    open.rgbd.left_out = leave_out.of(count);
    open_input(path, &open)
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
    name.unwrap_or(input.as_os_str()).to_string_lossy().into_owned()
}

fn write(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    let Some(path) = path else { return Ok(()) };
    write_text(path, text)?;
    say(&format!("wrote {}", path.display()));
    Ok(())
}

/// One line that is written over; nothing where nobody looks.
fn show_progress(step: Step) {
    let mut stderr = std::io::stderr().lock();
    if stderr.is_terminal() {
        let Step { done, total, label, .. } = step;
        // A terminal that has gone is no failure.
        let _ = write!(stderr, "\r\x1b[K[{done}/{total}] {}", printable::text(&label));
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
