//! Images on meshes.

use image::{ImageError, ImageReader, Limits, RgbaImage};
use std::io::Cursor;

/// Most pixels along an edge.
const MAX_EDGE_PX: u32 = 1 << 15;

/// The image in the bytes of a file, which takes no more than `max_bytes`; it is not empty.
pub(in crate::io) fn decode(bytes: &[u8], max_bytes: u64) -> Result<RgbaImage, ImageError> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE_PX);
    limits.max_image_height = Some(MAX_EDGE_PX);
    limits.max_alloc = Some(max_bytes.min(limits.max_alloc.unwrap_or(u64::MAX)));
    reader.limits(limits);
    let picture = reader.decode()?.into_rgba8();
    if picture.is_empty() {
        return Err(std::io::Error::other("the picture has no pixels").into());
    }
    Ok(picture)
}
