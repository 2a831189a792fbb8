//! Errors of reading a file: its name, the position, the expectation and the remedy.

use super::format::Format;
use crate::io::options::ReadOptions;
use crate::io::refused::foreign::{self, Foreign};
pub(super) use crate::memory::mebibytes;
use std::fmt;
use std::path::{Path, PathBuf};

/// Errors of reading a cloud.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The system could not read the file.
    #[error("{} cannot be read ({source}): check that it exists and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file that is larger than the memory that may be used.
    #[error(
        "{} has {} and may take {} of memory: raise --max-memory if the machine has it",
        path.display(), mebibytes(*length), mebibytes(*allowed)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its bytes.
        length: u64,
        /// Bytes that it may take.
        allowed: u64,
    },
    /// A folder, pipe or device.
    #[error("{} is {kind}, not a regular file: name a file, or a folder of frames as the input", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
        /// Kind of file system entry, with its article.
        kind: &'static str,
    },
    /// A file without a byte.
    #[error("{} is empty (0 bytes), expected a point cloud: the file may not have been written to its \
        end", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A kind of file that is known and not read.
    #[error("{} is {kind}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Its name, the programs that write it, and how to convert it.
        kind: &'static Foreign,
    },
    /// Neither the first bytes nor the extension are of a format that is read.
    #[error(
        "{} is not in a format that pointreel reads ({formats}): convert it to one of them",
        path.display()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The names of those that are read.
        formats: String,
    },
    /// Somebody cancelled it.
    #[error("{} was not read to its end, as that was cancelled: open it again to read it", path.display())]
    Cancelled {
        /// The file.
        path: PathBuf,
    },
    /// An archive or recording without a point cloud.
    #[error("{} holds no point cloud ({format} file): {holds}", path.display())]
    NoFrame {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// Its content, and a remedy.
        holds: String,
    },
    /// A file whose frames could not be listed when it was opened, and can be now.
    #[error(
        "{} has {count} frames, which could not be listed when it was opened: open it again",
        path.display()
    )]
    NotListed {
        /// The file.
        path: PathBuf,
        /// Frames that it has.
        count: usize,
    },
    /// The file breaks the rules of its format.
    #[error("{}, {place}: {problem} ({format} file)", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// Position in the file.
        place: Place,
        /// Description of the found and the expected content.
        problem: String,
    },
}

/// Position of an error in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Somewhere in the header.
    Header,
    /// A line, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Byte(usize),
    /// An entry of a list of points or elements, counted from 0.
    Entry {
        /// Name of the list's items, such as `vertex`.
        list: String,
        /// Index of the entry.
        index: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header => write!(f, "header"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Entry { list, index } => write!(f, "{list} {index}"),
        }
    }
}

impl IoError {
    /// The file at `path` begins with `bytes` and is in no format that is read.
    pub(super) fn unknown(path: &Path, bytes: &[u8]) -> Self {
        let path = path.to_owned();
        match foreign::recognise(&path, bytes) {
            Some(kind) => Self::Foreign { path, kind },
            None => Self::UnknownFormat {
                path,
                formats: Format::all_names(),
            },
        }
    }
}

/// Decoder error; [`super::read_bytes`] adds the file.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) place: Place,
    pub(super) problem: String,
    /// Not a fault: the read was cancelled.
    is_cancelled: bool,
}

impl Fault {
    /// Returns the error at the same position, but with the problem of the whole list, if it has one.
    pub(super) fn explained_by(self, claim: Result<(), Self>) -> Self {
        match claim {
            Err(claim) if !self.is_cancelled => Self {
                problem: claim.problem,
                ..self
            },
            _ => self,
        }
    }

    pub(super) fn new(place: Place, problem: impl Into<String>) -> Self {
        Self {
            place,
            problem: problem.into(),
            is_cancelled: false,
        }
    }

    /// Converts the error to an [`IoError`] with the file it is in.
    pub(super) fn of(self, path: &Path, format: Format) -> IoError {
        if self.is_cancelled {
            let path = path.to_owned();
            return IoError::Cancelled { path };
        }
        IoError::Invalid {
            path: path.to_owned(),
            format,
            place: self.place,
            problem: self.problem,
        }
    }

    /// `needed` bytes that are, with those held already, more than `options` allow.
    pub(super) fn too_large(what: &str, needed: u64, options: &ReadOptions) -> Self {
        Self::header(format!(
            "{what} would take {} or more of memory, and may take {}: raise --max-memory if the machine has it",
            mebibytes(needed.saturating_add(options.held_bytes)),
            mebibytes(options.max_memory_bytes)
        ))
    }

    /// Returns the error of a cancelled decoder.
    pub(super) fn cancelled() -> Self {
        Self {
            is_cancelled: true,
            ..Self::header("cancelled")
        }
    }

    pub(super) fn header(problem: impl Into<String>) -> Self {
        Self::new(Place::Header, problem)
    }

    pub(super) fn entry(list: &str, index: usize, problem: impl Into<String>) -> Self {
        Self::new(
            Place::Entry {
                list: list.to_owned(),
                index,
            },
            problem,
        )
    }
}
