//! The command line: one file a verb. Exit code 0, 2 for wrong usage, 1 for any failure with one sentence
//! on stderr, 3 where `check` found something.

mod arguments;
mod assumptions;
mod bench;
mod camera_arguments;
mod camera_info;
mod check;
mod colors;
mod compare;
mod compare_frames;
mod convert;
mod device_select;
mod info;
mod output;
mod photo_info;
mod poses;
mod progress;
mod reel_arguments;
mod reel_info;
mod render;
mod render_arguments;
mod rgbd_arguments;
mod serve;
mod session;
mod sources;
mod stream;
mod style_arguments;
mod usage;
mod values;
mod video;
mod video_arguments;
mod view;
mod warnings;

use clap::{Parser, Subcommand};
use output::say;
use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;
use warnings::When;

/// A viewer for time-varying point clouds: surfels, voxels, level of detail.
#[derive(Debug, Parser)]
#[command(name = "pointreel", version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,

    /// Say each warning and finding, not only the first one of each kind
    #[arg(long, global = true)]
    verbose: bool,

    /// Without a verb: what `pointreel view` takes.
    #[command(flatten)]
    view: view::ViewArgs,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Plays a sequence in a window (the default); without INPUT offers what was opened lately, at first the demo
    View(Box<view::ViewArgs>),
    /// Renders frames to pictures, or a video of them, without a window
    Render(Box<render_arguments::RenderArgs>),
    /// Measures drawing and octrees by the protocol of the paper, and errors beside times
    Bench(Box<bench::BenchArgs>),
    /// Says what is in a sequence
    Info(info::InfoArgs),
    /// Checks a sequence for problems: exit code 3 for errors and warnings, 0 for notes
    Check(check::CheckArgs),
    /// Writes frames in another format, moved, thinned out, with normals
    Convert(Box<convert::ConvertArgs>),
    /// Serves a sequence file by HTTP, or, with --live, any input as a live stream: what it says is an INPUT of all
    /// verbs, on this machine or, with --listen, others
    Serve(Box<serve::ServeArgs>),
    /// Says how far a picture is from another one: PSNR, FLIP, SSIM, pixels that differ
    Compare(compare::CompareArgs),
    /// Says how far the points of one frame are from another frame: mean, quantiles, maximum, share above a threshold
    CompareFrames(compare_frames::CompareFramesArgs),
}

/// Exit code of wrong usage, as of what the parser of the command line refuses.
const WRONG_USAGE: u8 = 2;

/// Runs the verb of this process's command line and says what went wrong.
pub fn main() -> ExitCode {
    crate::memory::keep_freed_pages();
    device_select::leave_out_without_session();
    start_log();
    run(std::env::args_os())
}

/// Runs the verb of a command line, whose first word is the name of the program, and says what went wrong. A process may
/// do so many times: tests that try thousands of files start no program for each.
pub fn run(line: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(line) {
        Ok(arguments) => arguments,
        Err(usage) => {
            // Nobody is left to be told where this fails. `--help` comes here too.
            let _ = usage.print();
            return ExitCode::from(if usage.use_stderr() { WRONG_USAGE } else { 0 });
        }
    };
    let has_window = matches!(arguments.verb, None | Some(Verb::View(_)));
    warnings::say_them(match (arguments.verbose, has_window) {
        (true, _) => When::AllAtOnce,
        (false, true) => When::FirstAtOnce,
        (false, false) => When::AtTheEnd,
    });
    if has_window || matches!(arguments.verb, Some(Verb::Bench(_))) {
        crate::priority::work_with_this_thread();
    }
    let result = match arguments.verb {
        None => view::run(&arguments.view).map(done),
        Some(Verb::View(view)) => view::run(&view).map(done),
        Some(Verb::Render(render)) => render::run(&render).map(done),
        Some(Verb::Bench(bench)) => bench::run(&bench).map(done),
        Some(Verb::Info(info)) => info::run(&info).map(done),
        Some(Verb::Check(check)) => check::run(&check, arguments.verbose),
        Some(Verb::Convert(convert)) => convert::run(&convert).map(done),
        Some(Verb::Serve(serve)) => serve::run(&serve).map(done),
        Some(Verb::Compare(compare)) => compare::run(&compare).map(done),
        Some(Verb::CompareFrames(compare)) => compare_frames::run(&compare).map(done),
    };
    warnings::finish();
    match result {
        Ok(code) => code,
        Err(error) => {
            say(&format!("error: {error:#}"));
            if error.is::<usage::UsageError>() {
                ExitCode::from(WRONG_USAGE)
            } else {
                ExitCode::FAILURE
            }
        }
    }
}

/// What is logged is said like the warnings of a verb, unless somebody has asked for the log.
fn start_log() {
    const LEVELS: &str = "RUST_LOG";
    // What these libraries warn of is nothing that a person could mend.
    let usual = "warn,wgpu_hal=error,wgpu_core=error,winit=error,sctk_adwaita=off,arboard=error,\
        egui_winit=error,rfd=off";
    let mut log = env_logger::Builder::from_env(env_logger::Env::new().filter_or(LEVELS, usual));
    log.format_target(false);
    if std::env::var_os(LEVELS).is_none() {
        log.format(|out, record| match record.level() {
            log::Level::Warn => {
                warnings::warn(&record.args().to_string());
                Ok(())
            }
            log::Level::Error => {
                warnings::warn_of_error(&record.args().to_string());
                Ok(())
            }
            _ => writeln!(out, "{}", crate::printable::text(&record.args().to_string())),
        });
    }
    log.init();
}

fn done((): ()) -> ExitCode {
    ExitCode::SUCCESS
}
