//! Where one frame comes from, and the decoder that reads it.

use crate::cloud::RawCloud;
use crate::io;
use std::path::PathBuf;

/// Why a decoder failed; its message names the file, the place in it and what was expected.
pub type DecodeFailure = Box<dyn std::error::Error + Send + Sync>;

/// Reads the point cloud of a source, in file coordinates. Called from several threads at once.
pub type Decode = dyn Fn(&Source) -> Result<RawCloud, DecodeFailure> + Send + Sync;

/// Where the bytes of a frame are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// In the file at [`Source::path`].
    File,
    /// In the program; [`Source::path`] is only a name.
    Embedded(&'static [u8]),
}

impl std::fmt::Debug for Content {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File => formatter.write_str("File"),
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
    /// Where the bytes are.
    pub content: Content,
}

impl Source {
    /// The file at `path`.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self::new(path.into(), Content::File)
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
            content,
        }
    }
}

/// The decoder of files and embedded bytes.
pub(super) fn decode(source: &Source) -> Result<RawCloud, DecodeFailure> {
    let decoded = match source.content {
        Content::File => io::read(&source.path),
        Content::Embedded(bytes) => io::read_bytes(&source.path, bytes),
    };
    Ok(decoded?)
}
