//! Stub for `pointreel bench`, in a build without benchmarks.

use crate::cli::options::usage::UsageError;
use clap::Args;
use std::ffi::OsString;

/// Arguments that a benchmark would take.
#[derive(Debug, Args)]
#[command(after_help = ABSENT)]
pub(in crate::cli) struct BenchArgs {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

const ABSENT: &str = "this build has no benchmarks: build with `--features bench`";

/// Refuses.
pub(in crate::cli) fn run(_args: &BenchArgs) -> anyhow::Result<()> {
    Err(UsageError(ABSENT.to_owned()).into())
}
