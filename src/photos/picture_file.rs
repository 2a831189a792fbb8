//! Files of pictures, told by their first bytes.

use super::error::PhotosError;
use image::{DynamicImage, ImageError, ImageReader};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The pixels of a picture.
///
/// # Errors
/// Where the file cannot be read, or is no picture.
pub(super) fn decode(path: &Path) -> Result<DynamicImage, PhotosError> {
    open(path)?.decode().map_err(|source| no_picture(path, source))
}

/// Width and height of a picture, as its header says; the turn that a camera noted in EXIF is not applied, as
/// programs that calibrate do not apply it.
///
/// # Errors
/// As [`decode`].
pub(super) fn size_px(path: &Path) -> Result<[u32; 2], PhotosError> {
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
    PhotosError::Picture {
        path: path.into(),
        source,
    }
}
