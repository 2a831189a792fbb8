//! A frame of a file, decoded.

use crate::cloud::RawCloud;
use crate::io::normals::read_with_normals;
use crate::io::{self, Part, ReadOptions, SharedFile};
use crate::progress::Progress;
use crate::source::{DecodeFailure, FrameBytes, FrameEntry};

/// Reads a frame of a file, or bytes in the program, in the coordinates of the sequence.
pub(super) fn decode(
    entry: &FrameEntry,
    options: &ReadOptions,
    shared: &SharedFile,
    progress: &Progress,
) -> Result<RawCloud, DecodeFailure> {
    read_frame(entry, options, shared, progress).map(|cloud| placed(cloud, entry))
}

/// Reads a frame of a file, or bytes in the program.
pub(super) fn read_frame(
    entry: &FrameEntry,
    options: &ReadOptions,
    shared: &SharedFile,
    progress: &Progress,
) -> Result<RawCloud, DecodeFailure> {
    let path = &entry.path;
    Ok(match (&entry.content, &entry.normals) {
        (FrameBytes::File(Part::Whole | Part::Sole), Some(normals)) => {
            read_with_normals(path, normals, options, progress)?
        }
        (FrameBytes::File(part), _) => shared.read_part(path, part, options, progress)?,
        (FrameBytes::Embedded(bytes), _) => io::read_bytes(path, bytes)?,
    })
}

/// `cloud` in the coordinates of the sequence.
pub(super) fn placed(mut cloud: RawCloud, entry: &FrameEntry) -> RawCloud {
    if let Some(pose) = &entry.pose {
        cloud.transform(pose);
    }
    cloud
}
