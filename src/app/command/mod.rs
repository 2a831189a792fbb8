//! Commands: the actions of keys, menus, the palette and scripts, and the row that describes each. The table itself is
//! [`crate::app::commands`].

mod keys;
mod kinds;
mod offer;
mod row;

pub use keys::{Chord, GESTURES, Keys};
pub use kinds::Command;
pub(super) use offer::{NumberUse, Offer};
pub(super) use row::Act;
pub use row::{CommandRow, Menu};
