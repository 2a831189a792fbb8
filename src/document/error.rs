//! Why a session cannot be opened or saved.

use super::reach::Beyond;
use std::path::PathBuf;

/// Why a session cannot be opened or saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// The file cannot be read.
    #[error("the session {} cannot be read: {reason}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The file cannot be written.
    #[error(
        "the session could not be saved to {} ({reason}): choose another folder or free disk space",
        file.display()
    )]
    Write {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// Larger than any session.
    #[error("{} is not a session: it has more than {} MiB", file.display(), max_bytes >> 20)]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Maximum size of a session file in bytes.
        max_bytes: u64,
    },
    /// The file is not a session; the reason names line and column.
    #[error("{} is not a session that can be opened: {reason}", file.display())]
    Json {
        /// The file.
        file: PathBuf,
        /// Parse error with its position.
        reason: serde_json::Error,
    },
    /// It was written by a later program.
    #[error(
        "{} is a session of version {version}, and this program knows version {known}: open it with a newer pointreel",
        file.display()
    )]
    Later {
        /// The file.
        file: PathBuf,
        /// Its version.
        version: u64,
        /// The latest that is known.
        known: u64,
    },
    /// More than a session can have.
    #[error("the session {} has {count} {what}: expected at most {max}", file.display())]
    TooMany {
        /// The file.
        file: PathBuf,
        /// Name of the items that there are too many of.
        what: &'static str,
        /// Number of items.
        count: usize,
        /// Maximum number of items.
        max: usize,
    },
    /// It names a frame that no sequence has.
    #[error("the session {} names frame {frame}, counted from 0: expected at most {max}", file.display())]
    Frame {
        /// The file.
        file: PathBuf,
        /// Its index.
        frame: usize,
        /// The largest index that a session can name.
        max: usize,
    },
    /// It names nothing to open.
    #[error("the session {} has no `files`: expected at least one, such as \"scans\"", file.display())]
    NoFiles {
        /// The file.
        file: PathBuf,
    },
    /// A session is made of other files, not of sessions.
    #[error(
        "the session {} names the session {} among its `files`: name what that opens",
        file.display(),
        input.display()
    )]
    OfSession {
        /// The file.
        file: PathBuf,
        /// Input that the session names.
        input: PathBuf,
    },
    /// The session names addresses or files elsewhere that were not allowed.
    #[error("the session {} opens {beyond}: give {} if you trust it", file.display(), beyond.options())]
    Beyond {
        /// The file.
        file: PathBuf,
        /// External references that the session names.
        beyond: Beyond,
    },
    /// A text file cannot hold this name.
    #[error("{} has a name that is not valid Unicode: rename it to save a session of it", input.display())]
    Name {
        /// Input that was opened.
        input: PathBuf,
    },
}
