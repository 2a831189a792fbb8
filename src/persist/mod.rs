//! Files that persist between runs, in the user's folders for settings and for caches (data that can be recreated):
//! never half written.

mod lenient;
mod update;

pub(crate) use lenient::{
    Fields, copy_alongside, entries, fields, note_later_version, read_leniently, retain_readable,
};
pub(crate) use update::{merge, readable_entries, update, update_as};

use crate::regular_file;
use crate::temporary::Temporary;
use std::fs::{self, File};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A file beyond this size was not written by this program.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Returns the path of the persisted file `name`; `None` if the system has no such folder.
pub(crate) fn place_of(name: &str) -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "pointreel").map(|folders| folders.config_dir().join(name))
}

/// Returns the cache path of `name`, a file that can be recreated; `None` if the system has no such folder.
pub(crate) fn cached_place_of(name: &str) -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "pointreel").map(|folders| folders.cache_dir().join(name))
}

/// The bytes of `file`; `None` if it is not there yet. `Err` states why it cannot be read.
pub(crate) fn read(file: &Path) -> Result<Option<Vec<u8>>, String> {
    let size = match fs::metadata(file) {
        Ok(metadata) if metadata.is_file() => metadata.len(),
        Ok(_) => return Err("it is not a file".to_owned()),
        Err(reason) if reason.kind() == ErrorKind::NotFound => return Ok(None),
        Err(reason) => return Err(reason.to_string()),
    };
    if size > MAX_FILE_BYTES {
        return Err(format!("it has {size} bytes"));
    }
    fs::read(file).map(Some).map_err(|reason| reason.to_string())
}

/// [`write_whole`], in a folder that is made if it is not there.
pub(crate) fn replace(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    write_whole(file, bytes)
}

/// Writes a new file, which then replaces the old one: no reader ever sees half of it.
pub(crate) fn write_whole(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    write_whole_with(file, |new| new.write_all(bytes))
}

/// [`write_whole`] with the output of `write`.
pub(crate) fn write_whole_with(
    file: &Path,
    write: impl FnOnce(&mut File) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let (partial, mut new) = Partial::create(file)?;
    write(&mut new)?;
    // Flushed to disk before it gets its name.
    new.sync_data()?;
    drop(new);
    partial.finish()?;
    regular_file::sync_folder_of(file);
    Ok(())
}

/// [`write_whole`], or into a pipe or device named by the user.
pub(crate) fn write_to(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if is_pipe_or_device(file) {
        fs::write(file, bytes)
    } else {
        write_whole(file, bytes)
    }
}

/// Returns true if the path is a pipe or device, which keeps nothing of the data written to it.
pub(crate) fn is_pipe_or_device(path: &Path) -> bool {
    regular_file::check_replaceable(path).is_err()
}

/// A file under a hidden name until it is complete. If dropped before, it is removed.
#[derive(Debug)]
pub(crate) struct Partial {
    hidden: Temporary,
    file: PathBuf,
}

impl Partial {
    /// Names the hidden file that is to become `file`; the caller creates it.
    pub(crate) fn of(file: &Path) -> Self {
        /// Two threads may write the same file.
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        Self {
            hidden: Temporary::file(&file.with_file_name(format!(".{name}.{}.{number}.partial", std::process::id()))),
            file: file.to_owned(),
        }
    }

    /// Creates the hidden file that is to become `file`.
    pub(crate) fn create(file: &Path) -> std::io::Result<(Self, File)> {
        regular_file::check_replaceable(file)?;
        let partial = Self::of(file);
        // A link with this name was put there by someone else.
        let new = regular_file::create(partial.hidden())?;
        Ok((partial, new))
    }

    /// Returns the path of the temporary file until then.
    pub(crate) fn hidden(&self) -> &Path {
        self.hidden.path()
    }

    /// Renames the file to its final name, replacing a file that has that name now.
    pub(crate) fn finish(self) -> std::io::Result<()> {
        self.rename()
    }

    /// [`Partial::finish`] where it is a part of something else.
    pub(crate) fn rename(&self) -> std::io::Result<()> {
        self.hidden.rename(&self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_atomically_and_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new/folder/list.json");
        assert_eq!(read(&file), Ok(None));
        replace(&file, b"a longer first").unwrap();
        replace(&file, b"second").unwrap();
        assert_eq!(read(&file), Ok(Some(b"second".to_vec())));
        let alongside = fs::read_dir(file.parent().unwrap()).unwrap().count();
        assert_eq!(alongside, 1);
    }

    #[test]
    fn a_failed_replacement_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken");
        fs::create_dir_all(taken.join("by a folder")).unwrap();
        assert!(read(&taken).is_err());
        assert!(replace(&taken, b"bytes").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn sockets_and_links_are_not_written_through() {
        let folder = tempfile::tempdir().unwrap();
        let [socket, link, scan] = ["socket", "link", "scan.ply"].map(|name| folder.path().join(name));
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let refused = write_whole(&socket, b"{}").unwrap_err().to_string();
        assert_eq!(refused, "it is a socket, expected a file");
        fs::write(&scan, "ply").unwrap();
        std::os::unix::fs::symlink(&scan, &link).unwrap();
        write_whole(&link, b"{}").unwrap();
        assert_eq!(fs::read_to_string(&scan).unwrap(), "ply");
        assert!(!link.is_symlink());
    }

    #[test]
    fn a_huge_file_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("huge");
        fs::File::create(&file)
            .and_then(|created| created.set_len(MAX_FILE_BYTES + 1))
            .unwrap();
        assert_eq!(read(&file), Err("it has 1048577 bytes".to_owned()));
    }
}
