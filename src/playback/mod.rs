//! Playing a sequence: which frame is due, which is shown, what is waited for.
//!
//! [`Player`] joins a clock and a loader and knows no window; time is handed in. The window and the benchmark of playing are its users.

mod attributes;
mod marks;
mod player;

pub use marks::{Mark, Run};
pub use player::{Player, PlayerChange, can_draw};
