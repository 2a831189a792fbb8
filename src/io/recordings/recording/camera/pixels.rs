//! The bytes of `sensor_msgs/Image` as pixels (`sensor_msgs/image_encodings.h`).

use super::bayer::Mosaic;
use super::messages::RawImage;
use super::yuv::Yuv;
use crate::raster::{Raster, Samples};

/// Pixel format of an image.
#[derive(Debug, Clone, Copy)]
enum Pixels {
    Gray8,
    Gray16,
    GrayF32,
    /// Bytes per pixel, and the offsets of red, green and blue.
    Colors(u64, [usize; 3]),
    Yuv(Yuv),
    Mosaic(Mosaic),
}

impl Pixels {
    fn of(encoding: &str) -> Result<Self, String> {
        // `librealsense` writes some of them in upper case.
        let name = encoding.to_ascii_lowercase();
        Ok(match name.as_str() {
            "mono8" | "8uc1" => Self::Gray8,
            "mono16" | "16uc1" => Self::Gray16,
            "32fc1" => Self::GrayF32,
            "rgb8" => Self::Colors(3, [0, 1, 2]),
            // OpenCV's channel order is the one of bgr8.
            "bgr8" | "8uc3" => Self::Colors(3, [2, 1, 0]),
            "rgba8" => Self::Colors(4, [0, 1, 2]),
            "bgra8" | "8uc4" => Self::Colors(4, [2, 1, 0]),
            _ => {
                let yuv = Yuv::of(&name).map(Self::Yuv);
                let found = yuv.or_else(|| Mosaic::of(&name).map(Self::Mosaic));
                let start: String = encoding.chars().take(24).collect();
                return found.ok_or_else(|| {
                    format!(
                        "its encoding is `{start}`: expected 16UC1, mono16, 32FC1, rgb8, bgr8, rgba8, bgra8, mono8, \
                         yuv422, uyvy, yuyv, nv12, nv21 or bayer_rggb8 and its like"
                    )
                });
            }
        })
    }

    /// Bytes of a line for each of its pixels.
    fn pixel_bytes(self) -> u64 {
        match self {
            Self::Gray8 => 1,
            Self::Gray16 => 2,
            Self::GrayF32 => 4,
            Self::Colors(bytes, _) => bytes,
            Self::Yuv(yuv) => yuv.pixel_bytes(),
            Self::Mosaic(mosaic) => mosaic.sample_bytes,
        }
    }

    /// Lines of an image of height `height`.
    fn lines(self, height: u32) -> u64 {
        match self {
            Self::Yuv(yuv) => yuv.lines(height),
            _ => height.into(),
        }
    }
}

/// Bytes of a row without gaps; the error is the end of a sentence.
pub(super) fn row_bytes(encoding: &str, width: u32) -> Result<u32, String> {
    let bytes = u64::from(width) * Pixels::of(encoding)?.pixel_bytes();
    u32::try_from(bytes).map_err(|_| format!("it claims to be {width} pixels wide"))
}

