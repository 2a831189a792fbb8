//! Status of a live stream.

use super::recorder::StreamRecording;
use crate::wire::View;
use std::path::Path;

/// Status and recording of a live stream.
pub trait Live: Send + Sync {
    /// Returns the current status.
    fn status(&self) -> LiveStatus;

    /// Returns the number of frames served after frame `shown`, as far as is known here; `None` for a frame that is
    /// gone.
    fn frames_behind(&self, shown: usize) -> Option<u64>;

    /// Sets the view. A stream that was opened for visible points is sent these from then on; others ignore it.
    fn look_from(&self, view: View);

    /// Writes messages that arrive from now on to a new file at `path`, which replaces another one there. An earlier
    /// recording is finished.
    ///
    /// # Errors
    /// The reason why the file cannot be written, in a sentence.
    fn start_recording(&self, path: &Path) -> Result<(), String>;

    /// Ends the recording, and returns its summary.
    ///
    /// # Errors
    /// The reason why its end could not be written, in a sentence.
    fn stop_recording(&self) -> Result<Option<StreamRecording>, String>;
}

/// Status of a live stream.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LiveStatus {
    /// Connection state.
    pub state: LiveState,
    /// Frames that were received.
    pub received_frames: u64,
    /// Frames that the server has played while it was connected and that did not come: they were dropped for newer
    /// ones, or not made in time.
    pub lost_frames: u64,
    /// Recent data rate, in bytes per second.
    pub bytes_per_s: f64,
    /// Recent frame rate, in frames per second.
    pub frames_per_s: f64,
    /// Latency of the newest frame, from being served to arriving, in seconds, and its uncertainty: half of the
    /// round-trip time of a ping, as the clocks of two machines differ. `None` before the first ping has come back.
    pub delay_s: Option<(f64, f64)>,
    /// Seconds that can be gone back.
    pub buffered_s: f64,
    /// Bytes of the frames that can be gone back to.
    pub buffered_bytes: usize,
    /// Connections that were made again.
    pub reconnects: u64,
    /// Recording in progress.
    pub recording: Option<StreamRecording>,
}

/// Connection state of a live stream.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LiveState {
    /// The stream is connected.
    Connected,
    /// The stream is not connected, for this reason, and is tried again.
    Reconnecting(String),
}
