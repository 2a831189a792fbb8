//! Re-encoding of the open sequence: as one sequence file, or as one file per frame. An estimate of the result is shown
//! before.
//!
//! **How it works.** [`choices`] are the settings of the user, [`plan`] turns them into a conversion and gives the
//! reason if there is none, [`estimates`] evaluates the settings on some frames on a thread while they are edited,
//! [`job`] writes.

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
