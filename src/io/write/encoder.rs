//! One way to write clouds.

use super::loss::Loss;
use crate::cloud::RawCloud;
use std::io::{Seek, Write};

/// Where a file goes.
pub(in crate::io) trait WriteSeek: Write + Seek + Send + Sync {}

impl<T: Write + Seek + Send + Sync> WriteSeek for T {}

/// A format that is written, or one of the ways to write it.
pub(in crate::io) struct Encoder {
    /// The word for it on the command line.
    pub(in crate::io) name: &'static str,
    /// Without dot. Where several have one, it means the first.
    pub(in crate::io) extension: &'static str,
    /// Writes as much of a cloud as the format holds.
    pub(in crate::io) write: fn(&mut dyn WriteSeek, &RawCloud) -> std::io::Result<()>,
    /// What the format has no place for. Scalar fields are not among it: every format holds them.
    pub(in crate::io) lost: &'static [Loss],
}
