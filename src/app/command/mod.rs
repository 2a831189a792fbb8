//! Commands: what keys, menus, the palette and scripts ask for, and what is said of each in its row. The table itself
//! is [`crate::app::commands`].

mod keys;
mod kinds;
mod offer;
mod row;

pub use keys::{Chord, GESTURES, Keys};
pub use kinds::Command;
pub(super) use offer::{NumberUse, Offer};
pub(super) use row::Act;
pub use row::{CommandRow, Menu};
