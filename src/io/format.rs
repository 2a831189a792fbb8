//! Which format a file is in: its first bytes decide, its extension only where they cannot.

use crate::cloud::{AxisConvention, LengthUnit};
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
    /// ASPRS LAS, LAZ and COPC.
    Las,
    /// ASTM E57 of laser scanners.
    E57,
    /// Draco.
    Draco,
    /// Text with coordinates in columns.
    Xyz,
    /// Leica PTX: text of scans with poses.
    Ptx,
    /// Wavefront OBJ.
    Obj,
    /// Geomview OFF.
    Off,
    /// Stereolithography: ascii, binary.
    Stl,
    /// glTF and GLB.
    Gltf,
    /// An array of numpy.
    Npy,
    /// Named arrays of numpy.
    Npz,
    /// Bare f32 records of KITTI and nuScenes.
    Bin,
    /// MCAP recording.
    Mcap,
    /// ROS 1 bag.
    Bag,
    /// ROS 2 bag in `SQLite`.
    Db3,
    /// ZIP archive of files of the other formats.
    Zip,
    /// TAR archive, compressed or not.
    Tar,
}

/// Formats with their name for people and their extensions, without dot, in lower case.
const FORMATS: [(Format, &str, &[&str]); 19] = [
    (Format::Ply, "PLY", &["ply"]),
    (Format::Pcd, "PCD", &["pcd"]),
    (Format::Las, "LAS", &["las", "laz"]),
    (Format::E57, "E57", &["e57"]),
    (Format::Draco, "Draco", &["drc"]),
    (Format::Xyz, "text", &["xyz", "txt", "csv", "asc", "pts"]),
    (Format::Ptx, "PTX", &["ptx"]),
    (Format::Obj, "OBJ", &["obj"]),
    (Format::Off, "OFF", &["off"]),
    (Format::Stl, "STL", &["stl"]),
    (Format::Gltf, "glTF", &["gltf", "glb"]),
    (Format::Npy, "NPY", &["npy"]),
    (Format::Npz, "NPZ", &["npz"]),
    (Format::Bin, "KITTI", &["bin"]),
    (Format::Mcap, "MCAP", &["mcap"]),
    (Format::Bag, "ROS bag", &["bag"]),
    (Format::Db3, "ROS 2 bag", &["db3"]),
    (Format::Zip, "ZIP", &["zip"]),
    (Format::Tar, "TAR", &["tar", "tgz", "gz"]),
];

/// Extensions of the files that are taken from a folder, without dot, in lower case.
pub fn supported_extensions() -> impl Iterator<Item = &'static str> {
    FORMATS
        .iter()
        .flat_map(|(_, _, extensions)| extensions.iter().copied())
}

impl Format {
    /// First bytes that are enough for [`Format::detect`].
    pub const MAGIC_BYTES: usize = 4096;

    /// The format of a file with this name and these first bytes.
    pub fn detect(name: &Path, bytes: &[u8]) -> Option<Self> {
        Self::of_magic(name, bytes).or_else(|| Self::of_extension(name))
    }

    /// The format that the extension of `name` is of.
    pub fn of_extension(name: &Path) -> Option<Self> {
        let extension = name.extension()?.to_str()?.to_ascii_lowercase();
        FORMATS
            .iter()
            .find(|(_, _, extensions)| extensions.contains(&extension.as_str()))
            .map(|&(format, _, _)| format)
    }

    /// Which way its axes point, where its specification or the habit of those who write it says so.
    pub(super) fn convention(self) -> Option<AxisConvention> {
        match self {
            Self::Gltf => Some(AxisConvention::YUp),
            Self::Las => Some(AxisConvention::ZUp),
            Self::E57 | Self::Ptx | Self::Bin | Self::Stl => Some(AxisConvention::UsuallyZUp),
            _ => None,
        }
    }

    /// Whether a file of this format may hold more than one frame.
    pub fn holds_many(self) -> bool {
        matches!(self, Self::E57 | Self::Gltf) || self.is_container()
    }

    /// Whether frames lie in a file of this format as whole files or messages: each is read alone, as the file may be
    /// larger than the memory.
    pub fn is_container(self) -> bool {
        matches!(
            self,
            Self::Mcap | Self::Bag | Self::Db3 | Self::Zip | Self::Tar
        )
    }

    /// Whether files of this format are surfaces of which the vertices alone show little.
    pub fn is_for_meshes(self) -> bool {
        matches!(self, Self::Obj | Self::Off | Self::Stl | Self::Gltf)
    }

