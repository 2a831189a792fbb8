//! Stub for `pointreel view`, in a build without a window.

use crate::cli::options::usage::UsageError;
use clap::Args;
use std::ffi::OsString;

/// Arguments that a window would take.
#[derive(Debug, Clone, Default, Args)]
#[command(after_help = ABSENT)]
pub(in crate::cli) struct ViewArgs {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

const ABSENT: &str = "this build has no window: build with `--features window`, or see `pointreel render`";

/// Refuses.
pub(in crate::cli) fn run(_args: &ViewArgs) -> anyhow::Result<()> {
    Err(UsageError(ABSENT.to_owned()).into())
}
