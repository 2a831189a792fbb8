//! Image files, identified by their first bytes.

use crate::photos::error::PhotosError;
use image::{DynamicImage, ImageError, ImageReader};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The pixels of an image.
///
/// # Errors
/// An error if the file cannot be read, or is not an image.
pub(in crate::photos) fn decode(path: &Path) -> Result<DynamicImage, PhotosError> {
    open(path)?.decode().map_err(|source| no_picture(path, source))
}

/// Width and height of an image, from its header; EXIF orientation is not applied, as calibration programs do not apply
/// it.
///
/// # Errors
/// As [`decode`].
pub(in crate::photos) fn size_px(path: &Path) -> Result<[u32; 2], PhotosError> {
    let dimensions = open(path)?.into_dimensions();
    dimensions
        .map(<[u32; 2]>::from)
        .map_err(|source| no_picture(path, source))
}

fn open(path: &Path) -> Result<ImageReader<BufReader<File>>, PhotosError> {
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    reader.map_err(|source| PhotosError::Io {
        path: path.into(),
        source,
    })
}

fn no_picture(path: &Path, source: ImageError) -> PhotosError {
    let path = path.into();
    match source {
        ImageError::Unsupported(_) => PhotosError::PictureFormat { path },
        source => PhotosError::Picture { path, source },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageFormat, RgbImage};
    use std::io::Cursor;

    /// A camera that was held upright notes a turn, and writes the pixels of its sensor: 6 is a quarter turn.
    #[test]
    fn exif_orientation_is_not_applied() {
        let mut image = RgbImage::new(32, 16);
        for (x, _, pixel) in image.enumerate_pixels_mut() {
            pixel.0 = if x < 16 { [250; 3] } else { [5; 3] };
        }
        let mut jpeg = Cursor::new(Vec::new());
        image.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
        let jpeg = jpeg.into_inner();
        let entry = [0x12, 1, 3, 0, 1, 0, 0, 0, 6, 0, 0, 0];
        let exif = [b"Exif\0\0II*\0\x08\0\0\0\x01\0".as_slice(), &entry, &[0; 4]].concat();
        let length = (exif.len() as u16 + 2).to_be_bytes();
        let turned = [&jpeg[..2], &[0xff, 0xe1], &length, &exif, &jpeg[2..]].concat();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpg");
        std::fs::write(&path, turned).unwrap();
        // The decoder reports the orientation, so the file is as intended.
        let mut decoder = open(&path).unwrap().into_decoder().unwrap();
        let noted = image::ImageDecoder::orientation(&mut decoder).unwrap();
        assert_eq!(noted, image::metadata::Orientation::Rotate90);
        assert_eq!(size_px(&path).unwrap(), [32, 16]);
        let pixels = decode(&path).unwrap().into_rgb8();
        assert_eq!(pixels.dimensions(), (32, 16));
        assert!(pixels.get_pixel(2, 14).0[0] > 200 && pixels.get_pixel(29, 1).0[0] < 50);
    }
}
