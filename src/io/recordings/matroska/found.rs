//! Contents found in a Matroska file: tracks, tags, attached files, and the positions of frames.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;
use std::time::Duration;

/// Contents of a Matroska file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Matroska {
    pub(crate) tracks: Vec<Track>,
    pub(crate) tags: Vec<Tag>,
    pub(crate) attachments: Vec<Attachment>,
    /// True if the file is truncated within an element.
    pub(crate) is_truncated: bool,
}

/// A track, with its frames in the order of their times.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Track {
    pub(crate) number: u64,
    pub(crate) uid: u64,
    pub(crate) name: String,
    pub(crate) codec: String,
    /// Codec initialisation data; see [`Track::fourcc`].
    pub(crate) codec_private: Vec<u8>,
    /// Width and height; zeros for a track that is not video.
    pub(crate) size_px: [u32; 2],
    /// True if frames have an additional content encoding: zlib compression, or header stripping of their first bytes.
    pub(crate) is_packed: bool,
    pub(crate) frames: Vec<Block>,
    /// Number of laced blocks, which hold several frames and are skipped.
    pub(crate) laced: usize,
}

/// Something that is said of the file, or of a track.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Tag {
    pub(crate) name: String,
    pub(crate) value: String,
}

/// A file within the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Attachment {
    pub(crate) name: String,
    pub(crate) content: Block,
}

/// Block: the position of the bytes of a frame, and its timestamp.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Block {
    /// Since the first frame; of an attachment 0.
    pub(crate) time: Duration,
    pub(crate) offset: u64,
    pub(crate) byte_count: u64,
}

/// Errors of reading.
#[derive(Debug, thiserror::Error)]
pub(crate) enum MatroskaError {
    /// The system could not read the file.
    #[error("it cannot be read ({0}): check that it exists and its permissions")]
    Io(#[from] std::io::Error),
    /// A file of another kind, or a damaged one.
    #[error("byte {offset}: {problem}")]
    Invalid {
        /// Byte offset of the error.
        offset: u64,
        /// Description of the expected content.
        problem: String,
    },
}

impl Matroska {
    /// The value of the first tag of this name.
    pub(crate) fn tag(&self, name: &str) -> Option<&str> {
        let tag = self.tags.iter().find(|tag| tag.name == name)?;
        Some(&tag.value)
    }
}

impl Track {
    /// The kind of its frames where the codec is a Windows one: `biCompression` of a `BITMAPINFOHEADER`.
    pub(crate) fn fourcc(&self) -> Option<[u8; 4]> {
        let at = self.codec_private.get(16..20)?;
        (self.codec == "V_MS/VFW/FOURCC").then(|| at.try_into().ok())?
    }
}

impl Block {
    /// Its bytes in the file at `path`, no more than `max_bytes`; the error is the end of a sentence.
    pub(crate) fn read(&self, path: &Path, max_bytes: u64) -> Result<Vec<u8>, String> {
        let Self { offset, byte_count, .. } = *self;
        if byte_count > max_bytes {
            return Err(format!(
                "it has {byte_count} bytes, and {max_bytes} are read: raise --max-memory if that is right"
            ));
        }
        let read = || {
            let mut file = File::open(path)?;
            file.seek(SeekFrom::Start(offset))?;
            let mut bytes = Vec::new();
            file.take(byte_count).read_to_end(&mut bytes)?;
            Ok::<_, std::io::Error>(bytes)
        };
        let bytes = read().map_err(|error| format!("the system could not read it ({error})"))?;
        if bytes.len() as u64 != byte_count {
            return Err(format!(
                "{} of its {byte_count} bytes are there: the file has changed since it was opened",
                bytes.len()
            ));
        }
        Ok(bytes)
    }
}
