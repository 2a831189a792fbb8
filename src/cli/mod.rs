//! The command line: one file per command. Exit code 0, 2 for wrong usage, 1 for any failure with one sentence on
//! stderr (also where the answer cannot be written to stdout), 3 where `check` found something. A command ended by a
//! signal dies by it.

mod commands;
mod help;
mod info_parts;
mod line;
mod options;
mod session;
mod terminal;
mod topics;
mod wrap;

use crate::{signals, temporary};
use clap::{Command, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;
use terminal::output::{answer, check_answers, say};
use terminal::warnings::When;

/// Viewer and renderer for time-varying point clouds (4D scans).
#[derive(Debug, Parser)]
#[command(name = "pointreel", version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    subcommand: Option<Subcommands>,

    /// Print every warning and finding, not only the first of each kind
    #[arg(long, global = true)]
    verbose: bool,

    /// Arguments of `pointreel view`, used without a subcommand.
    #[command(flatten)]
    view: commands::view::ViewArgs,
}

#[derive(Debug, Subcommand)]
enum Subcommands {
    /// Play a sequence in a window (the default command); without INPUT, show the start screen
    View(Box<commands::view::ViewArgs>),
    /// Render frames to images, or to a video, without a window
    Render(Box<options::render_arguments::RenderArgs>),
    /// Benchmark speed and accuracy of rendering, level of detail and compression
    Bench(Box<commands::bench::BenchArgs>),
    /// Print the contents of a sequence: frames, points, attributes, time stamps
    Info(commands::info::InfoArgs),
    /// Check a sequence for problems (exits with 3 if there are errors or warnings)
    Check(commands::check::CheckArgs),
    /// Convert frames; optionally transform, downsample, add normals
    Convert(Box<commands::convert::ConvertArgs>),
    /// Serve a .reel over HTTP, or any input as a live stream (--live); print the URL to open
    Serve(Box<commands::serve::ServeArgs>),
    /// Compare two images: PSNR, SSIM, FLIP, number of different pixels
    Compare(commands::compare::CompareArgs),
    /// Compare two frames by cloud-to-cloud (C2C) distance: mean, quantiles, maximum
    CompareFrames(commands::compare_frames::CompareFramesArgs),
}

/// Exit code of wrong usage, the same as of parser errors.
const WRONG_USAGE: u8 = 2;

/// Runs the subcommand of this process's command line and reports errors. To be called once, as the last action of a
/// process.
pub fn main() -> ExitCode {
    // Dropped last.
    let _removes_all = RemovesAll;
    signals::watch();
    crate::memory::keep_freed_pages();
    crate::memory::before_the_end(temporary::remove_all_without_memory);
    options::device_select::skip_without_session();
    start_log();
    run(std::env::args_os())
}

/// Removes the unfinished files of running threads, after a panic too.
struct RemovesAll;

impl Drop for RemovesAll {
    fn drop(&mut self) {
        temporary::remove_all();
    }
}

/// Runs the subcommand of a command line, whose first word is the name of the program, and reports errors. A process
/// may call it many times: tests of thousands of files start no program for each.
pub fn run(line: impl IntoIterator<Item = OsString>) -> ExitCode {
    let command = command();
    let words = line::spelt(line.into_iter().collect(), &command);
    if let Some(page) = topics::page(&words, &command) {
        answer(page.trim_end());
        return ended_with(check_answers().map(done));
    }
    if let Some(question) = topics::unknown(&words, &command).or_else(|| line::unknown_command(&words, &command)) {
        return ended_with(Err(options::usage::UsageError(question).into()));
    }
    let parsed = command.try_get_matches_from(words);
    match parsed.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => run_subcommand(arguments),
        Err(usage) if usage.use_stderr() => {
            // If this fails there is no one left to report to.
            let _ = usage.print();
            ExitCode::from(WRONG_USAGE)
        }
        Err(help) => {
            terminal::output::note(help.print().and_then(|()| std::io::stdout().flush()));
            ended_with(check_answers().map(done))
        }
    }
}

/// The command line in clap's terms, with the texts of the help.
fn command() -> Command {
    help::laid_out(Arguments::command())
}

fn run_subcommand(arguments: Arguments) -> ExitCode {
    let has_window = matches!(arguments.subcommand, None | Some(Subcommands::View(_)));
    let runs_on = has_window || matches!(arguments.subcommand, Some(Subcommands::Serve(_)));
    terminal::warnings::say_them(match (arguments.verbose, runs_on) {
        (true, _) => When::AllAtOnce,
        (false, true) => When::FirstAtOnce,
        (false, false) => When::AtTheEnd,
    });
    terminal::waits::say_them();
    if has_window || matches!(arguments.subcommand, Some(Subcommands::Bench(_))) {
        crate::priority::work_with_this_thread();
    }
    let result = match arguments.subcommand {
        None => commands::view::run(&arguments.view).map(done),
        Some(Subcommands::View(view)) => commands::view::run(&view).map(done),
        Some(Subcommands::Render(render)) => commands::render::run(&render).map(done),
        Some(Subcommands::Bench(bench)) => commands::bench::run(&bench).map(done),
        Some(Subcommands::Info(info)) => commands::info::run(&info).map(done),
        Some(Subcommands::Check(check)) => commands::check::run(&check, arguments.verbose),
        Some(Subcommands::Convert(convert)) => commands::convert::run(&convert).map(done),
        Some(Subcommands::Serve(serve)) => commands::serve::run(&serve).map(done),
        Some(Subcommands::Compare(compare)) => commands::compare::run(&compare).map(done),
        Some(Subcommands::CompareFrames(compare)) => commands::compare_frames::run(&compare).map(done),
    };
    terminal::warnings::finish();
    // A server that was ended by a signal has done its job; a window, or a command that failed because of a signal,
    // ends by it.
    let is_ended = has_window || result.is_err();
    let result = result.and_then(|code| check_answers().map(|()| code));
    let code = ended_with(result);
    if is_ended {
        signals::end_if_received();
    }
    code
}

/// Reports an error.
fn ended_with(result: anyhow::Result<ExitCode>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) => {
            say(&format!("error: {error:#}"));
            if error.is::<options::usage::UsageError>() {
                ExitCode::from(WRONG_USAGE)
            } else {
                ExitCode::FAILURE
            }
        }
    }
}

/// Starts the log: messages are printed like the warnings of a subcommand, unless the user has requested the log.
fn start_log() {
    const LEVELS: &str = "RUST_LOG";
    // The user can do nothing about the warnings of these libraries.
    let usual = "warn,wgpu_hal=error,wgpu_core=error,winit=error,sctk_adwaita=off,arboard=error,\
        egui_winit=error,rfd=off";
    let mut log = env_logger::Builder::from_env(env_logger::Env::new().filter_or(LEVELS, usual));
    log.format_target(false);
    if std::env::var_os(LEVELS).is_none() {
        log.format(|out, record| match record.level() {
            log::Level::Warn => {
                terminal::warnings::warn(&record.args().to_string());
                Ok(())
            }
            log::Level::Error => {
                terminal::warnings::warn_of_error(&record.args().to_string());
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
