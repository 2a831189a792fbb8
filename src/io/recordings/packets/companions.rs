//! Companion files of a capture that are required to read its packets: metadata of Ouster, calibrations of the HDL-64E.
//!
//! There is no rule for their names. `ouster-cli` writes `drive.json` next to `drive.pcap`, recorders of several
//! sensors write `drive_0.json`, `drive_1.json`, and calibrations are called `db.xml`. So all files of the extension in
//! the folder are examined, but not more than [`MAX_FILES`], and those with names most similar to the capture's come
//! first. Packets from a network have one such file, which is named after the address.

use crate::io::error::Fault;
use crate::io::files::sidecars;
use crate::io::options::ReadOptions;
use std::cmp::Reverse;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files of a folder that are looked into.
const MAX_FILES: usize = 64;

/// Source of the companion files.
#[derive(Debug, Clone)]
pub(super) enum Companions {
    /// In the folder of a capture.
    Sidecar { capture: PathBuf, options: ReadOptions },
    /// The text of the one that was named, if one was.
    Given(Option<Arc<str>>),
}

impl Companions {
    /// Returns the capture whose companions they are.
    pub(super) fn capture(&self) -> Option<&Path> {
        match self {
            Self::Sidecar { capture, .. } => Some(capture),
            Self::Given(_) => None,
        }
    }

    /// Names and texts of files with `extension`, the nearest by their names first; of a given file, its text.
    pub(super) fn texts(&self, extension: &str, max_bytes: u64) -> Box<dyn Iterator<Item = (String, String)> + '_> {
        match self {
            Self::Sidecar { capture, options } => {
                Box::new(names(capture, extension).into_iter().filter_map(move |name| {
                    let bytes = sidecars::read(&name, capture, max_bytes, options).ok()?;
                    Some((name, String::from_utf8_lossy(&bytes).into_owned()))
                }))
            }
            Self::Given(text) => Box::new(text.iter().map(|text| (String::new(), text.to_string()))),
        }
    }

    /// Returns the expected location of a companion file with `extension`, as the end of a sentence; `address` is an
    /// example of what a user would enter.
    pub(super) fn expected(&self, extension: &str, address: &str) -> String {
        match self {
            Self::Sidecar { capture, .. } => format!(
                "next to the capture, as {} or under another name with the extension {extension}",
                expected(capture, extension)
            ),
            Self::Given(_) => format!("behind the address, as in {address}"),
        }
    }
}

/// Returns the error message for the file `name`.
pub(super) fn told(name: &str, fault: &Fault) -> String {
    format!("{}, {}: {}", name.escape_default(), fault.place, fault.problem)
}

/// Returns the preferred name of a companion file of `path`.
fn expected(path: &Path, extension: &str) -> String {
    let name = path.with_extension(extension);
    let name = name.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Files with `extension` in the folder of `path`, the nearest by their names first.
fn names(path: &Path, extension: &str) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let has_extension = |name: &String| {
        let found = Path::new(name).extension().and_then(|found| found.to_str());
        found.is_some_and(|found| found.eq_ignore_ascii_case(extension))
    };
    let name = |entry: std::fs::DirEntry| entry.file_name().into_string().ok();
    let mut names: Vec<String> = entries.flatten().filter_map(name).filter(has_extension).collect();
    let own = expected(path, extension);
    let common = |name: &String| {
        let both = name.chars().zip(own.chars());
        both.take_while(|(left, right)| left == right).count()
    };
    // Names follow no convention: they only order the candidates, and the contents decide (packet size, serial number,
    // port).
    names.sort_by_cached_key(|name| (Reverse(*name == own), Reverse(common(name)), name.clone()));
    names.truncate(MAX_FILES);
    names
}
