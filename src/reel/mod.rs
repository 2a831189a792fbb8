//! Sequence files: all frames of a 4D scan in one file, a few bits a point, of which any prefix of a frame is a coarser
//! picture.
//!
//! How it works: the frames of a group are divided by one cube. A frame is the octree of its points down to cells about
//! as large as points are far apart (paper 001 §2), written breadth-first: occupancy masks level by level, and the
//! means of attributes for the nodes of every level, each stream for itself. So the first sections of a frame are a
//! coarser frame. Where it is asked for, coordinates follow below the cells, to any precision or to the last bit.
//! Values are foretold by the level above, and coded as symbols by tables that stand ahead. The masks are coded by an
//! adaptive binary range coder; what a bit is expected to be comes from the nodes around that are known already
//! ([`Coding::Compact`]). Or by tables as well, with values that are foretold by their parents alone, which takes a
//! fraction of the time ([`Coding::Fast`]). Frames that are told by the one before are coded bit by bit.
//!
//! ```text
//! clouds ── frame::prepare ─► levels of whole numbers ── tree, attributes ─► streams ── file ─► chunks
//!                                                    ◄── the same functions backwards ──
//! ```
//!
//! Encoder and decoder are one set of functions, generic over the direction (`coder::BitCoder`,
//! `coder::SymbolCoder`); models compute in
//! integers. So the same clouds make the same bytes on every machine and for any number of threads.
//!
//! `docs/reel.md` describes the format for those who want to read it elsewhere.

mod above;
mod attributes;
mod coder;
mod cut;
mod decoder;
mod encode;
mod error;
mod fast;
mod file;
mod frame;
mod memory;
mod options;
mod reader;
#[cfg(test)]
mod tests;
mod tree;
mod writer;

pub use decoder::{DecodedFrame, ReelDecoder};
pub use encode::{EncodedGroup, NewFrame, encode_group};
pub use error::ReelError;
pub use file::{FilePart, ReadAt};
pub use frame::StreamKind;
pub use memory::write_to_memory;
pub use options::{Coding, Precision, ReelOptions};
pub use reader::{FrameInfo, ReelFile};
pub use writer::ReelWriter;

/// How every sequence file begins: a byte that is no text, a name, and line ends that transfers as text would change.
pub const MAGIC: [u8; 8] = *b"\x89reel\r\n\x1a";
