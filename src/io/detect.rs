//! The format of a file: its first bytes decide, its extension only where they cannot.
//!
//! The order: first bytes of a format that is read, content of a kind that is not read ([`foreign`]), structure of a
//! format that is read, extension.

use super::codec::Codec;
use super::codecs;
use super::format::Format;
use crate::io::refused::foreign;
use std::path::Path;

/// Extensions of the files that are taken from a folder, without dot, in lower case.
pub fn supported_extensions() -> impl Iterator<Item = &'static str> {
    formats().flat_map(|format| format.extensions().iter().copied())
}

fn formats() -> impl Iterator<Item = Format> {
    codecs().map(|codec| codec.format)
}

impl Format {
    /// The names of all formats, in a sentence.
    pub(super) fn all_names() -> String {
        let names: Vec<String> = formats().map(|format| format.to_string()).collect();
        names.join(", ")
    }

    /// The format of a file with this name and these first bytes.
    pub fn detect(name: &Path, bytes: &[u8]) -> Option<Self> {
        let by_magic = formats().find(|format| format.has_magic(name, bytes));
        if by_magic.is_some() || foreign::by_content(name, bytes).is_some() {
            return by_magic;
        }
        formats()
            .find(|format| format.looks_like(name, bytes))
            .or_else(|| Self::of_extension(name))
    }

    /// The format that the extension of `name` is of.
    pub fn of_extension(name: &Path) -> Option<Self> {
        formats().find(|format| format.has_extension_of(name))
    }

    /// Returns true if rows of this format have named columns, so that normals may be in a separate file.
    pub fn names_columns(self) -> bool {
        self.codec().is_some_and(|codec| codec.columns.is_some())
    }

    /// Its row of the table: there is one for each.
    pub(super) fn codec(self) -> Option<&'static Codec> {
        codecs().find(|codec| codec.format == self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::LengthUnit;

    #[test]
    fn formats_declare_their_units() {
        let of = |name: &str| Format::of_extension(Path::new(name)).and_then(Format::unit);
        for name in ["a.glb", "a.e57", "a.ptx", "000.bin", "a.mcap", "a.bag", "a.db3"] {
            assert_eq!(of(name), Some(LengthUnit::Metre), "{name}");
        }
        for name in ["a.ply", "a.stl", "a.obj", "a.las", "a.npy", "a.zip"] {
            assert_eq!(of(name), None, "{name}");
        }
        let unit = |name: &str, bytes: &[u8]| {
            let cloud = crate::io::read_bytes(Path::new(name), bytes).unwrap();
            cloud.unit
        };
        assert_eq!(unit("a.bin", &1f32.to_le_bytes().repeat(8)), Some(LengthUnit::Metre));
        assert_eq!(unit("a.xyz", b"0 0 0\n1 2 3\n"), None);
    }

    #[test]
    fn first_bytes_override_names() {
        let detect = |name: &str, bytes: &[u8]| Format::detect(Path::new(name), bytes);
        let known = |extension: &str| Format::of_extension(&Path::new("a").with_extension(extension));
        for name in ["a.ply", "a.txt", "a.pcd", "a.las", "a"] {
            assert_eq!(detect(name, b"ply\r\nformat"), known("ply"), "{name}");
            assert_eq!(detect(name, b"# .PCD v.7\n\nVERSION .7\n"), known("pcd"), "{name}");
            assert_eq!(detect(name, b"LASF"), known("las"), "{name}");
        }
        // Text columns have no magic; words that merely start like one are text.
        assert_eq!(detect("a.XYZ", b"1 2 3"), known("xyz"));
        assert_eq!(detect("a.txt", b"plyometrics\n1 2 3"), known("xyz"));
        assert_eq!(detect("a.txt", b"VERSIONS\n"), known("xyz"));
        assert_eq!(detect("a.npz", b"PK\x03\x04"), known("npz"));
        assert_eq!(detect("a.zip", b"PK\x03\x04"), known("zip"));
        for name in ["a.jpg", "a", ".ply"] {
            assert_eq!(detect(name, b"1 2 3"), None, "{name}");
        }
    }
}
