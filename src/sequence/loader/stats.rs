//! Loader statistics.

use crate::sequence::Detail;

/// Loading state of a frame, for the timeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FrameState {
    /// Not in memory.
    Absent,
    /// A worker is on it.
    Loading,
    /// Ready to be drawn with fewer points than its file has.
    Coarse,
    /// In memory, but not yet with all that is needed now.
    Stale,
    /// Ready to be drawn.
    Ready,
    /// Gone for good: it was live, and is not in memory.
    Gone,
    /// Cannot be shown; [`super::Slot::Failed`] has the reason.
    Failed,
}

/// Work done since the loader was made, and memory in use now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LoaderStats {
    /// Calls of a decoder for this sequence, failed ones included.
    pub decoded: u64,
    /// Frames whose normals were estimated.
    pub surfaces_estimated: u64,
    /// Frames with normals whose radii were estimated.
    pub radii_estimated: u64,
    /// Frames whose ellipses were estimated.
    pub ellipses_estimated: u64,
    /// Octrees built.
    pub octrees_built: u64,
    /// Point and shape records written.
    pub records_written: u64,
    /// Frames that were given up half done because the playhead had passed them or they did not fit.
    pub cancelled: u64,
    /// Frames dropped to keep within the budget.
    pub evicted: u64,
    /// Frames that cannot be shown.
    pub failed_frames: usize,
    /// Prepared frames in memory.
    pub resident_frames: usize,
    /// Bytes of the prepared frames in memory.
    pub resident_bytes: usize,
    /// Prepared frames of fewer points than their files have.
    pub coarse_frames: usize,
    /// Their bytes.
    pub coarse_bytes: usize,
    /// Level of detail of frames that are due soon.
    pub detail: Detail,
    /// Bytes of frames being made, as far as known.
    pub in_flight_bytes: usize,
    /// The maximum number of bytes in use at once, resident and in flight.
    pub peak_bytes: usize,
    /// Memory budget that they are compared with.
    pub budget_bytes: usize,
}
