//! Readers of image sets, one row each: the contents of a folder or a file, by programs' naming conventions.
//!
//! How it works: every opened folder is checked, so the usual names are looked up one by one, and the folder is listed
//! once for names that vary. For a folder, the first row that finds its files counts: formats with points come first,
//! as many folders hold a copy of the same cameras without. For a file, the most certain row counts, and the first of
//! equals.
//!
//! To add a reader: its file with a `READER`, `mod` and a row here.

mod bundler;
pub(super) mod colmap;
mod llff;
pub(super) mod meshroom;
mod middlebury;
mod middlebury_stereo;
mod mvsnet;
mod nvm;
mod opensfm;
mod probe;
mod reader;
mod transforms;
pub(super) mod unread;

use super::error::PhotosError;
use crate::photos::found::calibration::Calibration;
use crate::photos::sets::view_set::ViewSet;
use probe::{File, Folder};
use reader::{Claim, Confidence, Reader};
use std::path::{Path, PathBuf};

/// The readers, those with points first.
const READERS: &[&Reader] = &[
    // Formats with points come first, since many folders hold a copy of the same cameras without points.
    &colmap::READER,
    &bundler::READER,
    &nvm::READER,
    &meshroom::READER,
    &transforms::READER,
    &llff::READER,
    &middlebury::READER,
    &mvsnet::READER,
    &middlebury_stereo::READER,
    // Folders in which another set was found before this format was supported still show that one.
    &opensfm::READER,
];

/// A reconstruction that was found.
#[derive(Debug, Clone)]
pub struct FoundSet {
    reader: &'static Reader,
    /// Its file; of COLMAP and `MVSNet` the folder of its files.
    pub path: PathBuf,
}

impl FoundSet {
    /// The name of its format for people.
    pub fn format(&self) -> &'static str {
        self.reader.name
    }

    /// Reads its input images.
    ///
    /// # Errors
    /// If the files break the rules of their format, or if none of the images can be shown. Problems with some of them
    /// alone are notes of the set.
    pub fn read(&self) -> Result<ViewSet, PhotosError> {
        self.calibration()?.posed_images()
    }

    /// Reads its calibration, before any input image is looked for.
    ///
    /// # Errors
    /// If the files break the rules of their format.
    pub fn calibration(&self) -> Result<Calibration, PhotosError> {
        Ok(Calibration::new((self.reader.read)(&self.path)?))
    }
}

/// The reconstruction in a folder, or the one that a file is of; `None` if there is none.
///
/// # Errors
/// An error if a file with the name of one cannot be read.
pub fn find(path: &Path) -> Result<Option<FoundSet>, PhotosError> {
    if path.is_dir() {
        Ok(in_folder(path))
    } else if path.is_file() {
        of_file(path)
    } else {
        Ok(None)
    }
}

fn in_folder(path: &Path) -> Option<FoundSet> {
    let folder = Folder::new(path);
    // By file names alone, as every opened folder is checked: 0.1 ms for an empty one, 10 ms for 10,000 frames.
    READERS.iter().find_map(|reader| {
        let path = (reader.in_folder)(&folder)?;
        Some(FoundSet { reader, path })
    })
}

fn of_file(path: &Path) -> Result<Option<FoundSet>, PhotosError> {
    let file = File::new(path);
    let mut best: Option<(Confidence, FoundSet)> = None;
    for reader in READERS {
        let Some(Claim { confidence, path }) = (reader.of_file)(&file)? else {
            continue;
        };
        if best.as_ref().is_none_or(|(max, _)| confidence > *max) {
            best = Some((confidence, FoundSet { reader, path }));
        }
    }
    Ok(best.map(|(_, found)| found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::fs;

    #[test]
    fn reader_names_are_unique() {
        let names: HashSet<&str> = READERS.iter().map(|reader| reader.name).collect();
        assert_eq!(names.len(), READERS.len());
    }

    #[test]
    fn the_reader_that_is_most_certain_of_a_file_reads_it() {
        let folder = tempfile::tempdir().unwrap();
        let of = |text: &str| {
            let path = folder.path().join("scene.json");
            fs::write(&path, text).unwrap();
            find(&path).unwrap().map(|found| found.format())
        };
        assert_eq!(of(r#"{"version": [], "views": []}"#), Some("Meshroom"));
        let both = r#"{"version": [], "views": [], "frames": [{"transform_matrix": []}]}"#;
        assert_eq!(of(both), Some("transforms.json"));
        assert_eq!(of("{}"), None);
    }
}
