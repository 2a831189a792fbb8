//! Every allocation, and every opening, reading and writing of a file, fails once: nothing panics, nothing is lost, and
//! errors are reported. After the tests of `SQLite`, <https://sqlite.org/testing.html>.
//!
//! **How it works.** This program is the test and the program under test. As the latter, which it is where the
//! environment names a fault, it runs the command line of its arguments with the calls of `shim.rs`. As the former it
//! counts the calls of a command, and runs it again for each of them. By default some of each kind; with
//! `POINTREEL_FAULTS=all` (`make faults`) all of them.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "it has no harness that prints for it")]

#[cfg(target_os = "linux")]
mod commands;
#[cfg(target_os = "linux")]
mod run;
#[cfg(target_os = "linux")]
mod shim;

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    if shim::arm() {
        let code = pointreel::cli::main();
        shim::report();
        return code;
    }
    run::all()
}

/// The calls are Linux calls.
#[cfg(not(target_os = "linux"))]
fn main() {}
