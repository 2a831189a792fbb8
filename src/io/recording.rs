//! Recordings of robots: messages with point clouds and their times.

use super::{Entry, Format, IoError, ReadOptions};
use crate::cloud::RawCloud;
use std::path::Path;

/// A message with a point cloud.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {}

/// The point clouds of the recording at `path`, in the order of their time.
pub(super) fn list(path: &Path, format: Format) -> Result<Vec<Entry>, IoError> {
    let _ = (path, format);
    Ok(vec![Entry::whole()])
}

/// The point cloud of a message.
pub(super) fn read(
    path: &Path,
    message: &Message,
    options: &ReadOptions,
) -> Result<RawCloud, IoError> {
    let _ = (message, options);
    super::read(path)
}
