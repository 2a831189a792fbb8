//! Matroska files: their tracks, the metadata of these, and the positions of their frames (RFC 9559).
//!
//! *How it works.* A single pass reads the headers of elements (RFC 8794: an id, a length, a body), reads the bodies of
//! small ones, and skips frames and attached files: a recording of gigabytes is opened by its headers, and reading a
//! frame reads its bytes alone. The available crates read the bytes of each frame to reach the next, do not support
//! attachments, or refuse a truncated file.
//!
//! A truncated file is read as far as it goes, and reports so.

mod element;
mod entries;
mod found;
mod reader;

#[cfg(test)]
mod tests;

pub(crate) use element::is_one;
pub(crate) use found::{Block, Matroska, Track};
