//! Files that another file names.
//!
//! A file names others at will. Only those within its own folder are read: no absolute paths, no `..`, no links that
//! lead out of it, nothing from a network.

use crate::io::error::mebibytes;
use crate::io::options::ReadOptions;
use std::path::{Component, Path};

/// The bytes of the file that the one at `path` calls `name`, not more than `max_bytes`.
///
/// # Errors
/// Its fault, as the end of a sentence about the file at `path`.
pub(in crate::io) fn read(name: &str, path: &Path, max_bytes: u64, options: &ReadOptions) -> Result<Vec<u8>, String> {
    let outside = || {
        format!(
            "it lies in `{}`: only files in the folder of the one that names them are read",
            name.escape_default()
        )
    };
    let relative = Path::new(name);
    let is_inside = relative
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    // Backslashes and drive letters form paths on some systems, and a colon ends a scheme such as http.
    if !is_inside || name.contains(['\\', ':', '\0']) || name.is_empty() {
        return Err(outside());
    }
    let unreadable = |error: std::io::Error| {
        format!(
            "`{}` cannot be read ({error}): it must be next to the file that names it",
            name.escape_default()
        )
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().map_err(unreadable)?;
    let file = folder.join(relative).canonicalize().map_err(unreadable)?;
    if !file.starts_with(&folder) {
        return Err(outside());
    }
    let about = file.metadata().map_err(unreadable)?;
    if !about.is_file() {
        return Err(format!("`{}` is not a regular file", name.escape_default()));
    }
    if about.len() > max_bytes {
        return Err(format!(
            "`{}` has {}, more than --max-memory allows ({})",
            name.escape_default(),
            mebibytes(about.len()),
            mebibytes(options.max_memory_bytes)
        ));
    }
    std::fs::read(file).map_err(unreadable)
}
