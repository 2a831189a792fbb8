//! Playing a sequence: the frame that is due, the one shown, and waiting for data.
//!
//! [`Player`] joins a clock and a loader and knows no window; time is handed in. The window and the benchmark of
//! playing are its users. A [`Companion`] goes along with it: another sequence on the same clock.

mod attributes;
mod companion;
mod marks;
mod pairing;
mod player;

pub use companion::Companion;
pub use marks::{Mark, MarkRun};
pub use pairing::{Pair, PairBy, PairNumbers, PairTimes};
pub use player::{Player, PlayerChange};
