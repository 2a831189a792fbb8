//! One frame as its source knows it before it is read.

use crate::io::{self, Part};
use crate::printable;
use glam::DAffine3;
use std::path::PathBuf;
use std::time::Duration;

/// Location of the bytes of a frame.
#[derive(Clone, PartialEq, Eq)]
pub enum FrameBytes {
    /// In the file at [`FrameEntry::path`], which may hold others too.
    File(Part),
    /// In the program; [`FrameEntry::path`] is only a name.
    Embedded(&'static [u8]),
}

impl FrameBytes {
    /// Bytes in the program; none of a file.
    pub(super) fn embedded(&self) -> &'static [u8] {
        match self {
            Self::File(_) => &[],
            Self::Embedded(bytes) => bytes,
        }
    }
}

impl std::fmt::Debug for FrameBytes {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(part) => write!(formatter, "File({part:?})"),
            Self::Embedded(bytes) => write!(formatter, "Embedded({} bytes)", bytes.len()),
        }
    }
}

/// One frame of a source, not read yet.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameEntry {
    /// The file, as the person gave it or as its folder lists it.
    pub path: PathBuf,
    /// File name for people; bytes that are not UTF-8 are replaced, and control characters escaped.
    pub name: String,
    /// The number in the name that counts the frames, where there is one: gaps in time can be seen in it.
    pub number: Option<u64>,
    /// Timestamp of the frame, relative to the epoch of its file or its name.
    pub time: Option<Duration>,
    /// Location of the frame's bytes.
    pub content: FrameBytes,
    /// Companion file with the normals of the frame's points, which the frame's own file may lack.
    pub normals: Option<PathBuf>,
    /// The rigid pose that moves the points of the file into the coordinates of the sequence, if they are not in these.
    pub pose: Option<DAffine3>,
}

impl FrameEntry {
    /// The file at `path`.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self::new(path.into(), FrameBytes::File(Part::Whole))
    }

    /// The file at `path`, which may hold several frames.
    pub(super) fn unlisted(path: impl Into<PathBuf>) -> Self {
        Self::new(path.into(), FrameBytes::File(Part::Sole))
    }

    /// Returns true if the frame is an entire file, as far as is known.
    pub(super) fn is_file(&self) -> bool {
        matches!(self.content, FrameBytes::File(Part::Whole | Part::Sole))
    }

    /// A frame of a file that holds several.
    pub(super) fn entry(path: impl Into<PathBuf>, entry: io::Entry) -> Self {
        let mut frame = Self::new(path.into(), FrameBytes::File(entry.part));
        if !entry.name.is_empty() {
            frame.name = format!("{}: {}", frame.name, printable::name(entry.name));
        }
        frame.time = entry.time;
        frame
    }

    /// Bytes in the program, under a name whose extension identifies their format if their first bytes do not.
    pub fn embedded(name: impl Into<PathBuf>, bytes: &'static [u8]) -> Self {
        Self::new(name.into(), FrameBytes::Embedded(bytes))
    }

    fn new(path: PathBuf, content: FrameBytes) -> Self {
        let name = path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        );
        Self {
            path,
            name: printable::name(name),
            number: None,
            time: None,
            content,
            normals: None,
            pose: None,
        }
    }
}
