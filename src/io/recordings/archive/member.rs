//! Location of a file within an archive.

use crate::io::files::unpack::Packing;
use std::fmt;
use std::ops::Range;
use std::path::{Component, Path};
use std::sync::Arc;

/// A file within an archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Name within the archive, cleaned: no roots, no parents, no control characters.
    pub(super) name: String,
    pub(super) place: MemberPlace,
}

impl Member {
    /// Bytes of memory that it shares with the other members of an archive which is unpacked as a whole.
    pub(in crate::io) fn shared_bytes(&self) -> usize {
        match &self.place {
            MemberPlace::Memory(unpacked, _) => unpacked.0.capacity(),
            _ => 0,
        }
    }
}

/// Location of a member's bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum MemberPlace {
    /// In the archive's file.
    Packed {
        offset: u64,
        packed_bytes: u64,
        unpacked_bytes: u64,
        packing: Packing,
        crc: Option<u32>,
    },
    /// In the unpacked archive.
    Memory(Unpacked, Range<usize>),
    /// The whole file is this member, packed with gzip.
    Gzip,
    /// Nowhere: why it cannot be read.
    Unreadable(String),
}

/// An unpacked archive. A `Vec`, as converting it to a slice would copy all of it again.
#[derive(Clone)]
pub(super) struct Unpacked(pub(super) Arc<Vec<u8>>);

impl PartialEq for Unpacked {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

impl Eq for Unpacked {}

impl fmt::Debug for Unpacked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} unpacked bytes", self.0.len())
    }
}

/// A name without parts that would lead out of a folder or garble a message.
pub(super) fn clean(name: &str) -> String {
    let name: String = name
        .chars()
        .map(|c| match c {
            // Some writers on Windows use the native separator.
            '\\' => '/',
            c if c.is_control() => '?',
            c => c,
        })
        .collect();
    let parts: Vec<_> = Path::new(&name)
        .components()
        .filter_map(|component| match component {
            Component::Normal(part) => Some(part.to_string_lossy()),
            _ => None,
        })
        .collect();
    parts.join("/")
}
