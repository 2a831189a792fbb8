//! Sequence files in memory: the size of encoded frames, and their decoded result, without a file.

use super::encode::NewFrame;
use super::error::ReelError;
use super::options::ReelOptions;
use super::reader::ReelFile;
use super::writer::ReelWriter;
use std::path::Path;
use std::sync::Arc;

/// Its name in messages.
const NAME: &str = "memory";

/// The bytes of a sequence file of `frames`, in groups of the length in `options`.
///
/// # Errors
/// As of [`super::encode_group`].
pub fn write_to_memory(frames: &[NewFrame<'_>], options: &ReelOptions) -> Result<Vec<u8>, ReelError> {
    let mut writer = ReelWriter::new(Vec::new(), Path::new(NAME), options.clone())?;
    for group in frames.chunks(options.keyframes.max(1) as usize) {
        writer.write_group(group)?;
    }
    writer.finish()
}

impl ReelFile {
    /// Opens a sequence file in memory.
    ///
    /// # Errors
    /// As [`ReelFile::open`].
    pub fn of_bytes(bytes: Vec<u8>) -> Result<Self, ReelError> {
        Self::open(Arc::new(bytes), Path::new(NAME))
    }
}
