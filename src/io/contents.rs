//! What frames are in a file: most files are one, archives, recordings and animated models are many.

use super::{Format, IoError, ReadOptions};
use std::path::Path;
use std::time::Duration;

/// Which of the frames in a file is meant. What a file holds is found once, by [`list`]; a part is then read without
/// looking at the others.
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

/// A topic of a recording with point clouds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// Its name, such as `/lidar/points`.
    pub name: String,
    /// Number of its messages.
    pub cloud_count: usize,
    /// Whether its point clouds are the frames.
    pub is_read: bool,
}

/// What is in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Contents {
    /// The frames, in the order of time or of their names.
    pub entries: Vec<Entry>,
    /// The topics with point clouds of a recording, in the order of their names; other files have none.
    pub topics: Vec<Topic>,
}

impl Contents {
    /// Frames of a file that has no topics.
    pub(super) fn of_entries(entries: Vec<Entry>) -> Self {
        Self {
            entries,
            topics: Vec::new(),
        }
    }
}

/// What is in the file at `path`; a file of one frame is not looked at beyond its first bytes. Of a recording, the
/// point clouds of `topic` are the frames: none where it has no such topic, those of the topic that has the most if
/// `None`.
pub fn contents(
    path: &Path,
    topic: Option<&str>,
    options: &ReadOptions,
) -> Result<Contents, IoError> {
    match Format::detect(path, &super::first_bytes(path)?) {
        Some(format) => super::list_format(path, format, topic, options),
        None => Ok(Contents::of_entries(vec![Entry::whole()])),
    }
}

/// The frames of [`contents`], of the topic that has the most.
pub fn list(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    Ok(contents(path, None, options)?.entries)
}
