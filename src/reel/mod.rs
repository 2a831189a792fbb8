//! Sequence files: all frames of a 4D scan in one file, at a few bits per point, in which any prefix of a frame is a
//! coarser version of it.
//!
//! How it works: the frames of a group are divided by one cube. A frame is the octree of its points down to cells about
//! as large as points are far apart (Botsch et al. 2002 §2), written breadth-first: occupancy masks level by level, and
//! the means of attributes for the nodes of every level, each in a stream of its own. So the first sections of a frame
//! are a coarser frame. On request, coordinates follow below the cells, to any precision or to the last bit. Values are
//! predicted from the level above, and coded as symbols by tables stored up front. The masks are coded by an adaptive
//! binary range coder; the expected value of a bit comes from the surrounding nodes that are known already
//! ([`Coding::Compact`]). Alternatively masks are coded by tables as well, with values that are predicted from their
//! parents alone, which takes a fraction of the time ([`Coding::Fast`]). Frames that are encoded relative to the
//! previous one are coded bit by bit.
//!
//! ```text
//! clouds ── frame::prepare ─► levels of whole numbers ── tree, attributes ─► streams ── file ─► chunks
//!                                                    ◄── the same functions backwards ──
//! ```
//!
//! Encoder and decoder are one set of functions, generic over the direction (`coder::BitCoder`, `coder::SymbolCoder`);
//! models compute in integers. So the same clouds produce the same bytes on every machine and for any number of
//! threads.
//!
//! `docs/reel.md` describes the format for those who want to read it elsewhere.

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
mod parent_level;
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

/// Magic bytes of every sequence file: a byte that is not text, a name, and line ends that text-mode transfers would
/// change.
pub const MAGIC: [u8; 8] = *b"\x89reel\r\n\x1a";
