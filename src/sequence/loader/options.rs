//! Loader options.

use crate::memory;
use std::sync::Arc;
use std::thread;

/// Maximum number of workers by default: beyond it the disk is the bottleneck.
const MAX_DEFAULT_WORKERS: usize = 8;

/// Default budget: 150 frames of 100,000 surfels.
const DEFAULT_BUDGET_BYTES: usize = 1 << 30;

/// Options of a [`Loader`](super::Loader).
#[derive(Clone)]
pub struct LoaderOptions {
    /// Number of threads, at least 1.
    pub workers: usize,
    /// Bytes for prepared frames, those in flight included. The playhead's frame may exceed it.
    pub budget_bytes: usize,
    /// Keep coarse copies of all frames of a sequence that is too long for the budget, in a quarter of it, so that each
    /// can be shown at once. They are made when nothing else is to be done.
    pub keeps_coarse_frames: bool,
    /// Large frames that are looked at come in stages, for who shows them as they come: some points, all points, the
    /// rest.
    pub shows_stages: bool,
    /// Memory of the machine in bytes: frames that take more are skipped, and reported.
    pub machine_bytes: u64,
    /// Called on a worker thread whenever a frame is finished, has failed or was given up. Must not block.
    pub wake: Arc<dyn Fn() + Send + Sync>,
}

impl Default for LoaderOptions {
    /// A worker per core up to 8, 1 GiB, no coarse copies, no wake-up call.
    fn default() -> Self {
        Self {
            workers: thread::available_parallelism()
                .map_or(1, usize::from)
                .min(MAX_DEFAULT_WORKERS),
            budget_bytes: DEFAULT_BUDGET_BYTES,
            keeps_coarse_frames: false,
            shows_stages: false,
            machine_bytes: memory::machine_bytes().unwrap_or(u64::MAX),
            wake: Arc::new(|| {}),
        }
    }
}

impl std::fmt::Debug for LoaderOptions {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("LoaderOptions")
            .field("workers", &self.workers)
            .field("budget_bytes", &self.budget_bytes)
            .field("keeps_coarse_frames", &self.keeps_coarse_frames)
            .field("shows_stages", &self.shows_stages)
            .field("machine_bytes", &self.machine_bytes)
            .finish_non_exhaustive()
    }
}
