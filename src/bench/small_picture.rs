//! Images scaled down for reports and the window.

use image::RgbaImage;
use image::imageops::{FilterType, resize};

/// Their width, pixels.
const WIDTH_PX: u32 = 240;

/// Scales an image down, unless it is small.
pub(super) fn small(image: &RgbaImage) -> RgbaImage {
    let (width, height) = image.dimensions();
    let small_width = WIDTH_PX.min(width);
    let small_height = (u64::from(height) * u64::from(small_width) / u64::from(width.max(1))).max(1);
    resize(image, small_width, small_height as u32, FilterType::Triangle)
}
