//! Options of a sequence file: the data stored, and its precision.

use super::error::ReelError;

/// Precision of the stored positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Precision {
    /// Every point, within an eighth of the distance between points around it: a dense part of a scan gets more bits
    /// than a sparse one. Coincident points are all stored.
    PointSpacing,
    /// Cells about as large as points are far apart, one point each (Botsch et al. 2002 §2): points in one cell are
    /// merged into one, with the means of their attributes, and an offset along the normal where there are normals. In
    /// frames that are encoded relative to the previous one, it moves as they do, and is off by another half of a cell
    /// at most.
    SamplingDensity,
    /// One point in each occupied cell of 2ᵇ along the longest side of the group's box: `Bits(10)` are voxels of 10
    /// bits. At most 21.
    Bits(u8),
    /// Every point, no coordinate off by more than this length, in the unit of the file.
    Length(f64),
    /// Every point with the bits that the file has for its coordinates; holes included.
    Lossless,
}

/// Coding method of the stored data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coding {
    /// Geometry in as few bits as the nodes around can save: models that learn, bit by bit.
    Compact,
    /// For machines that have little time: a frame with attributes is decoded six times as fast, geometry alone twelve
    /// times, at up to a half more bits.
    Fast,
}

/// Options that determine the stored data of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct ReelOptions {
    /// Precision of positions.
    pub precision: Precision,
    /// Time against bits.
    pub coding: Coding,
    /// Bits of a normal: 13, 15 or 17, an error of at most 2.5°, 1.3° or 0.7°; or 0 for unchanged numbers, where points
    /// are stored individually.
    pub normal_bits: u8,
    /// True if frames without normals get those that a viewer would estimate, at [`Precision::SamplingDensity`]: from
    /// the centres of cells no viewer could estimate them as well, and points are moved back along them.
    pub estimates_normals: bool,
    /// Maximum error of a colour channel, on every level; 0 is lossless.
    pub color_error: u8,
    /// Bits of a scalar, 2 to 16, between its smallest and its largest value in a group; or 0 for unchanged numbers,
    /// where points are stored individually (16 elsewhere). Radii are within 2.2 %, or unchanged.
    pub scalar_bits: u8,
    /// Bits of the offset of a point along its normal at [`Precision::SamplingDensity`], at most 4; 0 for none.
    pub offset_bits: u8,
    /// Number of frames per group: they share a cube, and damage costs no more than its group. Where points keep their
    /// order from frame to frame, all but the first of a group may be encoded relative to the previous one, so that any
    /// is decoded after those before it.
    pub keyframes: u32,
    /// True if points are returned in the order of the file, as trails need it. Points have to be stored individually
    /// ([`ReelOptions::keeps_points`]).
    pub keep_order: bool,
    /// Frame rate in frames per second, if frames have no timestamps.
    pub fps: Option<f64>,
}

impl Default for ReelOptions {
    fn default() -> Self {
        Self {
            precision: Precision::PointSpacing,
            coding: Coding::Compact,
            normal_bits: 13,
            estimates_normals: false,
            color_error: 2,
            scalar_bits: 8,
            offset_bits: 3,
            keyframes: 10,
            keep_order: false,
            fps: None,
        }
    }
}

impl ReelOptions {
    /// One point in each cell about as large as points are far apart: fewer points and fewer bits.
    pub fn merged() -> Self {
        Self {
            precision: Precision::SamplingDensity,
            ..Self::default()
        }
    }

    /// Every bit of every number.
    pub fn lossless() -> Self {
        Self {
            precision: Precision::Lossless,
            normal_bits: 0,
            color_error: 0,
            scalar_bits: 0,
            ..Self::default()
        }
    }

    /// Returns true if points are stored individually.
    pub fn keeps_points(&self) -> bool {
        !matches!(self.precision, Precision::SamplingDensity | Precision::Bits(_))
    }

    /// Returns true if a frame may be encoded relative to the previous one: not if each is to have cells of its own, or
    /// every bit.
    pub(super) fn may_follow(&self) -> bool {
        matches!(
            self.precision,
            Precision::PointSpacing | Precision::SamplingDensity | Precision::Length(_)
        )
    }

    /// Checks for invalid options.
    pub fn check(&self) -> Result<(), ReelError> {
        let problem = match self.precision {
            Precision::Bits(bits) if !(1..=21).contains(&bits) => Some(format!("{bits} bits: choose 1 to 21")),
            Precision::Length(length) if !(length > 0.0 && length.is_finite()) => {
                Some(format!("a precision of {length}: choose a length above zero"))
            }
            _ if ![0, 13, 15, 17].contains(&self.normal_bits) => {
                Some(format!("{} bits of a normal: choose 13, 15, 17 or 0", self.normal_bits))
            }
            _ if self.scalar_bits == 1 || self.scalar_bits > 16 => {
                Some(format!("{} bits of a scalar: choose 2 to 16, or 0", self.scalar_bits))
            }
            _ if self.offset_bits > 4 => Some(format!("{} bits of an offset: choose 0 to 4", self.offset_bits)),
            _ if self.color_error > 100 => Some(format!("a colour error of {}: choose 0 to 100", self.color_error)),
            _ if self.keyframes == 0 => Some("groups of no frame: choose one or more".to_owned()),
            _ if self.keep_order && !self.keeps_points() => Some(
                "the order of points that are merged: keep every point, by their spacing, a length, or lossless"
                    .to_owned(),
            ),
            _ => None,
        };
        problem.map_or(Ok(()), |problem| Err(ReelError::Options { problem }))
    }
}
