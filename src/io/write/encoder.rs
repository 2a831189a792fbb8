//! Encoder of a file format.

use super::loss::Loss;
use crate::cloud::RawCloud;
use std::io::{Seek, Write};

/// Output sink that a file is written to.
pub(in crate::io) trait WriteSeek: Write + Seek + Send + Sync {}

impl<T: Write + Seek + Send + Sync> WriteSeek for T {}

/// A format that is written, or one of its variants.
pub(in crate::io) struct Encoder {
    /// The word for it on the command line.
    pub(in crate::io) name: &'static str,
    /// Without dot. Where several have one, it means the first.
    pub(in crate::io) extension: &'static str,
    /// Attributes that the format holds in addition to coordinates and opaque colours.
    pub(in crate::io) holds: &'static [Held],
    /// Function that returns the other losses of a cloud, and their amounts.
    pub(in crate::io) lost: fn(&RawCloud) -> Vec<(Loss, f64)>,
    /// Writes as much of a cloud as the format holds.
    pub(in crate::io) write: fn(&mut dyn WriteSeek, &RawCloud) -> std::io::Result<()>,
}

/// Something that a file may hold next to coordinates and opaque colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Held {
    /// Normals.
    Normals,
    /// The alpha of colours.
    Alpha,
    /// Radii of splats.
    Radii,
    /// Ellipses of splats.
    Ellipses,
    /// Scalars of any name.
    Scalars,
    /// Triangles.
    Faces,
    /// Textures of triangles.
    Textures,
    /// Points without coordinates.
    Holes,
    /// Rows and columns of an organised cloud.
    Rows,
    /// The position of the sensor.
    Sensor,
}
