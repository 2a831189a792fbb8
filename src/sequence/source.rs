//! Where one frame comes from, and the decoder that reads it.

use crate::cloud::RawCloud;
use crate::io::normals::read_with_normals;
use crate::io::{self, Part, ReadOptions};
use crate::progress::Progress;
use std::path::PathBuf;
use std::time::Duration;

/// Why a decoder failed; its message names the file, the place in it and what was expected.
pub type DecodeFailure = Box<dyn std::error::Error + Send + Sync>;

/// Reads the point cloud of a source, in file coordinates, and tells how far it is. Called from several threads at once. What it
/// returns after it was cancelled is not looked at.
pub type Decode = dyn Fn(&Source, &Progress) -> Result<RawCloud, DecodeFailure> + Send + Sync;

/// Reads at most so many points of a source that has at least as many as the second number says, without reading the others, and says how
/// many it has; `None` where that cannot be done.
pub(super) type Sample =
    dyn Fn(&Source, usize, usize) -> Result<Option<(RawCloud, usize)>, DecodeFailure> + Send + Sync;

/// Where the bytes of a frame are.
#[derive(Clone, PartialEq, Eq)]
pub enum Content {
    /// In the file at [`Source::path`], which may hold others too.
    File(Part),
    /// In the program; [`Source::path`] is only a name.
    Embedded(&'static [u8]),
}

impl std::fmt::Debug for Content {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(part) => write!(formatter, "File({part:?})"),
            Self::Embedded(bytes) => write!(formatter, "Embedded({} bytes)", bytes.len()),
        }
    }
}

/// One frame of a sequence, not read yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file, as the person gave it or as its folder lists it.
    pub path: PathBuf,
    /// File name for people; bytes that are not UTF-8 are replaced.
    pub name: String,
    /// The number in the name that counts the frames, where there is one: gaps in time can be seen in it.
    pub number: Option<u64>,
    /// When it was taken, since whatever moment its file or its name counts from.
    pub time: Option<Duration>,
    /// Where the bytes are.
    pub content: Content,
    /// A file beside it with the normals of its points, which the file itself need not have.
    pub normals: Option<PathBuf>,
}

impl Source {
    /// The file at `path`.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self::new(path.into(), Content::File(Part::Whole))
    }

    /// A frame of a file that holds several.
    pub(super) fn entry(path: impl Into<PathBuf>, entry: io::Entry) -> Self {
        let mut source = Self::new(path.into(), Content::File(entry.part));
        if !entry.name.is_empty() {
            source.name = format!("{}: {}", source.name, entry.name);
        }
        source.time = entry.time;
        source
    }

    /// Bytes in the program, under a name whose extension tells their format where their first bytes do not.
    pub fn embedded(name: impl Into<PathBuf>, bytes: &'static [u8]) -> Self {
        Self::new(name.into(), Content::Embedded(bytes))
    }

    fn new(path: PathBuf, content: Content) -> Self {
        let name = path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        );
        Self {
            path,
            name,
            number: None,
            time: None,
            content,
            normals: None,
        }
    }
}

/// A disk that has to look for every point of a sample would take longer for them than for all: then there is none.
const MOST_SAMPLE_TIME: Duration = Duration::from_secs(1);

/// The [`Sample`] of files.
pub(super) fn sample(
    source: &Source,
    most_points: usize,
    fewest_points: usize,
) -> Result<Option<(RawCloud, usize)>, DecodeFailure> {
    match (&source.content, &source.normals) {
        (Content::File(Part::Whole), None) => Ok(io::read_sample(
            &source.path,
            most_points,
            fewest_points,
            MOST_SAMPLE_TIME,
        )?),
        _ => Ok(None),
    }
}

/// The decoder of files and embedded bytes.
pub(super) fn decode(
    source: &Source,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, DecodeFailure> {
    let decoded = match (&source.content, &source.normals) {
        (Content::File(Part::Whole), Some(normals)) => {
            read_with_normals(&source.path, normals, options, progress)
        }
        (Content::File(part), _) => io::read_part_observed(&source.path, part, options, progress),
        (Content::Embedded(bytes), _) => io::read_bytes(&source.path, bytes),
    };
    Ok(decoded?)
}
