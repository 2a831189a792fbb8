//! An image as received, unpacked when its pixels are needed.

use super::error::WireError;
use crate::raster::{self, Raster, Samples, rvl};
use std::ops::Range;
use std::sync::Arc;

/// An image within the payload of a message.
#[derive(Clone)]
pub struct PackedImage {
    payload: Arc<Vec<u8>>,
    bytes: Range<usize>,
    size_px: [u32; 2],
    packing: Packing,
}

/// Packing of pixels into bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    /// Grey image with 16 bits per pixel.
    Gray16,
    /// A single float a pixel.
    GrayF32,
    /// RVL, with width and height before it.
    Rvl,
    /// Red, green and blue of 8 bits.
    Rgb8,
    /// JPEG.
    Jpeg,
}

impl Packing {
    /// Bytes of a pixel, if all take the same number.
    fn pixel_bytes(self) -> Option<u64> {
        match self {
            Self::Gray16 => Some(2),
            Self::GrayF32 => Some(4),
            Self::Rgb8 => Some(3),
            Self::Rvl | Self::Jpeg => None,
        }
    }
}

impl PackedImage {
    /// The image in these bytes of `payload`; `what` names it in errors. Precondition: they are within the payload.
    pub(super) fn new(
        payload: Arc<Vec<u8>>,
        bytes: Range<usize>,
        size_px: [u32; 2],
        packing: Packing,
        what: &'static str,
    ) -> Result<Self, WireError> {
        let [width, height] = size_px;
        let expected = packing
            .pixel_bytes()
            .map(|bytes| bytes * u64::from(width) * u64::from(height));
        if expected.is_some_and(|expected| expected != bytes.len() as u64) {
            let reason = format!("{} bytes for {width} × {height} pixels of {packing:?}", bytes.len());
            return Err(WireError::malformed(what, reason));
        }
        Ok(Self {
            payload,
            bytes,
            size_px,
            packing,
        })
    }

    /// Width and height.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Bytes that it has as it came.
    pub fn byte_size(&self) -> usize {
        self.bytes.len()
    }

    /// Its bytes, if it is a JPEG.
    pub(crate) fn jpeg(&self) -> Option<&[u8]> {
        (self.packing == Packing::Jpeg).then(|| &self.payload[self.bytes.clone()])
    }

    /// Its pixels, which take no more than `max_bytes`; the error is the end of a sentence.
    pub(crate) fn raster(&self, max_bytes: u64) -> Result<Raster, String> {
        let bytes = &self.payload[self.bytes.clone()];
        let samples = match self.packing {
            Packing::Gray16 => {
                let samples = bytes.as_chunks().0.iter();
                Samples::Gray16(samples.map(|&sample| u16::from_le_bytes(sample)).collect())
            }
            Packing::GrayF32 => Samples::GrayF32(super::bytes::f32s(bytes)),
            Packing::Rgb8 => Samples::Rgb8(bytes.as_chunks().0.to_vec()),
            Packing::Rvl => return self.of_its_size(rvl::decode(bytes, max_bytes)?),
            Packing::Jpeg => {
                // The size is checked before anything is unpacked.
                let size_px = raster::size_px(bytes)?;
                self.check_size(size_px)?;
                return self.of_its_size(raster::decode(bytes, max_bytes)?);
            }
        };
        Ok(Raster {
            size_px: self.size_px,
            samples,
        })
    }

    fn of_its_size(&self, raster: Raster) -> Result<Raster, String> {
        self.check_size(raster.size_px)?;
        Ok(raster)
    }

    fn check_size(&self, found: [u32; 2]) -> Result<(), String> {
        if found == self.size_px {
            return Ok(());
        }
        let ([width, height], [claimed_width, claimed_height]) = (found, self.size_px);
        Err(format!(
            "it has {width} × {height} pixels, and the frame says {claimed_width} × {claimed_height}"
        ))
    }
}

impl std::fmt::Debug for PackedImage {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [width, height] = self.size_px;
        write!(
            formatter,
            "{:?} {width} × {height} in {} bytes",
            self.packing,
            self.bytes.len()
        )
    }
}
