//! The open sequence written anew: as one sequence file, or as a file a frame. What it comes to is shown before.
//!
//! **How it works.** [`choices`] are what a person chose, [`plan`] makes a conversion of them and says why there is
//! none, [`estimates`] judges the choices by some frames on a thread while they are made, [`job`] writes.

mod choices;
mod estimates;
mod in_window;
pub(in crate::app) mod job;
pub(in crate::app) mod panel;
mod plan;
mod summary;

pub use choices::{PrecisionKind, Save, SaveFormat};
pub use estimates::{Estimated, Estimates};
pub use job::SaveEnded;
pub(in crate::app) use plan::Savable;
