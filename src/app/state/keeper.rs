//! Save state of the open document.

use super::measured_way::MeasuredWay;
use crate::document::{Document, UnsavedPlace};
use std::path::PathBuf;
use std::time::Duration;

/// Save state of the open document.
#[derive(Debug, Default)]
pub(super) struct Keeper {
    /// Its file; `None` if it is not stored.
    pub(super) file: Option<PathBuf>,
    /// Location of the unsaved changes of its session.
    pub(super) unsaved: Option<UnsavedPlace>,
    /// Document as last read from or written to the file by this window.
    pub(super) written: Document,
    /// State when it was opened, or last stored.
    pub(super) begun: Document,
    /// As it was opened, or saved as a session last.
    pub(super) saved: Document,
    /// As a new one is.
    pub(super) new: Document,
    /// State at the last check, with its view; `None` if the reference has changed since.
    pub(super) seen: Option<Document>,
    /// True if `seen` contains other work than `saved`.
    pub(super) is_unsaved: bool,
    /// True if `seen` contains other work than `begun`.
    pub(super) is_other_work: bool,
    /// Time since which there are changes to store.
    pub(super) changed: Option<Duration>,
    /// Settings overridden by the command line, which are not stored.
    pub(super) given: Option<MeasuredWay>,
}
