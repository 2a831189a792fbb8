//! Errors of a single frame of a sequence.

use crate::cloud::CloudError;
use crate::messages::frame_by_index;
use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reasons why one frame cannot be shown. The sequence plays on without it.
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
        /// Reason for the mismatch.
        reason: CloudError,
    },
    /// The machine has not the memory for it.
    #[error(
        "{}: the data that {points} points are drawn from takes {:.1} GiB, more than the {:.1} GiB of this machine; \
         they can be drawn as points (--primitive point), or downsampled (`pointreel convert`)",
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
    /// It came from something that cannot be rewound, and was not retained.
    #[error("{}: {} is gone: it was live and is kept nowhere", path.display(), frame_by_index(*index))]
    Gone {
        /// Index in the sequence.
        index: usize,
        /// Path it came from.
        path: PathBuf,
    },
    /// The program's own fault, confined to this frame.
    #[error("{}: the program failed on this frame ({message}); the other frames still play, please report it with the \
        file", path.display())]
    Panic {
        /// Index in the sequence.
        index: usize,
        /// The file.
        path: PathBuf,
        /// Message of the panic.
        message: String,
    },
    /// An index beyond the end.
    #[error("frame {index} does not exist: the sequence has {count} frames, and indices count from 0")]
    NoSuchFrame {
        /// The requested index.
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
            | Self::Gone { index, .. }
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
            | Self::Gone { path, .. }
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
