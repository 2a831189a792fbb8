//! Images as cameras record them: distances in 16 bits or in floats, and colours.
//!
//! PNG, JPEG, PNM, WebP and others are read by `image`, TIFF by `tiff` (which has single floats, where `image` refuses
//! them), arrays of numpy by `arrays.rs`, the images of PCL's grabbers by `pclzf.rs`. [`rvl`] packs distances alone and
//! has no signature: the caller has to know the format.
//!
//! Nothing here reads files: recordings, streams and files of other programs hand over bytes.

mod arrays;
mod lzf;
mod pclzf;
mod pixels;
pub(crate) mod rvl;

pub(crate) use arrays::members_of_npz;
pub(crate) use lzf::unpack_lzf;
pub(crate) use pixels::{DEPTH_PIXEL_BYTES, Raster, Samples};

use crate::memory::mebibytes;
use image::{DynamicImage, ImageError, ImageReader, Limits};
use pixels::{MAX_EDGE_PX, checked_size};
use std::io::Cursor;

/// The image in `bytes`, which takes no more than `max_bytes`.
///
/// # Errors
/// The problem, as the end of a sentence.
pub(crate) fn decode(bytes: &[u8], max_bytes: u64) -> Result<Raster, String> {
    let raster = if bytes.starts_with(pclzf::MAGIC) {
        pclzf::decode(bytes, max_bytes)?
    } else if bytes.starts_with(arrays::NPY) {
        arrays::decode_npy(bytes, max_bytes)?
    } else if bytes.starts_with(arrays::NPZ) {
        arrays::decode_npz(bytes, max_bytes)?
    } else if is_tiff(bytes) {
        decode_tiff(bytes, max_bytes)?
    } else {
        decode_usual(bytes, max_bytes)?
    };
    let [width, height] = raster.size_px;
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels != raster.samples.len() as u64 {
        return Err(format!("it has {} of {width} × {height} pixels", raster.samples.len()));
    }
    Ok(raster)
}

/// Width and height of the image in `bytes`, read from its head only.
///
/// # Errors
/// As [`decode`].
pub(crate) fn size_px(bytes: &[u8]) -> Result<[u32; 2], String> {
    if bytes.starts_with(pclzf::MAGIC) {
        return pclzf::size_px(bytes);
    }
    if bytes.starts_with(arrays::NPY) {
        return arrays::npy_size_px(bytes);
    }
    if bytes.starts_with(arrays::NPZ) {
        return arrays::npz_size_px(bytes);
    }
    let size = if is_tiff(bytes) {
        tiff::decoder::Decoder::new(Cursor::new(bytes))
            .and_then(|mut decoder| decoder.dimensions())
            .map_err(|error| error.to_string())
    } else {
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let reader = reader.map_err(|error| error.to_string())?;
        reader.into_dimensions().map_err(|error| error.to_string())
    };
    let (width, height) = size?;
    checked_size([width, height])
}

fn decode_usual(bytes: &[u8], max_bytes: u64) -> Result<Raster, String> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|error| error.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE_PX);
    limits.max_image_height = Some(MAX_EDGE_PX);
    // Colours of other types exist both as decoded pixels and as converted ones.
    limits.max_alloc = Some(max_bytes / 2);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| match error {
        ImageError::Limits(_) => format!(
            "its pixels are more than there may be in {} of memory: raise --max-memory if the machine has it",
            mebibytes(max_bytes)
        ),
        error => error.to_string(),
    })?;
    let size_px = [image.width(), image.height()];
    let samples = match image {
        DynamicImage::ImageLuma8(image) => Samples::Gray8(image.into_raw()),
        DynamicImage::ImageLuma16(image) => Samples::Gray16(image.into_raw()),
        other => Samples::Rgb8(triples(&other.into_rgb8().into_raw())),
    };
    Ok(Raster { size_px, samples })
}

fn triples(bytes: &[u8]) -> Vec<[u8; 3]> {
    bytes.as_chunks().0.to_vec()
}

fn is_tiff(bytes: &[u8]) -> bool {
    bytes.starts_with(b"II*\0") || bytes.starts_with(b"MM\0*")
}

