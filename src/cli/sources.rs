//! Pictures and videos are not written over the files that they are made of.

use crate::convert::source_files;
use crate::sequence::Sequence;
use anyhow::bail;
use std::path::PathBuf;

/// Refuses to write over a file that is read.
pub(super) fn check_sources(sequence: &Sequence, outputs: impl Iterator<Item = PathBuf>) -> anyhow::Result<()> {
    let sources = source_files(sequence);
    for output in outputs {
        if output.canonicalize().is_ok_and(|place| sources.contains(&place)) {
            bail!(
                "the output {} is a file of the input: nothing was written, choose another name",
                output.display()
            );
        }
    }
    Ok(())
}
