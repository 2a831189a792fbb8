//! Stub of [`db3`](super::db3) for a build without `SQLite`: such files are refused.

use super::found::{FoundMessages, Wanted};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use crate::io::refused::foreign::Foreign;
use std::path::Path;

const ABSENT: &str = "this build does not read SQLite databases: build with `--features sqlite`";

/// Refuses.
pub(super) fn find(_path: &Path, _wanted: Wanted) -> Result<FoundMessages, Fault> {
    Err(Fault::header(ABSENT.to_owned()))
}

/// Nothing is known of the tables of a database.
pub(super) fn foreign_kind(_path: &Path) -> Option<&'static Foreign> {
    None
}

/// The messages of a database: none is opened.
pub(super) enum Messages {}

impl Messages {
    /// Refuses.
    pub(super) fn open(_path: &Path) -> Result<Self, String> {
        Err(ABSENT.to_owned())
    }

    /// The bytes of a message.
    pub(super) fn read(&self, _row: i64, _options: &ReadOptions) -> Result<Vec<u8>, String> {
        match *self {}
    }
}
