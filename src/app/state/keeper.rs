//! What is known of how the open document is kept.

use super::measured_way::MeasuredWay;
use crate::document::{Document, UnsavedPlace};
use std::path::PathBuf;
use std::time::Duration;

/// What is known of how the open document is kept.
#[derive(Debug, Default)]
pub(super) struct Keeper {
    /// Its file; `None` if it is not kept.
    pub(super) file: Option<PathBuf>,
    /// Where unsaved changes of its session are kept.
    pub(super) unsaved: Option<UnsavedPlace>,
    /// What this window has read from the file or written to it last.
    pub(super) written: Document,
    /// As it was opened, or kept last.
    pub(super) begun: Document,
    /// As it was opened, or saved as a session last.
    pub(super) saved: Document,
    /// As a new one is.
    pub(super) new: Document,
    /// As it was at the last look, with the view of that; `None` if what it is compared with has changed since.
    pub(super) seen: Option<Document>,
    /// Whether that holds other work than `saved`.
    pub(super) is_unsaved: bool,
    /// Whether that holds other work than `begun`.
    pub(super) is_other_work: bool,
    /// Since when there is something to be kept.
    pub(super) changed: Option<Duration>,
    /// What the command line has changed of the settings: that is not kept.
    pub(super) given: Option<MeasuredWay>,
}
