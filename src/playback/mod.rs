//! Playing a sequence: which frame is due, which is shown, what is waited for.
//!
//! [`Player`] joins a clock and a loader and knows no window; time is handed in. The window and the benchmark of
//! playing are its users. A [`Companion`] goes along with it: a second sequence by the same clock.

mod attributes;
mod companion;
mod marks;
mod pairing;
mod player;

pub use companion::Companion;
pub use marks::{Mark, MarkRun};
pub use pairing::{Pair, PairBy, PairNumbers, PairTimes};
pub use player::{Player, PlayerChange};
