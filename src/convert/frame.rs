//! A frame in its own file.

use super::conversion::{Conversion, Converted};
use super::error::ConvertError;
use crate::io::Losses;
use crate::persist::Partial;
use crate::sequence::Sequence;
use std::path::Path;

/// A frame that was written.
pub(super) struct WrittenFrame {
    /// Warnings about the parts of the frame that could not be read.
    warnings: Vec<String>,
    losses: Losses,
}

impl Converted {
    pub(super) fn take(&mut self, frame: usize, WrittenFrame { warnings, losses }: WrittenFrame) {
        self.written += 1;
        self.warnings
            .extend(warnings.into_iter().map(|warning| (frame, warning)));
        self.losses.merge(losses);
    }
}

/// Writes frame `index` to `path`; `before_named` is called with its byte size once it is on disk and before it has its
/// final name.
pub(super) fn write_frame(
    sequence: &Sequence,
    conversion: &Conversion,
    index: usize,
    path: &Path,
    before_named: impl FnOnce(u64) -> std::io::Result<()>,
) -> Result<WrittenFrame, ConvertError> {
    let cloud = conversion.edited(sequence, index)?;
    let losses = conversion.format.losses(&cloud);
    let write = || {
        let (partial, mut file) = Partial::create(path)?;
        crate::io::write(&mut file, conversion.format, &cloud)?;
        // Flushed to disk before it gets its name: files in the folder are complete, even after a crash of the machine.
        file.sync_data()?;
        // The line in the ledger precedes the name: a file in the folder without a line is not part of this conversion.
        before_named(file.metadata()?.len())?;
        partial.finish()
    };
    write().map_err(|reason| ConvertError::Write {
        path: path.to_owned(),
        reason,
    })?;
    Ok(WrittenFrame {
        warnings: cloud.warnings,
        losses,
    })
}
