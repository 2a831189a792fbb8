//! Listing of a folder, by names alone.

use super::error::RgbdError;
use crate::io::Format;
use crate::natural::natural_order;
use std::fs;
use std::path::{Path, PathBuf};

/// Extensions of images that may hold depths or colours.
const IMAGES: &[&str] = &[
    "png", "tif", "tiff", "pgm", "ppm", "pnm", "jpg", "jpeg", "webp", "bmp", "pclzf",
];

/// Extensions of arrays of numpy, which may hold depths; not of images alone.
const ARRAYS: &[&str] = &["npy", "npz"];

/// Folder listing: its files and folders in natural order, excluding hidden ones.
#[derive(Debug)]
pub(super) struct Folder {
    pub(super) path: PathBuf,
    files: Vec<String>,
    folders: Vec<String>,
}

impl Folder {
    /// The folder at `path`.
    pub(super) fn read(path: &Path) -> Result<Self, RgbdError> {
        let unreadable = |reason| RgbdError::Unreadable {
            path: path.to_owned(),
            reason,
        };
        let (mut files, mut folders) = (Vec::new(), Vec::new());
        for entry in fs::read_dir(path).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            // No layout has names that are not Unicode.
            let Ok(name) = entry.file_name().into_string() else {
                continue;
            };
            if name.starts_with('.') {
                continue;
            }
            let kind = entry.file_type().map_err(unreadable)?;
            let is_folder = kind.is_dir() || (kind.is_symlink() && entry.path().is_dir());
            if is_folder { &mut folders } else { &mut files }.push(name);
        }
        for names in [&mut files, &mut folders] {
            names.sort_by(|left, right| natural_order(Path::new(left), Path::new(right)));
        }
        Ok(Self {
            path: path.to_owned(),
            files,
            folders,
        })
    }

    pub(super) fn has_file(&self, name: &str) -> bool {
        self.files.iter().any(|file| file == name)
    }

    /// The first folder in it that has one of these names, in any case.
    pub(super) fn sub(&self, names: &[&str]) -> Option<PathBuf> {
        let found = |name: &&str| self.folders.iter().find(|folder| folder.eq_ignore_ascii_case(name));
        names.iter().find_map(found).map(|folder| self.path.join(folder))
    }

    /// Its files with names that `is_meant` chooses.
    pub(super) fn files(&self, is_meant: impl Fn(&str) -> bool) -> Vec<PathBuf> {
        let meant = self.files.iter().filter(|name| is_meant(name));
        meant.map(|name| self.path.join(name)).collect()
    }

    /// Its images.
    pub(super) fn images(&self) -> Vec<PathBuf> {
        self.files(is_image)
    }

    /// Its images, and arrays that may be depth images.
    pub(super) fn depth_images(&self) -> Vec<PathBuf> {
        self.files(|name| is_image(name) || has_extension(name, ARRAYS))
    }

    /// Names of its folders.
    pub(super) fn folders(&self) -> &[String] {
        &self.folders
    }

    /// Names of point clouds in it, by their extensions; text may be anything.
    pub(super) fn clouds(&self) -> Vec<&str> {
        let is_text = |name: &str| has_extension(name, &["txt", "csv", "asc", "log"]);
        let names = self.files.iter().map(String::as_str);
        names
            .filter(|name| !is_text(name) && Format::of_extension(Path::new(name)).is_some())
            .collect()
    }

    /// Returns true if the folder has point clouds, judging by their extensions; text may be anything.
    pub(super) fn has_clouds(&self) -> bool {
        !self.clouds().is_empty()
    }
}

/// Returns true if `name` is an image file's.
pub(super) fn is_image(name: &str) -> bool {
    has_extension(name, IMAGES)
}

/// Returns true if `name` ends with one of these extensions, ignoring case.
pub(super) fn has_extension(name: &str, extensions: &[&str]) -> bool {
    let extension = name.rsplit_once('.').map(|(_, extension)| extension);
    extension.is_some_and(|found| extensions.iter().any(|extension| found.eq_ignore_ascii_case(extension)))
}

/// The name of the file at `path`.
pub(super) fn name_of(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}
