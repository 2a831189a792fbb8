//! A row of the table of files that are recordings of depth images ([`super::recorders`]).

use super::error::RgbdError;
use super::layouts::FoundRecording;
use crate::source::OpenOptions;
use std::path::Path;

/// A method of recording depth images into one file.
pub(super) struct Recorder {
    /// Extensions of its files, in lower case, where no point cloud has them.
    pub(super) extensions: &'static [&'static str],
    /// Predicate that returns true if a file is of this format, by its name or its first bytes.
    pub(super) can_read: fn(&Path) -> bool,
    /// The recording in such a file; `None` if it holds none.
    pub(super) find: fn(&Path, &OpenOptions) -> Result<Option<Found>, RgbdError>,
}

/// A recording, and the name of its layout for people.
pub(super) type Found = (&'static str, FoundRecording);