/// The pixels of an image; the error is the end of a sentence.
pub(super) fn raster(image: &RawImage<'_>, max_bytes: u64) -> Result<Raster, String> {
    let [width, height] = image.size_px;
    let pixels = Pixels::of(&image.head.encoding)?;
    if matches!(pixels, Pixels::Yuv(_)) && !width.is_multiple_of(2) {
        return Err(format!(
            "it is {width} pixels wide, and two of its pixels share their colour: expected an even number"
        ));
    }
    let row_bytes = u64::from(width) * pixels.pixel_bytes();
    let lines = pixels.lines(height);
    let step = u64::from(image.step).max(u64::from(lines == 1) * row_bytes);
    let needed = step.saturating_mul(lines.saturating_sub(1)).saturating_add(row_bytes);
    let there = image.data.len() as u64;
    if width == 0 || height == 0 || step < row_bytes || needed > there {
        return Err(format!(
            "{width} × {height} pixels in rows of {} bytes need {needed} bytes, {there} are there",
            image.step
        ));
    }
    // The decoded image takes the bytes of the message, or three times that.
    if there > max_bytes {
        return Err(format!(
            "it has {there} bytes, and {max_bytes} are read: raise --max-memory if that is right"
        ));
    }
    let rows = image.data.chunks(step as usize).take(lines as usize);
    let bytes: Vec<u8> = rows.flat_map(|row| &row[..row_bytes as usize]).copied().collect();
    let samples = match pixels {
        Pixels::Gray8 => Samples::Gray8(bytes),
        Pixels::Gray16 => Samples::Gray16(numbers(&bytes, image.big_endian, u16::from_le_bytes)),
        Pixels::GrayF32 => Samples::GrayF32(numbers(&bytes, image.big_endian, f32::from_le_bytes)),
        Pixels::Colors(pixel_bytes, places) => Samples::Rgb8(colors(&bytes, pixel_bytes as usize, places)),
        Pixels::Yuv(yuv) => Samples::Rgb8(yuv.colors(&bytes, image.size_px)),
        Pixels::Mosaic(mosaic) => {
            let samples = if mosaic.sample_bytes == 1 {
                bytes
            } else {
                let samples = numbers(&bytes, image.big_endian, u16::from_le_bytes);
                samples.into_iter().map(|sample| (sample >> 8) as u8).collect()
            };
            Samples::Rgb8(mosaic.colors(&samples, image.size_px))
        }
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

/// Red, green and blue, at these positions of a pixel.
fn colors(bytes: &[u8], pixel_bytes: usize, places: [usize; 3]) -> Vec<[u8; 3]> {
    let pixels = bytes.chunks_exact(pixel_bytes);
    pixels.map(|pixel| places.map(|place| pixel[place])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::messages::ImageHead;
    use super::*;

    fn decoded(encoding: &str, size_px: [u32; 2], step: u32, data: &[u8]) -> Result<Raster, String> {
        let image = RawImage {
            head: ImageHead {
                frame_id: String::new(),
                encoding: encoding.to_owned(),
            },
            size_px,
            big_endian: true,
            step,
            data,
        };
        raster(&image, 1000)
    }

    #[test]
    fn images_need_the_bytes_of_all_their_rows() {
        for (encoding, size_px, step, needed) in [
            ("16UC1", [4, 2], 10, 18),
            ("uyvy", [4, 3], 8, 24),
            ("nv12", [4, 4], 6, 34),
            // The last line of chroma covers only one line of luma.
            ("NV21", [2, 3], 2, 10),
            ("bayer_bggr16", [3, 3], 6, 18),
            ("rgb8", [5, 1], 0, 15),
        ] {
            let data = vec![77; needed];
            assert!(decoded(encoding, size_px, step, &data).is_ok(), "{encoding}");
            let error = decoded(encoding, size_px, step, &data[1..]).unwrap_err();
            assert!(error.contains(&format!("need {needed} bytes")), "{encoding}: {error}");
        }
    }

    #[test]
    fn invalid_images_are_rejected_with_a_reason() {
        for (encoding, size_px, step, expected) in [
            ("yuyv", [3, 2], 6, "3 pixels wide"),
            ("nv12", [1, 2], 1, "1 pixels wide"),
            ("rgb8", [0, 2], 0, "0 × 2 pixels"),
            ("rgb8", [2, 0], 6, "2 × 0 pixels"),
            ("rgb8", [4, 2], 11, "rows of 11 bytes"),
            ("bayer_rggb8", [u32::MAX, u32::MAX], u32::MAX, "need"),
            ("nv12", [u32::MAX - 1, u32::MAX], u32::MAX, "need"),
            ("cmyk", [1, 1], 4, "`cmyk`"),
        ] {
            let error = decoded(encoding, size_px, step, &[0; 64]).unwrap_err();
            assert!(error.contains(expected), "{encoding}: {error}");
        }
        assert!(
            decoded("mono8", [1, 1], 1, &[0; 1001])
                .unwrap_err()
                .contains("--max-memory")
        );
        assert!(row_bytes("bgra8", u32::MAX).is_err());
        assert_eq!(row_bytes("nv12", 64), Ok(64));
    }
}
