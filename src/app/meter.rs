//! How long the parts of a redraw took.

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
}
