//! The `pointreel` program; see [`pointreel::cli`].

use pointreel::memory::MiMalloc;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    pointreel::cli::main()
}
