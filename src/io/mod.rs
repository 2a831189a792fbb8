//! Reading point clouds that other programs wrote.
//!
//! Well-kept crates read the headers (`ply-rs-bw`, `pcd-rs`), decompress (`lzf`) and read numbers in text
//! (`fast-float2`). The payload is ours: the crates' readers make a value a property or a row, which takes about 40
//! times as long or more, and one of them allocates what a header merely claims. Here every size is checked against the bytes
//! there are before anything is allocated for it.

mod attributes;
mod column;
mod error;
mod format;
mod numbers;
mod pcd;
mod ply;
mod xyz;

pub use error::{IoError, Place};
pub use format::{Format, supported_extensions};

use crate::cloud::RawCloud;
use std::path::Path;

/// Reads the cloud in the file at `path`: by its first bytes, else by its extension.
pub fn read(path: &Path) -> Result<RawCloud, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    // A pipe or device may never end; only regular files are read.
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(IoError::NotAFile {
            path: path.to_owned(),
        });
    }
    // One allocation of the file's length, refused by an error where there is no memory for it.
    let bytes = std::fs::read(path).map_err(failed)?;
    read_bytes(path, &bytes)
}

/// Reads the cloud in `bytes`; `name` stands in error messages, and its extension tells the format where the first
/// bytes do not.
pub fn read_bytes(name: &Path, bytes: &[u8]) -> Result<RawCloud, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty {
            path: name.to_owned(),
        });
    }
    let format = Format::detect(name, bytes).ok_or_else(|| IoError::UnknownFormat {
        path: name.to_owned(),
    })?;
    let decoded = match format {
        Format::Ply => ply::decode(bytes),
        Format::Pcd => pcd::decode(bytes),
        Format::Xyz => xyz::decode(bytes),
    };
    decoded.map_err(|fault| IoError::Invalid {
        path: name.to_owned(),
        format,
        place: fault.place,
        problem: fault.problem,
    })
}
