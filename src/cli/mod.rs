//! The command line: one file a verb. Exit code 0, 2 for wrong usage, 1 for any failure with one sentence on stderr.

mod arguments;
mod bench;
mod compare;
mod info;
mod render;
mod view;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// A viewer for time-varying point clouds: surfels, voxels, level of detail.
#[derive(Debug, Parser)]
#[command(name = "pointreel", version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,

    /// Without a verb: what `pointreel view` takes.
    #[command(flatten)]
    view: view::ViewArgs,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Plays a sequence in a window (the default); without INPUT the built-in demo
    View(Box<view::ViewArgs>),
    /// Renders frames to PNG files, without a window
    Render(Box<render::RenderArgs>),
    /// Measures drawing and octrees by the protocol of the paper, and errors beside times
    Bench(bench::BenchArgs),
    /// Says what is in a sequence
    Info(info::InfoArgs),
    /// Says how far a picture is from another one: PSNR, FLIP, SSIM, pixels that differ
    Compare(compare::CompareArgs),
}

/// Parses the command line, runs the verb and says what went wrong.
pub fn main() -> ExitCode {
    crate::memory::keep_freed_pages();
    env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("warn,wgpu_hal=error,wgpu_core=error,rfd=off"),
    )
    .format_target(false)
    .init();
    // A wrong usage exits with 2 here.
    let arguments = Arguments::parse();
    let result = match arguments.verb {
        None => view::run(&arguments.view),
        Some(Verb::View(view)) => view::run(&view),
        Some(Verb::Render(render)) => render::run(&render),
        Some(Verb::Bench(bench)) => bench::run(&bench),
        Some(Verb::Info(info)) => info::run(&info),
        Some(Verb::Compare(compare)) => compare::run(&compare),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

/// One line on stderr.
#[expect(
    clippy::print_stderr,
    reason = "the command line speaks to a person here"
)]
fn say(line: &str) {
    eprintln!("{line}");
}

/// The answer of a verb on stdout. A reader that has left is no failure.
fn answer(text: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}
