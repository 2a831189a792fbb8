//! The file: chunks with checksums, directories of groups, and an index.

mod bytes;
mod chunk;
mod directory;
mod head;
mod index;
mod part;
mod read_at;
mod validate;

pub(super) use bytes::{ByteReader, ByteWriter};
pub(super) use chunk::{CHUNK_HEADER_BYTES, ChunkHeader, ChunkKind, SYNC};
pub(super) use chunk::{checksum, is_right};
pub(super) use directory::{Directory, FrameCut, FrameRecord, SectionRecord, StreamRecord};
pub(super) use head::{Head, MAGIC_AND_VERSION_BYTES, VERSION};
pub(super) use index::{Index, TRAILER_BYTES, Trailer};
pub use part::FilePart;
pub use read_at::ReadAt;
pub(super) use read_at::bytes_at;
