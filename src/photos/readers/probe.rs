//! Looks at an opened path, for readers that check whether it is theirs.

use crate::photos::error::PhotosError;
use crate::regular_file;
use std::cell::OnceCell;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Entries of a folder that are listed: a folder of more is one of frames.
const MAX_ENTRIES: usize = 10_000;

/// Bytes of a file that identify its format.
const HEAD: u64 = 1 << 16;

/// A folder, listed once and only if a reader looks for names that vary.
#[derive(Debug)]
pub(super) struct Folder<'a> {
    pub(super) path: &'a Path,
    names: OnceCell<Vec<String>>,
}

impl<'a> Folder<'a> {
    pub(super) fn new(path: &'a Path) -> Self {
        Self {
            path,
            names: OnceCell::new(),
        }
    }

    /// The first file of these names that is there.
    pub(super) fn first(&self, names: &[&str]) -> Option<PathBuf> {
        let mut paths = names.iter().map(|name| self.path.join(name));
        paths.find(|path| path.is_file())
    }

    /// The first name with this ending, in any case.
    pub(super) fn by_ending(&self, ending: &str) -> Option<PathBuf> {
        let name = self.names().iter().find(|name| name.to_lowercase().ends_with(ending))?;
        Some(self.path.join(name))
    }

    /// All names in it, in order.
    pub(super) fn names(&self) -> &[String] {
        self.names.get_or_init(|| names_in(self.path))
    }
}

/// A file.
#[derive(Debug)]
pub(super) struct File<'a> {
    pub(super) path: &'a Path,
    /// Its name in lower case.
    pub(super) name: String,
}

impl<'a> File<'a> {
    pub(super) fn new(path: &'a Path) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        Self { path, name }
    }

    /// Its name up to the last dot.
    pub(super) fn stem(&self) -> &str {
        self.name.rsplit_once('.').map_or(&self.name, |(stem, _)| stem)
    }

    /// Its name behind the last dot.
    pub(super) fn extension(&self) -> &str {
        self.name.rsplit_once('.').map_or("", |(_, extension)| extension)
    }

    /// The folder that it is in.
    pub(super) fn folder(&self) -> &'a Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Its beginning, as text.
    ///
    /// # Errors
    /// [`PhotosError::Io`].
    pub(super) fn head(&self) -> Result<String, PhotosError> {
        let head = head_of(self.path, HEAD).map_err(|source| PhotosError::Io {
            path: self.path.into(),
            source,
        })?;
        Ok(String::from_utf8_lossy(&head).into_owned())
    }
}

/// In order, so that the same one of several is taken each time.
pub(super) fn names_in(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let names = entries.take(MAX_ENTRIES).flatten();
    let mut names: Vec<String> = names.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    names
}

/// Returns true if the file at `path` begins with the magic bytes `magic`.
pub(super) fn begins_with(path: &Path, magic: &[u8]) -> bool {
    head_of(path, magic.len() as u64).is_ok_and(|head| head == magic)
}

fn head_of(path: &Path, size: u64) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    regular_file::open(path)?.take(size).read_to_end(&mut head)?;
    Ok(head)
}
