//! Assumptions about the open sequence: a chip with their number, and a list that offers the alternatives.
//!
//! **How it works.** [`groups`] joins the assumptions of the sequence and the initial view ([`crate::assumption`]) with
//! the user's choices, one [`Group`] per subject. A [`Change`] is one alternative: another up axis or primitive takes
//! effect at once; a [`ReadChange`] changes the options by which the inputs are read, so they are opened again. The
//! window's state applies changes and stores them (`in_window.rs`). A subject that can be changed by reading is a row
//! of `ReadRow::ALL`.

mod change;
mod depth_filters;
mod groups;
mod in_window;
pub(in crate::app) mod panel;
mod read_rows;

pub(in crate::app) use change::{Change, ReadChange};
pub(in crate::app) use groups::{Given, Group, groups};
pub(in crate::app) use read_rows::FileKind;

/// List of assumptions; it is rebuilt from the open inputs.
#[derive(Debug, Default)]
pub struct Assumptions;
