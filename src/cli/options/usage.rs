//! Wrong usage that only the input can tell.

/// Usage error: what was requested does not exist. The exit code is that of wrong usage, 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(in crate::cli) struct UsageError(pub(in crate::cli) String);
