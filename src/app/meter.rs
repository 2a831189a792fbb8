//! How long the parts of a redraw took, and what the graphics card had to do for it.

use std::time::Duration;

/// The parts of one redraw, by the clock of the thread that the window is on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Redraw {
    /// Moving on and running the panels.
    pub panels: Duration,
    /// Drawing the 3-D pictures; on a graphics card, handing them over.
    pub drawing: Duration,
    /// Painting the window.
    pub painting: Duration,
    /// Handing the window to the window system or the driver.
    pub presenting: Duration,
    /// Waiting for the screen, or for a driver that is behind.
    pub waiting: Duration,
    /// All of it.
    pub whole: Duration,
    /// Pixels of the window that were painted anew.
    pub painted_px: u64,
    /// What was asked of the graphics card.
    pub gpu: GpuWork,
}

/// What a redraw asked of a graphics card. All is zero where the processor does everything.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GpuWork {
    /// Submissions to its queue.
    pub submissions: u64,
    /// Passes, those of the pictures and that of the window.
    pub passes: u64,
    /// Bytes of points, voxels, pictures and panels that were uploaded; without the few hundred that say how a picture
    /// is seen.
    pub uploaded_bytes: u64,
}

impl GpuWork {
    /// Adds what was asked beside it.
    pub fn add(&mut self, other: Self) {
        self.submissions += other.submissions;
        self.passes += other.passes;
        self.uploaded_bytes += other.uploaded_bytes;
    }
}
