//! The bytes of `sensor_msgs/Image` as pixels (`sensor_msgs/image_encodings.h`).

use super::messages::RawImage;
use crate::io::raster::{Raster, Samples};

/// The pixels of an image; the error is the end of a sentence.
pub(super) fn raster(image: &RawImage<'_>, most_bytes: u64) -> Result<Raster, String> {
    let [width, height] = image.size_px;
    let pixel_bytes = match image.head.encoding.as_str() {
        "mono8" | "8UC1" => 1,
        "mono16" | "16UC1" => 2,
        "rgb8" | "bgr8" | "8UC3" => 3,
        "rgba8" | "bgra8" | "8UC4" | "32FC1" => 4,
        other => {
            let start: String = other.chars().take(24).collect();
            return Err(format!(
                "its encoding is `{start}`: expected 16UC1, mono16, 32FC1, rgb8, bgr8, rgba8, bgra8 or mono8"
            ));
        }
    };
    let row_bytes = u64::from(width) * pixel_bytes;
    let step = u64::from(image.step).max(u64::from(height == 1) * row_bytes);
    let needed = step
        .saturating_mul(u64::from(height).saturating_sub(1))
        .saturating_add(row_bytes);
    let there = image.data.len() as u64;
    if width == 0 || height == 0 || step < row_bytes || needed > there {
        return Err(format!(
            "{width} × {height} pixels in rows of {} bytes need {needed} bytes, {there} are there",
            image.step
        ));
    }
    // As many bytes as are there, and no more, are made of it.
    if there > most_bytes {
        return Err(format!(
            "it has {there} bytes, and {most_bytes} are read: raise --max-memory if that is right"
        ));
    }
    let rows = image.data.chunks(step as usize).take(height as usize);
    let bytes: Vec<u8> = rows.flat_map(|row| &row[..row_bytes as usize]).copied().collect();
    let samples = match image.head.encoding.as_str() {
        "mono8" | "8UC1" => Samples::Gray8(bytes),
        "mono16" | "16UC1" => Samples::Gray16(numbers(&bytes, image.big_endian, u16::from_le_bytes)),
        "32FC1" => Samples::GrayF32(numbers(&bytes, image.big_endian, f32::from_le_bytes)),
        "rgb8" => Samples::Rgb8(colors(&bytes, 3, [0, 1, 2])),
        "rgba8" => Samples::Rgb8(colors(&bytes, 4, [0, 1, 2])),
        "bgra8" | "8UC4" => Samples::Rgb8(colors(&bytes, 4, [2, 1, 0])),
        // OpenCV's order is that of bgr8.
        _ => Samples::Rgb8(colors(&bytes, 3, [2, 1, 0])),
    };
    Ok(Raster {
        size_px: image.size_px,
        samples,
    })
}

fn numbers<T, const SIZE: usize>(bytes: &[u8], big_endian: bool, number: fn([u8; SIZE]) -> T) -> Vec<T> {
    let in_order = |&(mut raw): &[u8; SIZE]| {
        if big_endian {
            raw.reverse();
        }
        number(raw)
    };
    bytes.as_chunks::<SIZE>().0.iter().map(in_order).collect()
}

/// Red, green and blue, which stand at these places of a pixel.
fn colors(bytes: &[u8], pixel_bytes: usize, places: [usize; 3]) -> Vec<[u8; 3]> {
    let pixels = bytes.chunks_exact(pixel_bytes);
    pixels.map(|pixel| places.map(|place| pixel[place])).collect()
}
