//! A row of the table of readers of image sets.

use super::probe::{File, Folder};
use crate::photos::error::PhotosError;
use crate::photos::found::draft::Drafts;
use std::path::{Path, PathBuf};

/// A reader of reconstructions of one format.
#[derive(Debug)]
pub(super) struct Reader {
    /// The format, for people.
    pub(super) name: &'static str,
    /// Finds the file to read in a folder; `None` if the folder holds nothing for this reader.
    pub(super) in_folder: fn(&Folder<'_>) -> Option<PathBuf>,
    /// Checks if a file is in this reader's format, and claims it if so.
    pub(super) of_file: fn(&File<'_>) -> Result<Option<Claim>, PhotosError>,
    /// Reads the entries listed in the file, before any image is looked up.
    pub(super) read: fn(&Path) -> Result<Drafts, PhotosError>,
}

/// A reader's claim to a file.
#[derive(Debug)]
pub(super) struct Claim {
    pub(super) confidence: Confidence,
    /// The file; the folder where that is read as a whole.
    pub(super) path: PathBuf,
}

/// Confidence of a reader in having recognised a file, in ascending order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Confidence {
    /// Recognised by words that other files may have as well.
    Likely,
    /// Recognised by its name, or by words of its own.
    Certain,
}

impl Claim {
    pub(super) fn certain(path: impl Into<PathBuf>) -> Self {
        Self {
            confidence: Confidence::Certain,
            path: path.into(),
        }
    }

    pub(super) fn likely(path: impl Into<PathBuf>) -> Self {
        Self {
            confidence: Confidence::Likely,
            path: path.into(),
        }
    }
}
