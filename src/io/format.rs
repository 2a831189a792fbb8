//! Which format a file is in: its first bytes decide, its extension only where they cannot.

use std::fmt;
use std::path::Path;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Stanford polygon file: ascii, little and big endian.
    Ply,
    /// Point Cloud Library: ascii, binary, compressed.
    Pcd,
    /// Text with coordinates in columns.
    Xyz,
}

/// Extensions of the files that are taken from a folder, without dot, in lower case.
pub fn supported_extensions() -> &'static [&'static str] {
    &["ply", "pcd", "xyz", "txt", "csv", "asc", "pts"]
}

impl Format {
    /// The format of a file with this name and these first bytes.
    pub fn detect(name: &Path, bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") || bytes.starts_with(b"ply ")
        {
            return Some(Self::Ply);
        }
        if looks_like_pcd(bytes) {
            return Some(Self::Pcd);
        }
        let extension = name.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            // A wrong magic is a fault of the file, said by its decoder.
            "ply" => Some(Self::Ply),
            "pcd" => Some(Self::Pcd),
            other => supported_extensions().contains(&other).then_some(Self::Xyz),
        }
    }
}

/// The first line that is no comment begins with VERSION, or with FIELDS as some writers leave VERSION out.
fn looks_like_pcd(bytes: &[u8]) -> bool {
    /// Comments may come first, but not for long.
    const SEARCHED_BYTES: usize = 4096;
    bytes[..bytes.len().min(SEARCHED_BYTES)]
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))
        .is_some_and(|line| line.starts_with(b"VERSION ") || line.starts_with(b"FIELDS "))
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ply => "PLY",
            Self::Pcd => "PCD",
            Self::Xyz => "text",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_bytes_count_more_than_names() {
        let detect = |name: &str, bytes: &[u8]| Format::detect(Path::new(name), bytes);
        for name in ["a.ply", "a.txt", "a.pcd", "a.las", "a"] {
            assert_eq!(detect(name, b"ply\r\nformat"), Some(Format::Ply), "{name}");
            assert_eq!(
                detect(name, b"# .PCD v.7\n\nVERSION .7\n"),
                Some(Format::Pcd),
                "{name}"
            );
        }
        // Columns of text have no magic; words that only begin like one are text.
        assert_eq!(detect("a.XYZ", b"1 2 3"), Some(Format::Xyz));
        assert_eq!(detect("a.txt", b"plyometrics\n1 2 3"), Some(Format::Xyz));
        assert_eq!(detect("a.txt", b"VERSIONS\n"), Some(Format::Xyz));
        for name in ["a.las", "a.e57", "a.glb", "a", ".ply"] {
            assert_eq!(detect(name, b"LASF"), None, "{name}");
        }
    }
}
