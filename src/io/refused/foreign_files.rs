//! Kinds of files on disk that are not read.

use super::foreign::{Foreign, recognise, rows};
use crate::io::list::first_bytes;
use std::path::{Path, PathBuf};

/// The kinds of the files at `paths`, in the order of the tables, each with its files. Those that cannot be opened are
/// recognised by their names.
pub(crate) fn kinds_of(paths: &[PathBuf]) -> Vec<(&'static Foreign, Vec<&Path>)> {
    let kind_of = |path: &PathBuf| {
        let bytes = first_bytes(path).unwrap_or_default();
        recognise(path, &bytes)
    };
    let kinds: Vec<Option<&Foreign>> = paths.iter().map(kind_of).collect();
    let files_of = |row: &Foreign| -> Vec<&Path> {
        let of_row = kinds
            .iter()
            .zip(paths)
            .filter(|(kind, _)| kind.is_some_and(|kind| kind.name() == row.name()));
        of_row.map(|(_, path)| path.as_path()).collect()
    };
    let found = rows().map(|row| (row, files_of(row)));
    found.filter(|(_, files)| !files.is_empty()).collect()
}
