//! What is known of how the open document is kept.

use crate::app::features::quality::MeasuredWay;
use crate::document::Document;
use std::path::PathBuf;
use std::time::Duration;

/// What is known of how the open document is kept.
#[derive(Debug, Default)]
pub(super) struct Keeper {
    /// Its file; `None` if it is not kept.
    pub(super) file: Option<PathBuf>,
    /// What this window has read from the file or written to it last.
    pub(super) written: Document,
    /// As it was opened, or kept last.
    pub(super) begun: Document,
    /// As it was opened, or saved as a session last.
    pub(super) saved: Document,
    /// As a new one is.
    pub(super) new: Document,
    /// What is to be kept, and since when it is so.
    pub(super) changed: Option<(Document, Duration)>,
    pub(super) is_unsaved: bool,
    /// What the command line has changed of the settings: that is not kept.
    pub(super) given: Option<MeasuredWay>,
}
