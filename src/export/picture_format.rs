//! Formats of still images, and their encoding.

use super::limits::MAX_EDGE_PX;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder as _, RgbaImage};
use std::fmt;
use std::io::{Error, Seek, Write};
use tiff::encoder::colortype::{RGB8, RGBA8};
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder};
use tiff::tags::ExtraSamples;

/// File format of a still image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Lossless, with alpha; written row by row, whatever the size.
    Png,
    /// Small, nearly the same colours, opaque.
    Jpeg,
    /// Lossless, with alpha.
    Webp,
    /// Lossless, with alpha.
    Tiff,
}

/// Naming of a format.
pub(super) struct Row {
    pub(super) format: PictureFormat,
    pub(super) name: &'static str,
    pub(super) extensions: &'static [&'static str],
    pub(super) max_edge_px: u32,
}

/// One row per format; its first extension is the usual one.
pub(super) const FORMATS: [Row; 4] = [
    row(PictureFormat::Png, "PNG", &["png"], MAX_EDGE_PX),
    // These formats are held in memory as a whole while they are encoded.
    row(PictureFormat::Jpeg, "JPEG", &["jpg", "jpeg"], 16_384),
    row(PictureFormat::Webp, "WebP", &["webp"], 16_383),
    row(PictureFormat::Tiff, "TIFF", &["tif", "tiff"], 16_384),
];

const fn row(format: PictureFormat, name: &'static str, extensions: &'static [&'static str], max_edge_px: u32) -> Row {
    Row {
        format,
        name,
        extensions,
        max_edge_px,
    }
}

/// Quality of JPEG: no blocks are seen around edges.
const JPEG_QUALITY: u8 = 95;

impl PictureFormat {
    /// Every extension that is written, without dot.
    pub fn extensions() -> impl Iterator<Item = &'static str> {
        FORMATS.iter().flat_map(|row| row.extensions).copied()
    }

    /// Name and extensions of each, for dialogs.
    pub fn filters() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
        FORMATS.iter().map(|row| (row.name, row.extensions))
    }

    /// Returns true if the format supports transparency.
    pub fn has_alpha(self) -> bool {
        self != Self::Jpeg
    }

    pub(super) fn row(self) -> &'static Row {
        // A test ensures that every format has its row.
        FORMATS.iter().find(|row| row.format == self).unwrap_or(&FORMATS[0])
    }
}

impl fmt::Display for PictureFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.row().name)
    }
}

/// Writes `image`; JPEG without its alpha.
///
/// # Errors
/// Failures to write, and sizes that the format cannot hold.
pub fn encode_picture(format: PictureFormat, image: &RgbaImage, out: impl Write + Seek) -> std::io::Result<()> {
    let (width, height) = image.dimensions();
    let is_opaque = image.pixels().all(|pixel| pixel[3] == u8::MAX);
    match format {
        PictureFormat::Png => PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(image, width, height, ExtendedColorType::Rgba8)
            .map_err(Error::other),
        PictureFormat::Jpeg => JpegEncoder::new_with_quality(out, JPEG_QUALITY)
            .write_image(&opaque(image), width, height, ExtendedColorType::Rgb8)
            .map_err(Error::other),
        PictureFormat::Webp if is_opaque => WebPEncoder::new_lossless(out)
            .write_image(&opaque(image), width, height, ExtendedColorType::Rgb8)
            .map_err(Error::other),
        PictureFormat::Webp => WebPEncoder::new_lossless(out)
            .write_image(image, width, height, ExtendedColorType::Rgba8)
            .map_err(Error::other),
        PictureFormat::Tiff => encode_tiff(image, is_opaque, out).map_err(Error::other),
    }
}

fn encode_tiff(image: &RgbaImage, is_opaque: bool, out: impl Write + Seek) -> tiff::TiffResult<()> {
    let (width, height) = image.dimensions();
    let mut encoder = TiffEncoder::new(out)?.with_compression(Compression::Deflate(DeflateLevel::Balanced));
    if is_opaque {
        return encoder.write_image::<RGB8>(width, height, &opaque(image));
    }
    let mut picture = encoder.new_image::<RGBA8>(width, height)?;
    // Straight alpha, as drawn; without the tag readers assume premultiplied alpha.
    picture.encoder().write_tag(
        tiff::tags::Tag::ExtraSamples,
        &[ExtraSamples::UnassociatedAlpha.to_u16()][..],
    )?;
    picture.write_data(image)
}

/// The colours alone.
fn opaque(image: &RgbaImage) -> Vec<u8> {
    image
        .pixels()
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn formats_match_table_rows_in_order() {
        for (place, row) in FORMATS.iter().enumerate() {
            assert_eq!(row.format as usize, place, "{}", row.name);
        }
    }

    #[test]
    fn images_round_trip() {
        let pixel = |x: u32, y: u32, alpha: u8| image::Rgba([10 * x as u8, 20 * y as u8, 90, alpha]);
        let solid = RgbaImage::from_fn(20, 10, |x, y| pixel(x, y, 255));
        let soft = RgbaImage::from_fn(20, 10, |x, y| pixel(x, y, 10 + 12 * x as u8));
        for row in &FORMATS {
            for image in [&solid, &soft] {
                let mut file = Cursor::new(Vec::new());
                encode_picture(row.format, image, &mut file).unwrap();
                let bytes = file.into_inner();
                let read = if row.format == PictureFormat::Tiff {
                    read_tiff(&bytes)
                } else {
                    let guessed = image::guess_format(&bytes).unwrap();
                    assert_eq!(guessed, image::ImageFormat::from_extension(row.extensions[0]).unwrap());
                    image::load_from_memory(&bytes).unwrap().to_rgba8()
                };
                if row.format.has_alpha() {
                    assert_eq!(&read, image, "{}", row.name);
                } else {
                    let off = read.pixels().zip(image.pixels());
                    let max = off.flat_map(|(a, b)| (0..3).map(move |c| a[c].abs_diff(b[c]))).max();
                    assert!(max < Some(24), "{max:?}");
                }
            }
        }
    }

    fn read_tiff(bytes: &[u8]) -> RgbaImage {
        let mut decoder = tiff::decoder::Decoder::new(Cursor::new(bytes)).unwrap();
        let (width, height) = decoder.dimensions().unwrap();
        let tiff::decoder::DecodingResult::U8(values) = decoder.read_image().unwrap() else {
            panic!("not 8 bits");
        };
        let channels = values.len() / (width * height) as usize;
        let pixels = values.chunks(channels).flat_map(|pixel| {
            let alpha = pixel.get(3).copied().unwrap_or(255);
            [pixel[0], pixel[1], pixel[2], alpha]
        });
        RgbaImage::from_raw(width, height, pixels.collect()).unwrap()
    }
}
