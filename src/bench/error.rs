//! Errors of benchmark runs.

use crate::measure::{SizeMismatch, SsimError, SurfaceMismatch};
use crate::progress::Progress;
use crate::render::RenderError;
use crate::sequence::SequenceError;

/// Errors of benchmark runs.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// Cancelled before the end.
    #[error("the benchmark was cancelled")]
    Cancelled,
    /// No input, or a sequence without frames.
    #[error("there is nothing to measure: {0}")]
    Nothing(String),
    /// None of the frames chosen from a sequence can be measured.
    #[error("none of the frames chosen from {sequence} can be measured; the first: {reason}")]
    NoFrame {
        /// Name of the sequence.
        sequence: String,
        /// Description of the problem with the first of them.
        reason: String,
    },
    /// A window measures itself.
    #[error("`window` is measured by a window, not without one")]
    NeedsWindow,
    /// Not in the table of suites.
    #[error("`{0}` is not a suite")]
    NoSuite(&'static str),
    /// An option is 0.
    #[error("the number of {0} must be at least 1")]
    ZeroOption(&'static str),
    /// Two images of one run differ in size.
    #[error(transparent)]
    Compare(#[from] SizeMismatch),
    /// An image is too small for SSIM.
    #[error(transparent)]
    Ssim(#[from] SsimError),
    /// Depths that cannot be compared.
    #[error(transparent)]
    Surface(#[from] SurfaceMismatch),
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The threads that load frames do not start.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// A sequence file that cannot be written or read back.
    #[error(transparent)]
    Reel(#[from] crate::reel::ReelError),
    /// Draco cannot write or read a cloud.
    #[error("Draco: {0}")]
    Draco(String),
    /// Points that do not form a frame.
    #[error(transparent)]
    Cloud(#[from] crate::cloud::CloudError),
    /// Clouds that cannot be compared.
    #[error(transparent)]
    Compared(#[from] crate::measure::CloudMismatch),
    /// The thread to build octrees on does not start.
    #[error(transparent)]
    Thread(#[from] rayon::ThreadPoolBuildError),
}

impl BenchError {
    /// Fails once the run is cancelled.
    pub(super) fn check_cancelled(progress: &Progress) -> Result<(), Self> {
        if progress.is_cancelled() {
            return Err(Self::Cancelled);
        }
        Ok(())
    }
}
