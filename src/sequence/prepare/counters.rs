//! Costs of preparing a frame.

use std::sync::atomic::{AtomicU64, Ordering};

/// Wall time of the stages that made a frame, in milliseconds; 0 for stages not run or reused.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timings {
    /// Reading, decoding and validating the file.
    pub decode_ms: f32,
    /// Normals and radii.
    pub analysis_ms: f32,
    /// Packing points and shapes.
    pub records_ms: f32,
    /// Building the octree.
    pub octree_ms: f32,
}

impl Timings {
    /// All stages together.
    pub fn total_ms(&self) -> f32 {
        self.decode_ms + self.analysis_ms + self.records_ms + self.octree_ms
    }
}

/// Work counters; the proof that nothing is done twice. Shared between threads.
#[derive(Debug, Default)]
pub struct PrepareCounters {
    pub(super) surfaces_estimated: AtomicU64,
    pub(super) radii_estimated: AtomicU64,
    pub(super) ellipses_estimated: AtomicU64,
    pub(super) octrees_built: AtomicU64,
    pub(super) records_written: AtomicU64,
}

impl PrepareCounters {
    /// Frames whose normals (and radii) were estimated.
    pub fn surfaces_estimated(&self) -> u64 {
        self.surfaces_estimated.load(Ordering::Relaxed)
    }

    /// Frames with normals whose radii were estimated.
    pub fn radii_estimated(&self) -> u64 {
        self.radii_estimated.load(Ordering::Relaxed)
    }

    /// Frames whose ellipses were estimated.
    pub fn ellipses_estimated(&self) -> u64 {
        self.ellipses_estimated.load(Ordering::Relaxed)
    }

    /// Octrees built.
    pub fn octrees_built(&self) -> u64 {
        self.octrees_built.load(Ordering::Relaxed)
    }

    /// Point and shape records written.
    pub fn records_written(&self) -> u64 {
        self.records_written.load(Ordering::Relaxed)
    }
}
