//! Folders without a frame: the kinds of their files, for the message that refuses them.

use super::super::SequenceError;
use crate::io::refused::foreign::{by_extension, by_members};
use crate::io::{self, Foreign};
use crate::natural::natural_order;
use std::path::{Path, PathBuf};

/// Kinds that a message names.
const MAX_NAMED: usize = 3;

/// Files that are looked into: a folder may have a hundred thousand.
const MAX_LOOKED_INTO: usize = 256;

/// Extensions that parts of folders of some kinds share with frames.
const EXTENSIONS_OF_PARTS: [&str; 3] = ["bin", "glb", "gltf"];

/// The refusal of `folder` where its files are the parts of one thing that is not read, such as a Potree octree;
/// `frames` have the extension of a frame, `others` have not.
pub(super) fn of_whole(folder: &Path, frames: &[PathBuf], others: &[PathBuf]) -> Option<SequenceError> {
    let is_part = |frame: &PathBuf| {
        let extension = frame.extension().and_then(|extension| extension.to_str());
        extension.is_some_and(|extension| {
            EXTENSIONS_OF_PARTS
                .iter()
                .any(|part| extension.eq_ignore_ascii_case(part))
        })
    };
    if !frames.iter().all(is_part) {
        return None;
    }
    let files = frames.iter().chain(others);
    let names = files.filter_map(|file| file.file_name()?.to_str());
    let kind = by_members(&names)?;
    Some(refused(folder, format!("it is {kind}")))
}

/// The refusal of `folder`, none of whose `files` is a frame, where some of them are of kinds that are known.
pub(super) fn of_files(folder: &Path, files: &mut [PathBuf], hint: &str) -> Option<SequenceError> {
    files.sort_by(|left, right| natural_order(left, right));
    let looked_into = &files[..files.len().min(MAX_LOOKED_INTO)];
    let kinds = io::kinds_of(looked_into);
    if kinds.is_empty() {
        let is_zarr = [".zgroup", ".zarray"].iter().any(|name| folder.join(name).is_file());
        let named = if is_zarr { Path::new("a.zarr") } else { folder };
        return by_extension(named).map(|kind| refused(folder, format!("it is {kind}")));
    }
    let named: Vec<String> = kinds
        .iter()
        .take(MAX_NAMED)
        .map(|(kind, files)| said(kind, files))
        .collect();
    let more = if kinds.len() > MAX_NAMED { "; …" } else { "" };
    Some(refused(folder, format!("{}{more}{hint}", named.join("; "))))
}

fn refused(folder: &Path, found: String) -> SequenceError {
    SequenceError::ForeignFolder {
        path: folder.to_owned(),
        found,
    }
}

fn said(kind: &Foreign, files: &[&Path]) -> String {
    let first = files.first().and_then(|file| file.file_name()).unwrap_or_default();
    let first = first.to_string_lossy();
    match files.len() {
        1 => format!("{first} is {kind}"),
        count => format!("{first}, as {} others, is {kind}", count - 1),
    }
}
