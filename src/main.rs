//! The `pointreel` program; see [`pointreel::cli`].

use mimalloc::MiMalloc;
use std::process::ExitCode;

/// Frames are megabytes that come and go many times a second. The system's allocator gives such pieces back at once and
/// pays for every page again; this one keeps them for the next frame.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    pointreel::cli::main()
}
