//! Ways to keep a frame as points of rate and distortion.

use crate::measure::CloudError;
use crate::reel::ReelOptions;
use image::RgbaImage;

/// Which option of sequence files is changed while the others are the usual ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sweep {
    /// How precisely positions are kept.
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

/// A way to keep a frame, with what it takes and what it loses.
#[derive(Debug, Clone)]
pub struct RatePoint {
    /// Name of the sequence.
    pub sequence: String,
    /// What is changed.
    pub sweep: Sweep,
    /// The choice in a few words.
    pub label: String,
    /// How it was kept.
    pub options: ReelOptions,
    /// Bits of the file, over the points of the original.
    pub bits_per_point: f64,
    /// How far points, colours and normals are from the original.
    pub error: CloudError,
    /// Mean FLIP of the pixels that show the object in its picture or in that of the original, 0 to 1.
    pub flip: f64,
    /// The first view, small.
    pub picture: RgbaImage,
    /// The FLIP error of the first view, as small.
    pub error_map: RgbaImage,
}
