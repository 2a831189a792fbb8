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
    /// What it reads of a folder; `None` where there is nothing for it.
    pub(super) in_folder: fn(&Folder<'_>) -> Option<PathBuf>,
    /// Whether a file is one of its own.
    pub(super) of_file: fn(&File<'_>) -> Result<Option<Claim>, PhotosError>,
    /// What is listed there, before any photograph is looked for.
    pub(super) read: fn(&Path) -> Result<Drafts, PhotosError>,
}

/// A reader's claim to a file.
#[derive(Debug)]
pub(super) struct Claim {
    pub(super) confidence: Confidence,
    /// The file; the folder where that is read as a whole.
    pub(super) path: PathBuf,
}

/// How certain a reader is of a file, the less certain first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Confidence {
    /// By words that files of others may have as well.
    Likely,
    /// By its name, or by words of its own.
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
