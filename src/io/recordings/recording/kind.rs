//! A row of the table of recordings ([`super::KINDS`]): how the messages in files of a format are found.

use super::found::{FoundMessages, Wanted};
use super::walk::Walk;
use crate::io::error::Fault;
use crate::io::format::Format;
use crate::io::options::ReadOptions;
use crate::io::refused::foreign::Foreign;
use std::path::Path;

/// A kind of recording.
pub(super) struct Kind {
    pub(super) format: Format,
    pub(super) find: Find,
    /// The kind of a file in which no messages are found, where it is known as one of another program.
    pub(super) known_as: fn(&Path) -> Option<&'static Foreign>,
}

/// Method of finding messages.
pub(super) enum Find {
    /// From record to record of the file.
    Walk(fn(&mut Walk, Wanted, &ReadOptions) -> Result<FoundMessages, Fault>),
    /// By asking the database that the file is.
    Ask(fn(&Path, Wanted) -> Result<FoundMessages, Fault>),
}