    /// The unit of coordinates, where all files of this format have the same: ASTM E2807, Leica's PTX, glTF 2.0 (§3.4),
    /// the laser scans of KITTI and nuScenes, and messages of ROS (REP 103) and Foxglove are in metres.
    pub fn unit(self) -> Option<LengthUnit> {
        matches!(
            self,
            Self::E57 | Self::Ptx | Self::Gltf | Self::Bin | Self::Mcap | Self::Bag | Self::Db3
        )
        .then_some(LengthUnit::Metre)
    }

    fn of_magic(name: &Path, bytes: &[u8]) -> Option<Self> {
        const MAGICS: [(&[u8], Format); 15] = [
            (b"ply\n", Format::Ply),
            (b"ply\r", Format::Ply),
            (b"ply ", Format::Ply),
            (b"LASF", Format::Las),
            (b"ASTM-E57", Format::E57),
            (b"DRACO", Format::Draco),
            (b"glTF", Format::Gltf),
            (b"\x93NUMPY", Format::Npy),
            (b"\x89MCAP0\r\n", Format::Mcap),
            (b"#ROSBAG", Format::Bag),
            (b"SQLite format 3\0", Format::Db3),
            (b"PK\x03\x04", Format::Zip),
            (b"PK\x05\x06", Format::Zip),
            (b"\x1f\x8b", Format::Tar),
            (b"OFF\n", Format::Off),
        ];
        /// Where the header of a TAR member says what it is.
        const TAR_MAGIC: std::ops::Range<usize> = 257..262;
        let magic = MAGICS
            .iter()
            .find(|(magic, _)| bytes.starts_with(magic))
            .map(|&(_, format)| format);
        match magic {
            // Numpy's archives are ZIP archives.
            Some(Self::Zip) if Self::of_extension(name) == Some(Self::Npz) => Some(Self::Npz),
            Some(format) => Some(format),
            None if bytes.get(TAR_MAGIC) == Some(b"ustar") => Some(Self::Tar),
            None if looks_like_pcd(bytes) => Some(Self::Pcd),
            None if Self::of_extension(name) == Some(Self::Xyz) && super::ptx::is_ptx(bytes) => {
                Some(Self::Ptx)
            }
            None => None,
        }
    }
}

/// The first line that is no comment begins with VERSION, or with FIELDS as some writers leave VERSION out.
fn looks_like_pcd(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(Format::MAGIC_BYTES)]
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))
        .is_some_and(|line| line.starts_with(b"VERSION ") || line.starts_with(b"FIELDS "))
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = FORMATS.iter().find(|(format, _, _)| format == self);
        f.write_str(named.map_or("unknown", |(_, name, _)| name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_formats_say_of_units() {
        let of = |name: &str| Format::of_extension(Path::new(name)).and_then(Format::unit);
        for name in [
            "a.glb", "a.e57", "a.ptx", "000.bin", "a.mcap", "a.bag", "a.db3",
        ] {
            assert_eq!(of(name), Some(LengthUnit::Metre), "{name}");
        }
        for name in ["a.ply", "a.stl", "a.obj", "a.las", "a.npy", "a.zip"] {
            assert_eq!(of(name), None, "{name}");
        }
        let unit = |name: &str, bytes: &[u8]| {
            let cloud = crate::io::read_bytes(Path::new(name), bytes).unwrap();
            cloud.unit
        };
        assert_eq!(unit("a.bin", &[0; 32]), Some(LengthUnit::Metre));
        assert_eq!(unit("a.xyz", b"0 0 0\n1 2 3\n"), None);
    }

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
            assert_eq!(detect(name, b"LASF"), Some(Format::Las), "{name}");
        }
        // Columns of text have no magic; words that only begin like one are text.
        assert_eq!(detect("a.XYZ", b"1 2 3"), Some(Format::Xyz));
        assert_eq!(detect("a.txt", b"plyometrics\n1 2 3"), Some(Format::Xyz));
        assert_eq!(detect("a.txt", b"VERSIONS\n"), Some(Format::Xyz));
        assert_eq!(detect("a.npz", b"PK\x03\x04"), Some(Format::Npz));
        assert_eq!(detect("a.zip", b"PK\x03\x04"), Some(Format::Zip));
        for name in ["a.jpg", "a", ".ply"] {
            assert_eq!(detect(name, b"1 2 3"), None, "{name}");
        }
    }
}
