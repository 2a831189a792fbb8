//! Files beside a capture that its packets cannot be read without: metadata of Ouster, calibrations of the HDL-64E.
//!
//! There is no rule for their names. `ouster-cli` writes `drive.json` beside `drive.pcap`, recorders of several sensors
//! write `drive_0.json`, `drive_1.json`, and calibrations are called `db.xml`. So all files of the extension in the
//! folder are looked at, but not more than [`MOST_FILES`], and those whose names have most in common with the capture's
//! come first.

use super::ouster::{self, Metadata};
use super::velodyne::{self, Calibration};
use crate::io::error::Fault;
use crate::io::files::beside;
use crate::io::options::ReadOptions;
use std::cmp::Reverse;
use std::path::Path;

/// Files of a folder that are looked into.
const MOST_FILES: usize = 64;

/// Metadata beside a capture, and what could not be read of it.
#[derive(Debug)]
pub(super) struct Beside {
    /// The nearest by their names first.
    pub(super) metadata: Vec<Metadata>,
    /// What is wrong with files that are metadata, a sentence each.
    pub(super) problems: Vec<String>,
}

/// The metadata of sensors of Ouster beside the capture at `path`.
pub(super) fn metadata(path: &Path, options: &ReadOptions) -> Beside {
    let mut found = Beside {
        metadata: Vec::new(),
        problems: Vec::new(),
    };
    for name in names(path, "json") {
        let Ok(bytes) = beside::read(&name, path, ouster::MOST_METADATA_BYTES, options) else {
            continue;
        };
        let text = String::from_utf8_lossy(&bytes);
        if !ouster::is_metadata(&text) {
            continue;
        }
        match ouster::parse(&text) {
            Ok(metadata) => found.metadata.push(metadata),
            Err(fault) => found.problems.push(told(&name, &fault)),
        }
    }
    found
}

/// The calibration of a sensor of Velodyne beside the capture at `path`.
///
/// # Errors
/// Which file is expected, or what is wrong with the one that is there.
pub(super) fn calibration(path: &Path, options: &ReadOptions) -> Result<Calibration, String> {
    for name in names(path, "xml") {
        let Ok(bytes) = beside::read(&name, path, velodyne::MOST_CALIBRATION_BYTES, options) else {
            continue;
        };
        let text = String::from_utf8_lossy(&bytes);
        if velodyne::is_calibration(&text) {
            return velodyne::parse(&text).map_err(|fault| told(&name, &fault));
        }
    }
    Err(format!(
        "it has packets of an HDL-64E, whose lasers are calibrated one by one: expected its calibration db.xml beside \
         the capture, as {} or under another name with the extension xml",
        expected(path, "xml")
    ))
}

/// What to do where sensors of Ouster have no metadata.
pub(super) fn no_metadata(path: &Path, byte_count: usize, beside: &Beside) -> String {
    let found = match (beside.problems.first(), beside.metadata.as_slice()) {
        (Some(problem), _) => format!("; {problem}"),
        (None, []) => String::new(),
        (None, others) => {
            let sizes = others.iter().map(|metadata| metadata.shape.packet_bytes().to_string());
            let sizes: Vec<String> = sizes.collect();
            format!("; what is there is of packets of {} bytes", sizes.join(", "))
        }
    };
    format!(
        "it has packets of {byte_count} bytes as sensors of Ouster send them: expected the metadata of the sensor \
         beside the capture, as {} or under another name with the extension json{found}",
        expected(path, "json")
    )
}

/// The name that a file beside `path` would best have.
fn expected(path: &Path, extension: &str) -> String {
    let name = path.with_extension(extension);
    let name = name.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn told(name: &str, fault: &Fault) -> String {
    format!("{}, {}: {}", name.escape_default(), fault.place, fault.problem)
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
    names.sort_by_cached_key(|name| (Reverse(*name == own), Reverse(common(name)), name.clone()));
    names.truncate(MOST_FILES);
    names
}
