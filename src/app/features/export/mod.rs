//! Export of images and videos from the window: the user's choices, their validation, and the work itself.

mod choices;
mod exportable;
mod in_window;
pub(in crate::app) mod job;
pub(in crate::app) mod panel;
mod plan;

pub use choices::{Export, ExportSubject};
pub(in crate::app) use exportable::Exportable;
pub use job::{ExportEnded, Exported};
