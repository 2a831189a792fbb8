//! The name of a scalar field, which is copied like a number.

use std::fmt;

/// Bytes that a name may have: LAS has 32 at most, the longest common names about as many.
const MAX_BYTES: usize = 63;

/// The beginning of a field's name: 63 bytes at most, which distinguish the fields of a file. It holds its text, so
/// files with many or long names leave nothing behind.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct FieldName {
    bytes: [u8; MAX_BYTES],
    len: u8,
}

impl FieldName {
    /// The name, or as much of it as fits.
    pub fn new(name: &str) -> Self {
        let len = name.floor_char_boundary(MAX_BYTES);
        let mut bytes = [0; MAX_BYTES];
        bytes[..len].copy_from_slice(&name.as_bytes()[..len]);
        Self { bytes, len: len as u8 }
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        // Only valid text is ever stored, so nothing is lost.
        std::str::from_utf8(&self.bytes[..usize::from(self.len)]).unwrap_or_default()
    }

    /// Returns true if a field of this name is meant. Case does not matter, nor the prefix that `CloudCompare` writes.
    pub fn names(&self, field: &str) -> bool {
        let field = Self::new(field);
        plain(self.as_str()).eq_ignore_ascii_case(plain(field.as_str()))
    }
}

/// `name` without the prefix that `CloudCompare` writes.
pub fn plain(name: &str) -> &str {
    match name.split_at_checked("scalar_".len()) {
        Some((before, after)) if before.eq_ignore_ascii_case("scalar_") && !after.is_empty() => after,
        _ => name,
    }
}

impl fmt::Debug for FieldName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_str().fmt(formatter)
    }
}

impl fmt::Display for FieldName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn case_and_prefix_do_not_matter() {
        let name = FieldName::new("Intensity");
        assert_eq!(name.as_str(), "Intensity");
        for field in ["intensity", "scalar_Intensity", "SCALAR_INTENSITY"] {
            assert!(name.names(field), "{field}");
        }
        assert!(!name.names("intensity2") && !name.names(""));
        assert!(FieldName::new("scalar_").names("scalar_"));
        assert!(!FieldName::new("scalar_").names(""));
    }

    proptest! {
        #[test]
        fn any_text_is_truncated_at_a_character_boundary(text in ".{0,80}") {
            let name = FieldName::new(&text);
            prop_assert!(text.starts_with(name.as_str()));
            prop_assert!(name.as_str() == text || name.as_str().len() > MAX_BYTES - 4);
            prop_assert!(name.names(&text));
            prop_assert_eq!(FieldName::new(name.as_str()), name);
        }
    }
}
