//! Matroska files: which tracks they have, what is said of these, and where their frames are (RFC 9559).
//!
//! *How it works.* One walk goes over the heads of elements (RFC 8794: an id, a length, a body), reads the bodies of
//! small ones, and steps over those of frames and of attached files: a recording of gigabytes opens by its heads, and
//! whoever wants a frame reads its bytes alone. The crates for it read the bytes of each frame to come to the next,
//! know no attachments, or refuse a file that was not written to its end.
//!
//! A file that breaks off is read as far as it goes, and says so.

mod element;
mod entries;
mod found;
mod reader;

#[cfg(test)]
mod tests;

pub(crate) use element::is_one;
pub(crate) use found::{Block, Matroska, Track};
