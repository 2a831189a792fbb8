//! Reasons why a sequence file cannot be written or read: the file, the position in it, and the fault.

use std::path::{Path, PathBuf};

/// Reasons why there is no file, or no frame.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReelError {
    /// The system could not read or write.
    #[error("{} cannot be read or written at byte {byte} ({source})", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Byte offset in the file.
        byte: u64,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Another kind of file.
    #[error("{} is not a sequence file: it begins with {found:02x?}", path.display())]
    Magic {
        /// The file.
        path: PathBuf,
        /// Its first bytes.
        found: Vec<u8>,
    },
    /// A file of a later version.
    #[error(
        "{} was written by a later version of pointreel (its format is version {found}, known is {known}): update \
         pointreel to open it",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u16,
        /// The latest version that is known.
        known: u16,
    },
    /// A file of an earlier version.
    #[error(
        "{} was written by an earlier version of pointreel (its format is version {found}, known is {known}): convert \
         what it was made of once more",
        path.display()
    )]
    Earlier {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u16,
        /// The only version that is known.
        known: u16,
    },
    /// Bytes that are not those that were written.
    #[error("{}, byte {byte}: {problem}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Byte offset in the file where the damaged part begins.
        byte: u64,
        /// Description of the data found and expected.
        problem: String,
    },
    /// More memory than is allowed.
    #[error(
        "{}, frame {frame}: it would take {needed} bytes of memory and may take {allowed}: raise --max-memory if the \
         machine has it",
        path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Index of the frame.
        frame: usize,
        /// Bytes that it would take.
        needed: u64,
        /// Bytes that it may take.
        allowed: u64,
    },
    /// A frame that there is not.
    #[error("{} has {count} frames, frame {index} does not exist", path.display())]
    NoFrame {
        /// The file.
        path: PathBuf,
        /// The requested frame.
        index: usize,
        /// Frames that there are.
        count: usize,
    },
    /// A file without a frame.
    #[error(
        "{} holds no frame{}: if it is still being written, --follow waits for the first",
        path.display(),
        damage.as_ref().map(|damage| format!(" ({damage})")).unwrap_or_default()
    )]
    NoFrames {
        /// The file.
        path: PathBuf,
        /// Description of its unreadable parts.
        damage: Option<String>,
    },
    /// Somebody cancelled it.
    #[error("{}: cancelled", path.display())]
    Cancelled {
        /// The file.
        path: PathBuf,
    },
    /// Settings that cannot be meant.
    #[error("a sequence file cannot have {problem}")]
    Options {
        /// Description of the problem, with advice.
        problem: String,
    },
    /// A cloud that cannot be stored.
    #[error("frame {name}: {problem}")]
    Cloud {
        /// The frame's name.
        name: String,
        /// The reason.
        problem: String,
    },
}

/// Description of damaged bytes, before it is known which file they are from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault(pub(super) String);

impl Fault {
    pub(super) fn new(problem: impl Into<String>) -> Self {
        Self(problem.into())
    }

    /// Converts the fault to an error with the file path and byte offset.
    pub(super) fn at(self, path: &Path, byte: u64) -> ReelError {
        ReelError::Damaged {
            path: path.to_owned(),
            byte,
            problem: self.0,
        }
    }
}
