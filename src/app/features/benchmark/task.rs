//! Benchmarks are run: here, on a thread, or by another window of this program.

use super::{BenchmarkJob, BenchmarkSetup, BenchmarkTable};
use crate::bench::{self, Step};
use crate::progress::Progress;
use crate::render::gpu::{Context, ContextOptions};
use crate::scene::{Choice, RendererChoice};
use crate::sequence::Sequence;
use crate::source::DEMO_INPUT;
use crate::temporary::{Helper, Temporary};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

/// Polling interval for the measurement of the other window.
const LOOK_INTERVAL: Duration = Duration::from_millis(100);

/// The job that runs a suite on `sequence`: with its own GPU context, or in its own window.
pub(in crate::app) fn benchmark_job(
    setup: BenchmarkSetup,
    name: String,
    sequence: Arc<Sequence>,
    shown_frame: usize,
) -> BenchmarkJob {
    let suite = setup.suite;
    if suite.takes(bench::OptionGroup::Window) {
        return Box::new(move |report, progress| {
            report(Step {
                label: format!("{name}: another window plays, turns and scrubs it"),
                ..Step::default()
            });
            window_job(&setup, &sequence, progress)
        });
    }
    Box::new(move |report, progress| {
        let context = match setup.renderer {
            Choice::Is(RendererChoice::Cpu) => None,
            Choice::Is(RendererChoice::Gpu) => Some(
                Context::headless(&ContextOptions::default())
                    .map_err(|error| format!("the GPU cannot be measured: {error}; choose the CPU renderer"))?,
            ),
            // Without an adapter the CPU renderer is measured alone.
            Choice::Auto => Context::headless(&ContextOptions::default()).ok(),
        };
        let is_software = context.as_ref().is_none_or(|context| context.is_software());
        let options = bench::BenchOptions {
            modes: match setup.renderer {
                Choice::Is(renderer) => bench::Modes::of_renderer(renderer),
                // Modes of a software adapter are never a good choice.
                Choice::Auto if is_software => bench::Modes::of_renderer(RendererChoice::Cpu),
                Choice::Auto => bench::Modes::default(),
            },
            first_frame: if suite.takes(bench::OptionGroup::FirstFrame) {
                shown_frame
            } else {
                0
            },
            ..setup.options()
        };
        let input = bench::Input {
            name,
            sequence,
            shape: None,
        };
        let measured =
            bench::run(&[input], &options, context.as_ref(), report, progress).map_err(|error| error.to_string())?;
        Ok(BenchmarkTable::of(measured))
    })
}

/// Runs this program again to measure another window: one process has one event loop, and this window's would be
/// measured with the benchmark's panel in it.
fn window_job(setup: &BenchmarkSetup, sequence: &Sequence, progress: &Progress) -> Result<BenchmarkTable, String> {
    let say = |error: std::io::Error| format!("the other window cannot be opened: {error}");
    let folder = std::env::temp_dir().join(format!("pointreel-window-{}", std::process::id()));
    let folder = Temporary::folder_and_contents(&folder);
    std::fs::create_dir_all(folder.path()).map_err(say)?;
    let file = folder.path().join("report.json");
    let inputs = match sequence.source().inputs() {
        [] => vec![PathBuf::from(DEMO_INPUT)],
        inputs => inputs.to_vec(),
    };
    let fps = sequence.fps().to_string();
    let [width, height] = setup.viewport_px;
    let mut command = Command::new(std::env::current_exe().map_err(say)?);
    command
        .args(["bench", "window"])
        .args(inputs)
        .args(["--fps", &fps, "--renderer", setup.renderer.name()])
        .args([
            "--size",
            &format!("{width}x{height}"),
            "--frames",
            &setup.frames.to_string(),
        ])
        .arg("--json")
        .arg(&file)
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    let program = Helper::spawn(&mut command).map_err(say)?;
    let ended = loop {
        if progress.is_cancelled() {
            // A process that has just ended by itself need not be killed.
            let _ = program.child().kill();
        }
        // The lock is not held while waiting for it.
        let status = program.child().try_wait().map_err(say)?;
        match status {
            Some(status) => break status,
            None => std::thread::sleep(LOOK_INTERVAL),
        }
    };
    let json = std::fs::read_to_string(&file);
    drop(folder);
    if !ended.success() {
        return Err("the other window was closed before all was measured".to_owned());
    }
    let report = bench::window_report_of_json(&json.map_err(say)?)?;
    Ok(BenchmarkTable::of(report))
}
