//! Why frames cannot be converted.

use super::edit::EditError;
use crate::sequence::FrameError;
use std::path::PathBuf;

/// Why a frame, or all, cannot be converted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConvertError {
    /// The frame cannot be read.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// What was asked for cannot be done with this frame.
    #[error("{}: {reason}", path.display())]
    Edit {
        /// The frame's file.
        path: PathBuf,
        /// What stands in the way.
        reason: EditError,
    },
    /// The output cannot be written.
    #[error("{} cannot be written ({reason}): check the folder, its permissions and the space left", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// A sequence file cannot be written or read.
    #[error(transparent)]
    Reel(#[from] crate::reel::ReelError),
    /// The folder holds frames that were converted otherwise.
    #[error(
        "{} holds frames of another conversion ({difference}): choose another folder, or --overwrite to convert them \
         anew",
        path.display()
    )]
    OtherConversion {
        /// The folder.
        path: PathBuf,
        /// What is different.
        difference: String,
    },
}
