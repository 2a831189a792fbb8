//! Compressed images: PNG and JPEG, and depths as `compressed_depth_image_transport` writes them.
//!
//! Such depths begin with twelve bytes, a word and two single floats. Depths of 16 bits follow as PNG or as RVL; depths
//! of 32 bits as inverse depths n, whose depth is a / (n − b) with these two floats (0 means no measurement).

use super::super::bytes::Bytes;
use super::messages::PackedImage;
use crate::raster::{self, Raster, Samples, rvl};

/// The pixels of an image; the error is the end of a sentence.
pub(super) fn raster(image: &PackedImage<'_>, max_bytes: u64) -> Result<Raster, String> {
    let words = &image.head.encoding;
    if !words.contains("compressedDepth") {
        return raster::decode(image.data, max_bytes);
    }
    let mut bytes = Bytes::new(image.data);
    let mut head = || Some((bytes.u32()?, bytes.f32()?, bytes.f32()?));
    let Some((_kind, a, b)) = head() else {
        return Err("it is shorter than its header of 12 bytes".to_owned());
    };
    let packed = &image.data[bytes.position()..];
    let is_inverse = words.starts_with("32FC1");
    let is_rvl = words.ends_with("rvl");
    let decoded = if is_rvl {
        rvl::decode(packed, max_bytes)?
    } else {
        raster::decode(packed, max_bytes)?
    };
    if !is_inverse {
        return Ok(decoded);
    }
    let Samples::Gray16(codes) = decoded.samples else {
        return Err("inverse depths are grey of 16 bits".to_owned());
    };
    let depth = |code: u16| if code == 0 { f32::NAN } else { a / (f32::from(code) - b) };
    Ok(Raster {
        size_px: decoded.size_px,
        samples: Samples::GrayF32(codes.into_iter().map(depth).collect()),
    })
}
