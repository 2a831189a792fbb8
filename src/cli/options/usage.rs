//! Wrong usage that only the input can tell.

/// What was asked for is not there. The exit code is that of wrong usage, 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(in crate::cli) struct UsageError(pub(in crate::cli) String);
