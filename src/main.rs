//! The `pointreel` program; see [`pointreel::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    pointreel::cli::main()
}
