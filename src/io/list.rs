//! Listing of the frames in a file.

use super::contents::{Contents, Entry};
use super::error::IoError;
use super::format::Format;
use crate::io::options::ReadOptions;
use crate::io::recordings::recording::camera::CameraTopics;
use crate::regular_file;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// Lists the contents of the file at `path`; a file of one frame is not read beyond its first bytes. In a recording,
/// the point clouds of `topic` are the frames: none if it has no such topic; if `None`, the topic with the most clouds.
pub fn contents(path: &Path, topic: Option<&str>, options: &ReadOptions) -> Result<Contents, IoError> {
    match Format::detect(path, &first_bytes(path)?) {
        Some(format) => list_format(path, format, topic, options),
        None => Ok(Contents::of_entries(vec![Entry::whole()])),
    }
}

/// The frames of [`contents`], of the topic that has the most.
pub fn list(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    Ok(contents(path, None, options)?.entries)
}

/// Returns the camera topics in the recording at `path`: none where it is not a recording, and where it has point
/// clouds, unless cameras are requested `with_clouds`.
pub(crate) fn cameras(path: &Path, with_clouds: bool, options: &ReadOptions) -> Result<CameraTopics, IoError> {
    let format = Format::detect(path, &first_bytes(path)?);
    let cameras = format.and_then(|format| Some((format, format.codec()?.cameras?)));
    cameras.map_or_else(
        || Ok(CameraTopics::default()),
        |(format, cameras)| cameras(path, format, with_clouds, options),
    )
}

/// Lists the contents of a file of `format`.
pub(super) fn list_format(
    path: &Path,
    format: Format,
    topic: Option<&str>,
    options: &ReadOptions,
) -> Result<Contents, IoError> {
    let codec = format.codec();
    if let Some(contents) = codec.and_then(|codec| codec.contents) {
        return contents(path, format, topic, options);
    }
    let entries = match codec.and_then(|codec| codec.list) {
        Some(list) => list(path, options)?,
        None => vec![Entry::whole()],
    };
    Ok(Contents::of_entries(entries))
}

/// The first [`Format::MAGIC_BYTES`] of a file, or all if there are fewer.
pub(super) fn first_bytes(path: &Path) -> Result<Vec<u8>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    // A pipe or device may never end; only regular files are read.
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(IoError::NotAFile {
            path: path.to_owned(),
            kind: regular_file::kind_of(&metadata),
        });
    }
    let mut magic = Vec::with_capacity(Format::MAGIC_BYTES);
    let file = File::open(path).map_err(failed)?;
    let mut start = file.take(Format::MAGIC_BYTES as u64);
    start.read_to_end(&mut magic).map_err(failed)?;
    Ok(magic)
}
