//! The content of an archive without a point cloud, for the message that refuses it.

use super::member::Member;
use crate::io::error::IoError;
use crate::io::refused::foreign;
use std::path::Path;

/// Files that a sentence names.
const MAX_NAMED: usize = 4;

/// Fails where the archive at `path` has the extension of a kind that is not read: its files are parts of that.
pub(super) fn check_name(path: &Path) -> Result<(), IoError> {
    match foreign::by_extension(path) {
        Some(kind) => Err(IoError::Foreign {
            path: path.to_owned(),
            kind,
        }),
        None => Ok(()),
    }
}

/// Fails where the archive at `path` is of a kind that is not read.
pub(super) fn check(path: &Path, members: &[Member]) -> Result<(), IoError> {
    match foreign::by_members(&members.iter().map(|member| member.name.as_str())) {
        Some(kind) => Err(IoError::Foreign {
            path: path.to_owned(),
            kind,
        }),
        None => Ok(()),
    }
}

/// Its files, and the kind of the first one that is known.
pub(super) fn describe(members: &[Member]) -> String {
    let names: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
    if names.is_empty() {
        return "no file is in it, it may not have been written to its end".to_owned();
    }
    let more = if names.len() > MAX_NAMED { ", …" } else { "" };
    let listed = names.iter().take(MAX_NAMED).copied().collect::<Vec<_>>().join(", ");
    let count = names.len();
    let files = match count {
        1 => format!("its only file is {listed}"),
        _ => format!("its {count} files are {listed}{more}"),
    };
    let known = names
        .iter()
        .find_map(|name| foreign::by_extension(Path::new(name)).map(|kind| (name, kind)));
    match known {
        Some((name, kind)) => format!("{files}; {name} is {kind}"),
        None => format!("{files}; expected files of a format that is read"),
    }
}
