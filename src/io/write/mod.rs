//! Writing clouds to files that other programs read.
//!
//! A cloud is a list of named columns ([`columns`]), which every format writes in its own way. Double precision stays
//! double precision where the format has it. Text has the shortest digits that are read back as the same number.

mod columns;
mod npy;
mod pcd;
mod ply;
mod text;

use super::las;
use crate::cloud::RawCloud;
use std::fmt;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;
use std::str::FromStr;

/// A format that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteFormat {
    /// PLY, little endian: holds all but where the sensor stood.
    PlyBinary,
    /// PLY as text: the same.
    PlyAscii,
    /// PCD 0.7, binary: all but faces.
    Pcd,
    /// LAS.
    Las,
    /// LAS, compressed.
    Laz,
    /// Text with a point a line and the names of the columns in its first: all but faces and the sensor.
    Xyz,
    /// A bare table of numpy: positions, with colours and normals, or with one scalar.
    Npy,
}

/// Formats with their names and extensions; where two have one extension, it means the first.
const FORMATS: [(WriteFormat, &str, &str); 7] = [
    (WriteFormat::PlyBinary, "ply", "ply"),
    (WriteFormat::PlyAscii, "ply-ascii", "ply"),
    (WriteFormat::Pcd, "pcd", "pcd"),
    (WriteFormat::Las, "las", "las"),
    (WriteFormat::Laz, "laz", "laz"),
    (WriteFormat::Xyz, "xyz", "xyz"),
    (WriteFormat::Npy, "npy", "npy"),
];

impl WriteFormat {
    /// The format that the extension of `name` is of.
    pub fn of_extension(name: &Path) -> Option<Self> {
        let extension = name.extension()?.to_str()?.to_ascii_lowercase();
        let found = FORMATS.iter().find(|(_, _, known)| *known == extension);
        found.map(|&(format, _, _)| format)
    }

    /// Extension of its files, without dot.
    pub fn extension(self) -> &'static str {
        let named = FORMATS.iter().find(|(format, _, _)| *format == self);
        named.map_or("", |&(_, _, extension)| extension)
    }
}

impl fmt::Display for WriteFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = FORMATS.iter().find(|(format, _, _)| format == self);
        f.pad(named.map_or("unknown", |(_, name, _)| name))
    }
}

impl FromStr for WriteFormat {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = FORMATS.iter().find(|(_, known, _)| *known == name);
        found.map(|&(format, _, _)| format).ok_or_else(|| {
            let names = FORMATS.map(|(_, name, _)| name).join(", ");
            format!("`{name}` is no format that is written: expected one of {names}")
        })
    }
}

/// Bytes that are collected before the system is asked to write them.
const BUFFER_BYTES: usize = 1 << 20;

/// Writes `cloud` to `out`, as much of it as the format holds.
pub fn write(
    out: impl Write + Seek + Send + Sync,
    format: WriteFormat,
    cloud: &RawCloud,
) -> std::io::Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER_BYTES, out);
    match format {
        WriteFormat::PlyBinary => ply::write(&mut out, cloud, false)?,
        WriteFormat::PlyAscii => ply::write(&mut out, cloud, true)?,
        WriteFormat::Pcd => pcd::write(&mut out, cloud)?,
        WriteFormat::Xyz => text::write(&mut out, cloud)?,
        WriteFormat::Npy => npy::write(&mut out, cloud)?,
        WriteFormat::Las => las::write::write(&mut out, cloud, false)?,
        WriteFormat::Laz => las::write::write(&mut out, cloud, true)?,
    }
    out.flush()
}
