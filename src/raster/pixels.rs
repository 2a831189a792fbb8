//! Pixels of images, and how many may be read.

use crate::memory::mebibytes;

/// Maximum pixels along an edge.
pub(super) const MAX_EDGE_PX: u32 = 1 << 15;

/// Memory of a pixel of depth until it is a point: its number, its depth before and after filters, its ray, place,
/// normal and colour, and notes of the filters.
pub(crate) const DEPTH_PIXEL_BYTES: u64 = 96;

/// An image, line by line from the top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Raster {
    pub(crate) size_px: [u32; 2],
    pub(crate) samples: Samples,
}

/// Pixel data by sample format, with one entry per pixel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Samples {
    Gray8(Vec<u8>),
    Gray16(Vec<u16>),
    GrayF32(Vec<f32>),
    Rgb8(Vec<[u8; 3]>),
}

impl Samples {
    /// Returns the human-readable name of the pixel format.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Gray8(_) => "grey of 8 bits",
            Self::Gray16(_) => "grey of 16 bits",
            Self::GrayF32(_) => "grey in single floats",
            Self::Rgb8(_) => "colours",
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Gray8(samples) => samples.len(),
            Self::Gray16(samples) => samples.len(),
            Self::GrayF32(samples) => samples.len(),
            Self::Rgb8(samples) => samples.len(),
        }
    }
}

pub(super) fn checked_size(size_px: [u32; 2]) -> Result<[u32; 2], String> {
    let [width, height] = size_px;
    if size_px.iter().all(|edge| (1..=MAX_EDGE_PX).contains(edge)) {
        return Ok(size_px);
    }
    Err(format!(
        "it claims {width} × {height} pixels, and 1 to {MAX_EDGE_PX} along an edge are read"
    ))
}

pub(super) fn checked_bytes(bytes: u64, max_bytes: u64) -> Result<(), String> {
    if bytes <= max_bytes {
        return Ok(());
    }
    Err(format!(
        "it would take {} of memory, and may take {}: raise --max-memory if the machine has it",
        mebibytes(bytes),
        mebibytes(max_bytes)
    ))
}
