//! Redraw timing: durations of the parts of a redraw, and the GPU work it needed.

use std::time::Duration;

/// The parts of one redraw, by the clock of the thread that the window is on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Redraw {
    /// Moving on and running the panels.
    pub panels: Duration,
    /// Time to draw the 3-D images; on a GPU, to submit them.
    pub drawing: Duration,
    /// Painting the window.
    pub painting: Duration,
    /// Handing the window to the window system or the driver.
    pub presenting: Duration,
    /// Waiting for the screen, or for a driver that is behind.
    pub waiting: Duration,
    /// All of it.
    pub whole: Duration,
    /// Number of pixels of the window that were repainted.
    pub painted_px: u64,
    /// GPU work requested.
    pub gpu: GpuWork,
}

/// GPU work of a redraw. All is zero where the CPU does everything.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GpuWork {
    /// Submissions to its queue.
    pub submissions: u64,
    /// Render passes of the images and the window.
    pub passes: u64,
    /// Bytes of points, voxels, images and panels that were uploaded; without the few hundred of uniforms per image.
    pub uploaded_bytes: u64,
}

impl GpuWork {
    /// Adds the work that was requested in addition.
    pub fn add(&mut self, other: Self) {
        self.submissions += other.submissions;
        self.passes += other.passes;
        self.uploaded_bytes += other.uploaded_bytes;
    }
}
