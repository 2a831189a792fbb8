//! A chunk: its kind, length and checksum; found again by its first bytes where the one before it is damaged.

use super::bytes::{ByteReader, ByteWriter};
use crate::reel::error::Fault;

/// Sync marker at the start of every chunk. The first byte begins no UTF-8.
pub(in crate::reel) const SYNC: [u8; 4] = *b"\xf1rlc";

/// Bytes before its contents.
pub(in crate::reel) const CHUNK_HEADER_BYTES: usize = 28;

/// Kind of a chunk's contents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) enum ChunkKind {
    /// Header describing how the file was made.
    Head,
    /// A group of frames.
    Group,
    /// Index of the positions of groups and frames.
    Index,
    /// Something that only later versions know, to be passed over.
    Unknown([u8; 4]),
}

impl ChunkKind {
    fn name(self) -> [u8; 4] {
        match self {
            Self::Head => *b"HEAD",
            Self::Group => *b"GRUP",
            Self::Index => *b"INDX",
            Self::Unknown(name) => name,
        }
    }

    fn of(name: [u8; 4]) -> Self {
        let known = [Self::Head, Self::Group, Self::Index].into_iter();
        known
            .into_iter()
            .find(|kind| kind.name() == name)
            .unwrap_or(Self::Unknown(name))
    }
}

/// Header before the contents of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct ChunkHeader {
    pub(in crate::reel) kind: ChunkKind,
    /// Bytes of the contents.
    pub(in crate::reel) len: u64,
    /// Number of its first bytes checked by `crc`; the rest is checked by sums in those.
    pub(in crate::reel) checked_len: u32,
    pub(in crate::reel) crc: u32,
}

impl ChunkHeader {
    /// Creates the header for contents that begin with the checksummed bytes `checked`.
    pub(in crate::reel) fn new(kind: ChunkKind, checked: &[u8], unchecked_len: u64) -> Self {
        Self {
            kind,
            len: checked.len() as u64 + unchecked_len,
            checked_len: checked.len() as u32,
            crc: crc32fast::hash(checked),
        }
    }

    pub(in crate::reel) fn to_bytes(self) -> Vec<u8> {
        let mut writer = ByteWriter::default();
        writer.bytes.extend(SYNC);
        writer.bytes.extend(self.kind.name());
        writer.bytes.extend(self.len.to_le_bytes());
        writer.u32(self.checked_len);
        writer.u32(self.crc);
        let crc = crc32fast::hash(&writer.bytes);
        writer.u32(crc);
        writer.bytes
    }

    pub(in crate::reel) fn read(bytes: &[u8; CHUNK_HEADER_BYTES]) -> Result<Self, Fault> {
        let [s0, s1, s2, s3, n0, n1, n2, n3, ..] = *bytes;
        if [s0, s1, s2, s3] != SYNC {
            return Err(Fault::new(format!(
                "a chunk begins with {SYNC:02x?}, found were {:02x?}",
                [s0, s1, s2, s3]
            )));
        }
        let mut reader = ByteReader::new(&bytes[8..]);
        let [low, high] = [reader.u32()?, reader.u32()?];
        let header = Self {
            kind: ChunkKind::of([n0, n1, n2, n3]),
            len: u64::from(low) | u64::from(high) << 32,
            checked_len: reader.u32()?,
            crc: reader.u32()?,
        };
        let (expected, found) = (crc32fast::hash(&bytes[..CHUNK_HEADER_BYTES - 4]), reader.u32()?);
        if !is_right(expected, found) {
            return Err(checksum("the header of a chunk", expected, found));
        }
        if u64::from(header.checked_len) > header.len {
            return Err(Fault::new("a chunk is shorter than what of it is checked"));
        }
        Ok(header)
    }

    /// Bytes behind those that are checked.
    pub(in crate::reel) fn unchecked_len(&self) -> u64 {
        self.len - u64::from(self.checked_len)
    }

    /// Verifies the checksum of the first bytes of the contents.
    pub(in crate::reel) fn check(&self, checked: &[u8]) -> Result<(), Fault> {
        match crc32fast::hash(checked) {
            found if is_right(found, self.crc) => Ok(()),
            found => Err(checksum("a chunk", found, self.crc)),
        }
    }
}

/// Returns true if a checksum matches its bytes. Always true when fuzzing, as fuzzers do not guess checksums.
pub(in crate::reel) fn is_right(expected: u32, found: u32) -> bool {
    expected == found || cfg!(fuzzing)
}

/// Bytes that were changed.
pub(in crate::reel) fn checksum(what: &str, expected: u32, found: u32) -> Fault {
    Fault::new(format!(
        "{what} is damaged: its checksum is {found:#010x}, that of its bytes {expected:#010x}"
    ))
}
