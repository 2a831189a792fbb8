//! What keys and menus ask for, and the one table of keys: the dispatcher and the help window both read [`BINDINGS`].

mod bindings;
mod dispatch;
mod kinds;

pub use bindings::{BINDINGS, Binding, Chord, GESTURES};
pub(super) use dispatch::{dispatch, keys_of};
pub use kinds::Command;
