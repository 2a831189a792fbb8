//! The command line: one file a verb. Exit code 0, 2 for wrong usage, 1 for any failure with one sentence on stderr.

mod arguments;
mod info;
mod render;
mod view;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// A viewer for time-varying point clouds: surfels, voxels, level of detail.
#[derive(Debug, Parser)]
#[command(name = "pointreel", version)]
struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Plays a sequence in a window (the default)
    View(Box<view::ViewArgs>),
    /// Renders frames to PNG files, without a window
    Render(Box<render::RenderArgs>),
    /// Says what is in a sequence
    Info(info::InfoArgs),
}

impl Default for Verb {
    fn default() -> Self {
        Self::View(Box::default())
    }
}

/// Parses the command line, runs the verb and says what went wrong.
pub fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn,wgpu_hal=error,wgpu_core=error,rfd=off"))
        .format_target(false)
        .init();
    // A wrong usage exits with 2 here.
    let arguments = Arguments::parse();
    let result = match arguments.verb.unwrap_or_default() {
        Verb::View(view) => view::run(&view),
        Verb::Render(render) => render::run(&render),
        Verb::Info(info) => info::run(&info),
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
#[expect(clippy::print_stderr, reason = "the command line speaks to a person here")]
fn say(line: &str) {
    eprintln!("{line}");
}

/// The answer of a verb on stdout. A reader that has left is no failure.
fn answer(text: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}
