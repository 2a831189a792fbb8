//! Opening details of the open sequence, and the session that it belongs to.

use crate::app::features::camera_path::Draft;
use crate::app::recent::entry_name;
use crate::app::side::Side;
use crate::document::{Beyond, Compared, Document, TextHash};
use crate::sequence::OpenOptions;
use std::path::PathBuf;
use std::sync::Arc;

/// Opening details of the open sequence, and the session that it belongs to.
#[derive(Debug, Default)]
pub(in crate::app) struct Opened {
    /// Named inputs; empty if none were named.
    pub(in crate::app) inputs: Vec<PathBuf>,
    /// Open options, if they differ from the window's defaults.
    pub(in crate::app) options: Option<OpenOptions>,
    /// Compared sequence of the document, until that is open.
    pub(in crate::app) compared: Option<Compared>,
    /// The file of its session.
    pub(in crate::app) file: Option<PathBuf>,
    /// Not all of the file could be read: it is copied before it is replaced.
    pub(in crate::app) is_damaged: bool,
}

/// A session that opens more than the files of its folder, and is not opened before the user allows it.
#[derive(Debug)]
pub struct SessionQuestion {
    pub(in crate::app) inputs: Vec<PathBuf>,
    pub(in crate::app) open: OpenOptions,
    pub(in crate::app) side: Side,
    /// Inputs that the session would open.
    pub beyond: Beyond,
}

impl SessionQuestion {
    /// The name of its file.
    pub fn name(&self) -> String {
        entry_name(&self.inputs)
    }
}

/// A session was written.
#[derive(Debug)]
pub struct SavedSession {
    pub(in crate::app) file: PathBuf,
    /// The camera path that is in it.
    pub(in crate::app) path: Arc<Draft>,
    /// The document that is in it, as it is stored.
    pub(in crate::app) document: Box<Document>,
    /// Hash of the session's text.
    pub(in crate::app) hash: TextHash,
}
