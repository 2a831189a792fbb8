//! Hashes of texts, for names of files and to know a text again.

use crate::binary::hex;
use sha2::{Digest, Sha256};

/// Hash of the text of a session.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TextHash(String);

impl TextHash {
    pub(super) fn of(text: &[u8]) -> Self {
        Self(hex_hash(text))
    }

    /// Its digits.
    pub(super) fn text(&self) -> &str {
        &self.0
    }
}

/// The first half of the SHA-256, in hexadecimal digits.
pub(super) fn hex_hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes)[..16])
}
