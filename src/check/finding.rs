//! Finding of a rule.

use serde::Serialize;

/// Kind of finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FindingKind {
    /// Numbers are missing between the names of two frames.
    NumberGap,
    /// Time stamps that do not grow, or a pause between two of them.
    TimeJump,
    /// A frame cannot be read.
    UnreadableFrame,
    /// A part of a frame's file cannot be read, but its points can.
    UnreadablePart,
    /// Something that the file has and nothing is made of.
    UnreadProperties,
    /// A sequence file, recording, capture or archive that ends early or is damaged.
    DamagedFile,
    /// A frame without a point.
    EmptyFrame,
    /// A frame does not have the attributes of the others.
    ChangedAttributes,
    /// Coordinates that are NaN or infinite.
    NonFinitePoints,
    /// No-data points.
    NoDataPoints,
    /// Points at exactly the same place.
    DuplicatePoints,
    /// The cloud jumps, or its size does.
    BoundsJump,
    /// Colours of 8 bits in fields of 16.
    NarrowColors,
    /// Normals of no length.
    ZeroNormals,
    /// Extents that speak of another unit, or coordinates that lose digits.
    SuspiciousScale,
    /// Frames that look as if another axis was up.
    ChangedUpAxis,
    /// An image whose camera does not fit the points that were found in it.
    LooseCamera,
    /// Radii of splats that are infinite or far larger than the cloud.
    AbsurdRadii,
    /// Frames that another camera took than the first ones.
    ChangedCamera,
}

/// Weight of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Good to know; the sequence is shown as it is meant.
    Note,
    /// Something may be shown otherwise than it is meant.
    Warning,
    /// Something cannot be shown.
    Error,
}

impl Severity {
    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

impl FindingKind {
    /// Weight of findings of this kind.
    pub fn severity(self) -> Severity {
        match self {
            Self::UnreadableFrame | Self::DamagedFile => Severity::Error,
            // Scanners write holes, several returns at one position, and classes without colour; missing attributes are
            // estimated.
            Self::NonFinitePoints
            | Self::DuplicatePoints
            | Self::ZeroNormals
            | Self::NarrowColors
            | Self::UnreadProperties => Severity::Note,
            Self::NumberGap
            | Self::TimeJump
            | Self::UnreadablePart
            | Self::EmptyFrame
            | Self::ChangedAttributes
            | Self::NoDataPoints
            | Self::BoundsJump
            | Self::SuspiciousScale
            | Self::ChangedUpAxis
            | Self::LooseCamera
            | Self::AbsurdRadii
            | Self::ChangedCamera => Severity::Warning,
        }
    }
}

/// A problem that the user should check.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Finding {
    /// Kind of the finding.
    pub kind: FindingKind,
    /// Its weight.
    pub severity: Severity,
    /// Indices of the frames in which it is.
    pub frames: Vec<usize>,
    /// Message that states the finding and the remedy, in one sentence.
    pub message: String,
}
