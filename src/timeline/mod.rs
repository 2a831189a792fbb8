//! Playback timing: the playback clock, the paths of the playhead through the frames, their pace and the range that
//! plays.
//!
//! Nothing here depends on the contents of frames, or reads a real clock: time is passed in.

mod clock;
mod pace;
mod play_range;
mod travel;

pub use clock::{Clock, DEFAULT_FPS, MAX_SPEED, MIN_SPEED};
pub use pace::Pace;
pub use play_range::PlayRange;
pub(crate) use travel::Travel;
pub use travel::{Direction, LoopMode};
