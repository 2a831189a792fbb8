//! What a live stream tells of itself.

use super::recorder::StreamRecording;
use crate::wire::View;
use std::path::Path;

/// How a live stream is doing, and what records it.
pub trait Live: Send + Sync {
    /// How it is doing now.
    fn status(&self) -> LiveStatus;

    /// How many frames were served after frame `shown`, as far as it is known here; `None` for a frame that is gone.
    fn frames_behind(&self, shown: usize) -> Option<u64>;

    /// Says what is looked at. A stream that was opened for the points that are seen is sent these from then on; others
    /// do not care.
    fn look_from(&self, view: View);

    /// Writes what arrives from now on to a new file at `path`, which replaces another one there. What was being
    /// recorded before is finished.
    ///
    /// # Errors
    /// Why the file cannot be written, in a sentence.
    fn start_recording(&self, path: &Path) -> Result<(), String>;

    /// Ends the recording, and says what it has.
    ///
    /// # Errors
    /// Why its end could not be written, in a sentence.
    fn stop_recording(&self) -> Result<Option<StreamRecording>, String>;
}

/// How a live stream is doing.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LiveStatus {
    /// Whether it is connected.
    pub state: LiveState,
    /// Frames that were received.
    pub received_frames: u64,
    /// Frames that the server has played while it was connected and that did not come: they were dropped for newer
    /// ones, or not made in time.
    pub lost_frames: u64,
    /// Bytes a second, lately.
    pub bytes_per_s: f64,
    /// Frames a second, lately.
    pub frames_per_s: f64,
    /// How long after it was served the newest frame had come, seconds, and how wrong that may be: half of the time of
    /// a ping, as the clocks of two machines differ. `None` before the first ping has come back.
    pub delay_s: Option<(f64, f64)>,
    /// Seconds that can be gone back.
    pub kept_s: f64,
    /// Bytes of the frames that can be gone back to.
    pub kept_bytes: usize,
    /// Connections that were made again.
    pub reconnects: u64,
    /// What is being recorded.
    pub recording: Option<StreamRecording>,
}

/// Whether a live stream is connected.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LiveState {
    /// It is.
    Connected,
    /// It is not, for this reason, and is tried again.
    Reconnecting(String),
}
