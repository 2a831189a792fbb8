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
    /// The requested edit cannot be applied to this frame.
    #[error("{}: {reason}", path.display())]
    Edit {
        /// The frame's file.
        path: PathBuf,
        /// Reason why the edit is not possible.
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
    /// The output would overwrite the input, or lie next to it.
    #[error(
        "the output {} is where the input {} is: nothing was written, choose another folder or name",
        path.display(),
        input.display()
    )]
    OutputIsInput {
        /// The output.
        path: PathBuf,
        /// The input at that location.
        input: PathBuf,
    },
    /// Foreign files have the names of frames.
    #[error(
        "{} is there already{}, and no record says that this conversion has written it: nothing was written, choose \
         another output, or --overwrite to replace {}",
        path.display(),
        if *more > 0 { format!(", as are {more} more files") } else { String::new() },
        if *more > 0 { "them" } else { "it" }
    )]
    Exists {
        /// The first file.
        path: PathBuf,
        /// Number of further ones.
        more: usize,
    },
    /// No precision makes the file as small as requested.
    #[error(
        "the requested size of {wanted} cannot be reached: the smallest sequence file of these frames has about \
         {smallest}; request more, or fewer frames or points (--frames, --sample, --voxel, --merge)"
    )]
    TooSmall {
        /// The requested size.
        wanted: String,
        /// The size with the coarsest precision.
        smallest: String,
    },
    /// There are no such frames.
    #[error("{0}")]
    NoSuchFrames(String),
    /// The sequence file has other frames, or was made otherwise.
    #[error(
        "{} is there already and is not the same conversion ({difference}): choose another name, or --overwrite to \
         convert it again",
        path.display()
    )]
    OtherPart {
        /// The file.
        path: PathBuf,
        /// Description of the difference.
        difference: String,
    },
    /// Another process writes the same file.
    #[error(
        "{} is being written by {holder}: wait for it, or choose another name (if it has ended, remove {})",
        path.display(),
        lock.display()
    )]
    Busy {
        /// The file.
        path: PathBuf,
        /// The process, and its machine.
        holder: String,
        /// The lock file.
        lock: PathBuf,
    },
    /// Files that cannot be joined.
    #[error("{} cannot be joined: {problem}", output.display())]
    Join {
        /// Output file that they were to be joined into.
        output: PathBuf,
        /// Description of the parts that are missing or do not belong together.
        problem: String,
    },
    /// The folder holds frames that were converted otherwise.
    #[error(
        "{} holds frames of another conversion ({difference}): nothing was written, choose another folder, or \
         --overwrite \
         to replace them",
        path.display()
    )]
    OtherConversion {
        /// The folder.
        path: PathBuf,
        /// Description of the difference.
        difference: String,
    },
}
