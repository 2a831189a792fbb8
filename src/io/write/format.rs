//! The formats that are written, by their names.

use super::encoder::Encoder;
use super::loss::Losses;
use super::losses::losses;
use crate::cloud::RawCloud;
use crate::io::codecs;
use std::fmt;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;
use std::str::FromStr;

/// A format that is written. Two are equal when their names are.
#[derive(Clone, Copy)]
pub struct WriteFormat(&'static Encoder);

impl WriteFormat {
    /// Every format that is written.
    pub fn all() -> impl Iterator<Item = Self> {
        let encoders = codecs().flat_map(|codec| codec.encoders);
        encoders.map(|encoder| Self(encoder))
    }

    /// The format that the extension of `name` is of.
    pub fn of_extension(name: &Path) -> Option<Self> {
        let extension = name.extension()?.to_str()?.to_ascii_lowercase();
        Self::all().find(|format| format.extension() == extension)
    }

    /// Returns the losses of `cloud` in this format: everything that it cannot hold.
    pub fn losses(self, cloud: &RawCloud) -> Losses {
        losses(self.0, cloud)
    }

    /// The names of all, with commas between.
    pub fn names() -> String {
        let names: Vec<&str> = Self::all().map(|format| format.0.name).collect();
        names.join(", ")
    }

    /// Extension of its files, without dot.
    pub fn extension(self) -> &'static str {
        self.0.extension
    }
}

impl Default for WriteFormat {
    /// Binary PLY.
    fn default() -> Self {
        Self(super::ply::BINARY)
    }
}

impl PartialEq for WriteFormat {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for WriteFormat {}

impl fmt::Debug for WriteFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

impl fmt::Display for WriteFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.0.name)
    }
}

impl FromStr for WriteFormat {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::all().find(|format| format.0.name == name);
        found.ok_or_else(|| {
            let names = Self::names();
            format!("`{name}` is not a format that is written: expected one of {names}")
        })
    }
}

/// Bytes that are collected before the system is asked to write them.
const BUFFER_BYTES: usize = 1 << 20;

/// Writes `cloud` to `out`, as much of it as the format holds.
pub fn write(out: impl Write + Seek + Send + Sync, format: WriteFormat, cloud: &RawCloud) -> std::io::Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER_BYTES, out);
    (format.0.write)(&mut out, cloud)?;
    out.flush()
}
