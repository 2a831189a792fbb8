//! Errors of image sets: the file, the location in it, the expectation and the remedy.

use std::path::{Path, PathBuf};

/// Error while reading a set of input images, or one of its files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PhotosError {
    /// The system could not read a file.
    #[error("{} cannot be read ({source}): check that it exists and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file breaks the rules of its format.
    #[error("{}, {place}: {problem}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Location in the file.
        place: String,
        /// Problem: the expected and the actual content there.
        problem: String,
    },
    /// A file that is not JSON, or JSON of another shape.
    #[error(
        "{} is not understood ({source}): export it again, it may not have been written to its end",
        path.display()
    )]
    Json {
        /// The file.
        path: PathBuf,
        /// The parser's reason, with line and column.
        source: serde_json::Error,
    },
    /// None of the input images that a file lists can be shown.
    #[error("{} lists {count} images, none of which can be shown: {reason}", path.display())]
    NoPhotos {
        /// The file.
        path: PathBuf,
        /// Number of images that it lists.
        count: usize,
        /// Reason why they cannot be shown, and the remedy.
        reason: String,
    },
    /// An input image that cannot be decoded.
    #[error(
        "{} cannot be decoded ({source}): open it in an image viewer to see whether it is intact",
        path.display()
    )]
    Picture {
        /// The file.
        path: PathBuf,
        /// The decoder's reason.
        source: image::ImageError,
    },
    /// An input image in a format that the image decoder does not support.
    #[error("{} {NOT_DECODED}", path.display())]
    PictureFormat {
        /// The file.
        path: PathBuf,
    },
    /// A folder in which something other than a set of input images was found.
    #[error("{} holds {found}: {advice}", path.display())]
    NoSet {
        /// The folder.
        path: PathBuf,
        /// Contents of the folder.
        found: String,
        /// Advice to the user.
        advice: String,
    },
    /// An input image that has changed its size.
    #[error(
        "{} has {} × {} pixels, but its camera {} × {}: put back the image that was calibrated",
        path.display(), found_px[0], found_px[1], expected_px[0], expected_px[1]
    )]
    WrongSize {
        /// The file.
        path: PathBuf,
        /// Width and height of the camera's image.
        expected_px: [u32; 2],
        /// Image size of the file.
        found_px: [u32; 2],
    },
}

/// Error text for an image in an unknown format.
const NOT_DECODED: &str = "has an unsupported image format: convert it to JPEG, PNG or WebP under the same name, next \
                           to it or instead of it";

impl PhotosError {
    pub(super) fn invalid(path: &Path, place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Invalid {
            path: path.into(),
            place: place.into(),
            problem: problem.into(),
        }
    }

    /// Returns the problem with an input image, without its path if others have the same.
    pub(super) fn reason(&self) -> String {
        match self {
            Self::PictureFormat { .. } => format!("it {NOT_DECODED}"),
            other => other.to_string(),
        }
    }
}

/// The bytes of a file.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, PhotosError> {
    crate::regular_file::read(path).map_err(|source| PhotosError::Io {
        path: path.into(),
        source,
    })
}
