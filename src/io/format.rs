//! Traits of a format that are known before a file of it is read.

use crate::cloud::{AxisConvention, LengthUnit};
use std::fmt;
use std::path::Path;

/// A format that is read. Two are equal when their names are.
#[derive(Clone, Copy)]
pub struct Format(&'static Traits);

/// Traits common to all files of a format.
pub(super) struct Traits {
    /// For people.
    pub(super) name: &'static str,
    /// Without dot, in lower case.
    pub(super) extensions: &'static [&'static str],
    /// Magic bytes that identify a file whatever its name; any of them is enough.
    pub(super) magic: &'static [Magic],
    /// True if its magic is shared with another format, so that it counts only with its own extension.
    pub(super) needs_extension: bool,
    /// Detection function: returns true if a file without a magic, of this name and with these first bytes, is of the
    /// format.
    pub(super) looks_like: Option<fn(&Path, &[u8]) -> bool>,
    /// Axis convention of the format, if its specification or common practice defines one.
    pub(super) convention: Option<AxisConvention>,
    /// The unit of coordinates, where all files have the same.
    pub(super) unit: Option<LengthUnit>,
    pub(super) holds: Holding,
    /// True if files are surfaces (meshes) whose vertices alone show little.
    pub(super) is_for_meshes: bool,
    /// True if timestamp lists accompany folders of such files.
    pub(super) has_time_sidecar: bool,
}

/// Kinds of contents that a file of a format may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holding {
    /// One cloud.
    Cloud,
    /// Scans, which together are a cloud as well.
    Scans,
    /// Time steps of an animation.
    TimeSteps,
    /// Layers of an array.
    Layers,
    /// Rows of text, possibly of several frames.
    Blocks,
    /// Files, messages or packets, some of which form a frame.
    Parts,
}

/// Bytes that a file has at a place.
#[derive(Debug)]
pub(super) struct Magic {
    pub(super) offset: usize,
    pub(super) bytes: &'static [u8],
}

impl Magic {
    /// Returns magic bytes at the start of a file.
    pub(super) const fn start(bytes: &'static [u8]) -> Self {
        Self { offset: 0, bytes }
    }

    /// Returns true if a file that begins with `bytes` has this magic.
    pub(super) fn is_in(&self, bytes: &[u8]) -> bool {
        let there = bytes.get(self.offset..);
        there.is_some_and(|there| there.starts_with(self.bytes))
    }
}

impl Traits {
    /// One cloud per file, without further properties.
    pub(super) const PLAIN: Self = Self {
        name: "",
        extensions: &[],
        magic: &[],
        needs_extension: false,
        looks_like: None,
        convention: None,
        unit: None,
        holds: Holding::Cloud,
        is_for_meshes: false,
        has_time_sidecar: false,
    };
}

impl Format {
    /// First bytes that are enough to know a file by.
    pub const MAGIC_BYTES: usize = 4096;

    pub(super) const fn new(traits: &'static Traits) -> Self {
        Self(traits)
    }

    /// Extensions of its files, without dot, in lower case.
    pub(super) fn extensions(self) -> &'static [&'static str] {
        self.0.extensions
    }

    /// Returns true if a file of this name has an extension of the format.
    pub(super) fn has_extension_of(self, name: &Path) -> bool {
        let extension = name.extension().and_then(|extension| extension.to_str());
        let is = |extension: &str| {
            let known = self.0.extensions.iter();
            known.copied().any(|known| extension.eq_ignore_ascii_case(known))
        };
        extension.is_some_and(is)
    }

    /// Returns true if a file of this name that begins with `bytes` has the magic of the format.
    pub(super) fn has_magic(self, name: &Path, bytes: &[u8]) -> bool {
        let is_meant = !self.0.needs_extension || self.has_extension_of(name);
        is_meant && self.0.magic.iter().any(|magic| magic.is_in(bytes))
    }

    /// Returns true if a file without a magic, of this name and with these first bytes, is of the format.
    pub(super) fn looks_like(self, name: &Path, bytes: &[u8]) -> bool {
        self.0.looks_like.is_some_and(|is| is(name, bytes))
    }

    /// Returns the axis convention of the format, if its specification or common practice defines one.
    pub(super) fn convention(self) -> Option<AxisConvention> {
        self.0.convention
    }

    /// Returns true if a file of this format may hold more than one frame.
    pub fn holds_many(self) -> bool {
        self.0.holds != Holding::Cloud
    }

    /// Returns true for text formats, whose files nearly always are one frame and have to be read to know.
    pub fn is_rarely_many(self) -> bool {
        self.0.holds == Holding::Blocks
    }

    /// Returns true if a file of this format may hold several scans that are one cloud together.
    pub fn holds_scans(self) -> bool {
        self.0.holds == Holding::Scans
    }

    /// Returns true for container formats, in which frames are stored as whole files, messages or packets: each is read
    /// alone, as the file may be larger than the memory.
    pub fn is_container(self) -> bool {
        self.0.holds == Holding::Parts
    }

    /// Returns true for mesh formats, whose files are surfaces whose vertices alone show little.
    pub fn is_for_meshes(self) -> bool {
        self.0.is_for_meshes
    }

    /// Returns true if timestamp lists accompany folders of such files.
    pub fn has_time_sidecar(self) -> bool {
        self.0.has_time_sidecar
    }

    /// The unit of coordinates, where all files of this format have the same: ASTM E2807, Leica's PTX, glTF 2.0 (§3.4),
    /// the laser scans of KITTI and nuScenes, and messages of ROS (REP 103) and Foxglove are in metres.
    pub fn unit(self) -> Option<LengthUnit> {
        self.0.unit
    }
}

impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for Format {}

impl fmt::Debug for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}
