//! Encodings of a frame as points of rate and distortion.

use crate::measure::CloudError;
use crate::reel::ReelOptions;
use image::RgbaImage;

/// Swept option of sequence files, while the others keep their defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sweep {
    /// Precision of stored positions.
    Positions,
    /// Bits of normals.
    Normals,
    /// The error of colours.
    Colors,
}

impl Sweep {
    /// Every option.
    pub const ALL: [Self; 3] = [Self::Positions, Self::Normals, Self::Colors];

    /// A word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Normals => "normals",
            Self::Colors => "colours",
        }
    }
}

/// An encoding of a frame, with its size and its loss.
#[derive(Debug, Clone)]
pub struct RatePoint {
    /// Name of the sequence.
    pub sequence: String,
    /// Swept option.
    pub sweep: Sweep,
    /// The choice in a few words.
    pub label: String,
    /// Options it was stored with.
    pub options: ReelOptions,
    /// Bits of the file, over the points of the original.
    pub bits_per_point: f64,
    /// Error of points, colours and normals against the original.
    pub error: CloudError,
    /// Mean FLIP of the pixels that show the object in its image or in the original's, 0 to 1.
    pub flip: f64,
    /// The first view, small.
    pub picture: RgbaImage,
    /// The FLIP error of the first view, as small.
    pub error_map: RgbaImage,
}