fn decode_tiff(bytes: &[u8], max_bytes: u64) -> Result<Raster, String> {
    use tiff::ColorType;
    use tiff::decoder::{Decoder, DecodingResult, Limits};
    let max = usize::try_from(max_bytes).unwrap_or(usize::MAX);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = max;
    limits.intermediate_buffer_size = max;
    let text = |error: tiff::TiffError| error.to_string();
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(text)?.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(text)?;
    let size_px = checked_size([width, height])?;
    let color = decoder.colortype().map_err(text)?;
    let samples = match (color, decoder.read_image().map_err(text)?) {
        (ColorType::Gray(8), DecodingResult::U8(samples)) => Samples::Gray8(samples),
        (ColorType::Gray(16), DecodingResult::U16(samples)) => Samples::Gray16(samples),
        (ColorType::Gray(32), DecodingResult::F32(samples)) => Samples::GrayF32(samples),
        (ColorType::RGB(8), DecodingResult::U8(samples)) => Samples::Rgb8(triples(&samples)),
        (ColorType::RGBA(8), DecodingResult::U8(samples)) => {
            let pixels = samples.as_chunks::<4>().0.iter();
            Samples::Rgb8(pixels.map(|&[r, g, b, _]| [r, g, b]).collect())
        }
        (color, _) => {
            return Err(format!(
                "its pixels are {color:?}: expected grey of 8 or 16 bits or in single floats, or colours of 8 bits"
            ));
        }
    };
    Ok(Raster { size_px, samples })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, ImageFormat, Luma, Rgb};

    fn written(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn pclzf(kind: &str, size: [u32; 2], unpacked: &[u8]) -> Vec<u8> {
        let mut packed = vec![0; lzf_rust::max_compressed_size(unpacked.len())];
        let count = lzf_rust::compress(unpacked, &mut packed).unwrap();
        packed.truncate(count);
        let mut bytes = super::pclzf::MAGIC.to_vec();
        bytes.extend(size.into_iter().flat_map(u32::to_le_bytes));
        bytes.extend(format!("{kind:16}").into_bytes());
        bytes.extend((packed.len() as u32).to_le_bytes());
        bytes.extend((unpacked.len() as u32).to_le_bytes());
        bytes.extend(packed);
        bytes
    }

    fn ramp() -> Vec<u16> {
        (0..64 * 32).map(|at| (at / 3) * 3).collect()
    }

    fn gray16() -> DynamicImage {
        DynamicImage::ImageLuma16(ImageBuffer::<Luma<u16>, _>::from_raw(64, 32, ramp()).unwrap())
    }

    #[test]
    fn distances_are_the_same_in_every_format() {
        let expected = Raster {
            size_px: [64, 32],
            samples: Samples::Gray16(ramp()),
        };
        let mut tiff = Cursor::new(Vec::new());
        let mut encoder = tiff::encoder::TiffEncoder::new(&mut tiff).unwrap();
        encoder
            .write_image::<tiff::encoder::colortype::Gray16>(64, 32, &ramp())
            .unwrap();
        let unpacked: Vec<u8> = ramp().into_iter().flat_map(u16::to_le_bytes).collect();
        for bytes in [
            written(&gray16(), ImageFormat::Png),
            written(&gray16(), ImageFormat::Pnm),
            tiff.into_inner(),
            pclzf("depth16", [64, 32], &unpacked),
        ] {
            assert_eq!(decode(&bytes, 1 << 20).as_ref(), Ok(&expected));
            assert_eq!(size_px(&bytes), Ok([64, 32]));
            for end in [0, 4, 20, bytes.len() / 2, bytes.len() - 9] {
                assert!(
                    decode(&bytes[..end], 1 << 20).is_err(),
                    "{end} of {} bytes",
                    bytes.len()
                );
            }
            assert!(decode(&bytes, 1000).is_err());
        }
    }

    #[test]
    fn floats_of_tiff_stay_floats() {
        let floats: Vec<f32> = (0..12).map(|at| at as f32 * 0.1).collect();
        let mut tiff = Cursor::new(Vec::new());
        let mut encoder = tiff::encoder::TiffEncoder::new(&mut tiff).unwrap();
        encoder
            .write_image::<tiff::encoder::colortype::Gray32Float>(4, 3, &floats)
            .unwrap();
        let raster = decode(&tiff.into_inner(), 1 << 20).unwrap();
        assert_eq!(raster.samples, Samples::GrayF32(floats));
    }

    #[test]
    fn color_planes_become_pixels() {
        let pixels: Vec<[u8; 3]> = (0..64).map(|at| [at, 100, 255 - at]).collect();
        let planes: Vec<u8> = (0..3)
            .flat_map(|channel| pixels.iter().map(move |pixel| pixel[channel]))
            .collect();
        let raster = decode(&pclzf("rgb24", [8, 8], &planes), 1 << 20).unwrap();
        assert_eq!(raster.samples, Samples::Rgb8(pixels.clone()));
        let image = ImageBuffer::<Rgb<u8>, _>::from_raw(8, 8, pixels.concat()).unwrap();
        let png = written(&DynamicImage::ImageRgb8(image), ImageFormat::Png);
        assert_eq!(decode(&png, 1 << 20).unwrap().samples, Samples::Rgb8(pixels));
        // Grey has no chroma.
        let gray: Vec<u8> = [[128; 32].as_slice(), &[77; 64], &[128; 32]].concat();
        let raster = decode(&pclzf("yuv422", [8, 8], &gray), 1 << 20).unwrap();
        assert_eq!(raster.samples, Samples::Rgb8(vec![[77; 3]; 64]));
    }

    #[test]
    fn declared_sizes_alone_take_no_memory() {
        let mut bytes = pclzf("depth16", [8, 8], &[0; 128]);
        bytes[5..9].copy_from_slice(&30_000_u32.to_le_bytes());
        bytes[9..13].copy_from_slice(&30_000_u32.to_le_bytes());
        bytes[33..37].copy_from_slice(&1_800_000_000_u32.to_le_bytes());
        assert!(decode(&bytes, u64::MAX).unwrap_err().contains("claims"));
        bytes[5..9].copy_from_slice(&4_000_000_u32.to_le_bytes());
        assert!(size_px(&bytes).unwrap_err().contains("4000000 × 30000"));
        let mut png = written(&gray16(), ImageFormat::Png);
        png[16..20].copy_from_slice(&2_000_000_000_u32.to_be_bytes());
        assert!(decode(&png, 1 << 30).is_err());
    }
}
