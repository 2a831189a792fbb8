//! What frames are in a file: most files are one, archives, recordings and animated models are many.

use super::{Format, IoError, ReadOptions};
use std::path::Path;
use std::time::Duration;

/// Which of the frames in a file is meant. What a file holds is found once, by [`list`]; a part is then read without looking at
/// the others.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// All of it.
    Whole,
    /// One of several scans in a file (E57), counted from 0.
    Scan(usize),
    /// The pose at this time of an animation (glTF).
    Moment(Duration),
    /// A file within an archive.
    Member(super::archive::Member),
    /// A message of a recording.
    Message(super::recording::Message),
}

/// A frame in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Name for people, and for its number; empty where the file's own name says it all.
    pub name: String,
    /// When it was taken, since whatever moment the file counts from.
    pub time: Option<Duration>,
    /// Where it is.
    pub part: Part,
}

impl Entry {
    /// The whole file.
    pub(super) fn whole() -> Self {
        Self {
            name: String::new(),
            time: None,
            part: Part::Whole,
        }
    }
}

/// The frames in the file at `path`, in the order of time or of their names; a file of one frame is not looked at beyond its
/// first bytes.
pub fn list(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    match Format::detect(path, &super::first_bytes(path)?) {
        Some(format) => super::list_format(path, format, options),
        None => Ok(vec![Entry::whole()]),
    }
}
