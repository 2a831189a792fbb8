//! Hashes of texts, for names of files and to know a text again.

use sha2::{Digest, Sha256};
use std::fmt::Write as _;

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
    let mut text = String::new();
    for byte in &Sha256::digest(bytes)[..16] {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}
