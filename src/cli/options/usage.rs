//! Wrong usage that only the input can tell.

/// Usage error: the requested item does not exist. The exit code is 2, as of wrong usage.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(in crate::cli) struct UsageError(pub(in crate::cli) String);
