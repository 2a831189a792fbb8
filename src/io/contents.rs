//! Contents of a file: the frames in it. Most files are one frame; archives, recordings and animated models are many.

use crate::io::recordings::archive::Member;
use crate::io::recordings::packets::Turn;
use crate::io::recordings::recording::Message;
use std::time::Duration;

/// Part of a file: one of the frames in it. The contents of a file are listed once, by [`super::list`]; a part is then
/// read without visiting the others.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// All of it; of a file with several frames the first.
    Whole,
    /// The only frame of a file whose frames could not be listed; none where it turns out to have several.
    Sole,
    /// One of several scans in a file (E57), counted from 0.
    Scan(usize),
    /// The pose at this time of an animation (glTF).
    TimeStep(Duration),
    /// A layer of an array of T × N × 3 (NPZ), or a frame of a text, counted from 0.
    Layer(usize),
    /// A file within an archive.
    Member(Member),
    /// A message of a recording.
    Message(Message),
    /// Revolution of a LiDAR in a packet capture.
    Turn(Turn),
}

/// A frame in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Name for display, and for its number; empty where the file's own name suffices.
    pub name: String,
    /// Timestamp of the frame, relative to the epoch of the file.
    pub time: Option<Duration>,
    /// Location of the frame in the file.
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

/// A topic of a recording with point clouds, or a sensor of a capture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// Its name, such as `/lidar/points`; of a sensor its address with the port that it sends to.
    pub name: String,
    /// Number of its messages, or revolutions.
    pub cloud_count: usize,
    /// True if the point clouds of this topic are the frames.
    pub is_read: bool,
}

/// Contents of a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Contents {
    /// The frames, in the order of time or of their names.
    pub entries: Vec<Entry>,
    /// The topics with point clouds of a recording, or the sensors of a capture, in the order of their names; other
    /// files have none.
    pub topics: Vec<Topic>,
    /// Parts of the file that are skipped or assumed, a sentence each.
    pub notes: Vec<String>,
    /// Damage: truncated or corrupt places of the file and the data lost, one sentence each; not among the notes.
    pub damage: Vec<String>,
    /// The content of a file without frames, and a remedy, as the end of a sentence; else empty.
    pub without_frames: String,
}

impl Contents {
    /// Frames of a file that has no topics.
    pub(super) fn of_entries(entries: Vec<Entry>) -> Self {
        Self {
            entries,
            ..Self::default()
        }
    }
}
