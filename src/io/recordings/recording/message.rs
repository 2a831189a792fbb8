//! Location of a message with a point cloud.

use super::chunk::MessageChunk;
use super::encoding::Encoding;

/// A message with a point cloud.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    pub(super) place: MessagePlace,
    pub(super) encoding: Encoding,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum MessagePlace {
    /// `byte_count` bytes at `offset` in the file.
    File { offset: u64, byte_count: u64 },
    /// Location within an unpacked chunk.
    Chunk {
        chunk: MessageChunk,
        offset: u64,
        byte_count: u64,
    },
    /// The row with this id in the table of messages.
    Row(i64),
}
