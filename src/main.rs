//! The `pointreel` program; see [`pointreel::cli`].

use pointreel::memory::Allocator;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator::new();

fn main() -> ExitCode {
    pointreel::cli::main()
}
