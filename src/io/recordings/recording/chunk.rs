//! Chunks: locations of many messages that are packed together.

use crate::io::files::unpack::{Packing, unpack};
use crate::io::options::ReadOptions;
use std::io::{Read as _, SeekFrom};

/// Location of a chunk in which many messages are packed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MessageChunk {
    pub(super) offset: u64,
    pub(super) packed_bytes: u64,
    pub(super) unpacked_bytes: u64,
    pub(super) packing: Packing,
    /// Zero where there is none.
    pub(super) crc: u32,
}

impl MessageChunk {
    /// The chunk's bytes; the error is a sentence without its place.
    pub(super) fn unpack(
        &self,
        file: &mut (impl std::io::Read + std::io::Seek),
        options: &ReadOptions,
    ) -> Result<Vec<u8>, String> {
        file.seek(SeekFrom::Start(self.offset))
            .map_err(|error| error.to_string())?;
        let bytes = unpack(
            self.packing,
            file.by_ref().take(self.packed_bytes),
            self.unpacked_bytes,
            options,
        )
        .map_err(|problem| format!("the chunk: {problem}"))?;
        if self.crc != 0 && crc32fast::hash(&bytes) != self.crc {
            return Err("the chunk's checksum is wrong: it is damaged".to_owned());
        }
        Ok(bytes)
    }
}
