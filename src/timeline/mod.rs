//! Which frame is due when: the playback clock, its ways through the frames, their pace and the range that plays.
//!
//! Nothing here knows what a frame is, or looks at a real clock: time is handed in.

mod clock;
mod pace;
mod play_range;
mod travel;

pub use clock::{Clock, DEFAULT_FPS, MAX_SPEED, MIN_SPEED};
pub use pace::Pace;
pub use play_range::PlayRange;
pub(crate) use travel::Travel;
pub use travel::{Direction, LoopMode};
