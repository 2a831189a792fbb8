//! Setting descriptions: the name of a setting, its permitted values, and how they are written; the one description
//! that the panel, the command line, the files, undo and the labels of benchmarks read.
//!
//! **How it works.** A group of settings is a struct whose fields are declared next to their [`Described`] (`group!`).
//! Readers know no field: [`Settings::edit`](super::Settings::edit) shows them each description with the setting's
//! [`Value`].

mod conditions;
mod described;
mod group;
mod numbers;
mod setting;
mod shorthand;
mod values;

pub use conditions::Conditions;
pub use described::{Described, Label, Place, Section, When};
pub(super) use group::group;
pub use numbers::{Numbers, Typed, Unit};
pub use setting::Setting;
pub use shorthand::{Given, Shorthand};
pub use values::{Kind, KindNumber, Value, Values, Word, Words};
