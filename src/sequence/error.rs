//! What can be wrong with a sequence, and with one frame of it.

use crate::cloud::CloudError;
use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a sequence cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SequenceError {
    /// No input was named.
    #[error(
        "no input was given: name a folder of frames, a file, or a pattern such as 'scan_*.ply'"
    )]
    NoInput,
    /// A path that is not there.
    #[error("{} does not exist: name a file, a folder of frames, or a pattern such as 'scan_*.ply'", path.display())]
    Missing {
        /// The path as given.
        path: PathBuf,
    },
    /// A folder in which no file is a point cloud by its extension.
    #[error("no point cloud is in the folder {} (looked for {extensions}): {hint}", path.display())]
    EmptyFolder {
        /// The folder as given.
        path: PathBuf,
        /// What was looked for, such as `*.ply, *.pcd`.
        extensions: String,
        /// What to do.
        hint: String,
    },
    /// A pattern without a match.
    #[error("no file matches {pattern}: check the pattern, or name the folder instead")]
    NoMatch {
        /// The pattern as given.
        pattern: String,
    },
    /// A pattern that is not one.
    #[error(
        "{pattern} is not a valid pattern ({reason}): put [ and ] around the characters * ? [ to mean themselves"
    )]
    BadPattern {
        /// The pattern as given.
        pattern: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A topic that no recording among the inputs has.
    #[error("there are no point clouds of topic {topic}: {hint}")]
    NoTopic {
        /// The topic as given.
        topic: String,
        /// What there is.
        hint: String,
    },
    /// A folder or path that the system does not let us look into.
    #[error("{} cannot be listed ({reason}): check its permissions", path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// Somebody cancelled it.
    #[error("opening was cancelled")]
    Cancelled,
    /// The system gives no thread to load frames on.
    #[error(
        "no thread could be started to load frames ({reason}): close other programs or raise the process limit"
    )]
    NoThread {
        /// The system's reason.
        reason: std::io::Error,
    },
}

/// Why one frame cannot be shown. The sequence plays on without it.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The file cannot be read; the decoder's message names the file and the place in it.
    #[error("{reason}")]
    Decode {
        /// Index in the sequence.
        index: usize,
        /// The file.
        path: PathBuf,
        /// The decoder's error.
        reason: Arc<dyn Error + Send + Sync>,
    },
    /// The file was read but its arrays do not fit together.
    #[error("{}: {reason}", path.display())]
    Invalid {
        /// Index in the sequence.
        index: usize,
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: CloudError,
    },
    /// The machine has not the memory for it.
    #[error(
        "{}: what {points} points are drawn from takes {:.1} GiB, more than the {:.1} GiB of this machine; \
         they can be drawn as points (--primitive point), or thinned out (`pointreel convert`)",
        path.display(), gibibytes(*needed_bytes), gibibytes(*machine_bytes)
    )]
    TooLarge {
        /// Index in the sequence.
        index: usize,
        /// The file.
        path: PathBuf,
        /// Its points.
        points: usize,
        /// Bytes that are needed at once.
        needed_bytes: u64,
        /// Bytes that the machine has.
        machine_bytes: u64,
    },
    /// Somebody cancelled the reading of it.
    #[error("{} was not read to its end, as that was cancelled: open it again to read it", path.display())]
    Cancelled {
        /// Index in the sequence.
        index: usize,
        /// The file.
        path: PathBuf,
    },
    /// The program's own fault, kept to this frame.
    #[error("{}: the program failed on this frame ({message}); the other frames still play, please report it with the file", path.display())]
    Panic {
        /// Index in the sequence.
        index: usize,
        /// The file.
        path: PathBuf,
        /// Message of the panic.
        message: String,
    },
    /// An index beyond the end.
    #[error("there is no frame {index}: the sequence has {count} frames, counted from 0")]
    NoSuchFrame {
        /// The index asked for.
        index: usize,
        /// Number of frames.
        count: usize,
    },
}

fn gibibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}

impl FrameError {
    /// Index in the sequence.
    pub fn index(&self) -> usize {
        match self {
            Self::Decode { index, .. }
            | Self::Invalid { index, .. }
            | Self::TooLarge { index, .. }
            | Self::Cancelled { index, .. }
            | Self::Panic { index, .. }
            | Self::NoSuchFrame { index, .. } => *index,
        }
    }

    /// The file, where there is one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Decode { path, .. }
            | Self::Invalid { path, .. }
            | Self::TooLarge { path, .. }
            | Self::Cancelled { path, .. }
            | Self::Panic { path, .. } => Some(path),
            Self::NoSuchFrame { .. } => None,
        }
    }
}

/// Runs `work` on frame `index`; a panic becomes [`FrameError::Panic`].
pub(super) fn catch_panic<T>(
    index: usize,
    path: &Path,
    work: impl FnOnce() -> Result<T, FrameError>,
) -> Result<T, FrameError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let message = payload
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".to_owned());
        Err(FrameError::Panic {
            index,
            path: path.to_path_buf(),
            message,
        })
    })
}
