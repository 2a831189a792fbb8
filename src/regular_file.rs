//! Files that are opened: which are one, which are none, and new ones that follow no link.
//!
//! Named pipes, sockets and devices are refused before they are opened, as those wait for a writer, never end, or act
//! when they are opened.

use std::fs::{self, File, Metadata};
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;

/// [`File::open`] of a regular file, through any links.
pub(crate) fn open(path: &Path) -> Result<File> {
    check(path)?;
    File::open(path)
}

/// [`fs::read`] of a regular file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    check(path)?;
    fs::read(path)
}

/// [`fs::read_to_string`] of a regular file.
pub(crate) fn read_to_string(path: &Path) -> Result<String> {
    let mut text = String::new();
    open(path)?.read_to_string(&mut text)?;
    Ok(text)
}

/// Fails for a pipe, socket or device: no file may take the place of one. Links that lead nowhere pass.
pub(crate) fn check_replaceable(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(there) if !there.is_file() && !there.is_dir() => check(path),
        _ => Ok(()),
    }
}

/// Fails if the path exists and is not a regular file.
pub(crate) fn check(path: &Path) -> Result<()> {
    let metadata = fs::metadata(path)?;
    if metadata.is_file() {
        return Ok(());
    }
    let kind = if metadata.is_dir() {
        ErrorKind::IsADirectory
    } else {
        ErrorKind::InvalidInput
    };
    Err(Error::new(
        kind,
        format!("it is {}, expected a file", kind_of(&metadata)),
    ))
}

/// Returns the identity of the file at `path`, independent of its names: device and file number on it; `None` if the
/// system does not report it.
pub(crate) fn id(path: &Path) -> Option<(u64, u64)> {
    fs::metadata(path).ok().as_ref().and_then(id_of)
}

/// [`id`] from the metadata of a file.
#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "other systems do not say")]
pub(crate) fn id_of(metadata: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt as _;
    Some((metadata.dev(), metadata.ino()))
}

/// [`id`] from the metadata of a file.
#[cfg(not(unix))]
pub(crate) fn id_of(_: &Metadata) -> Option<(u64, u64)> {
    None
}

/// Returns true if both paths refer to the same file, through links of any kind.
pub(crate) fn are_same(a: &Path, b: &Path) -> bool {
    match (id(a), id(b)) {
        (Some(a), Some(b)) => a == b,
        _ => a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b)),
    }
}

/// Creates a new file at `path`, replacing a file or link of that name: links are not followed.
pub(crate) fn create(path: &Path) -> Result<File> {
    match fs::remove_file(path) {
        Err(reason) if reason.kind() != ErrorKind::NotFound => return Err(reason),
        _ => {}
    }
    File::options().read(true).write(true).create_new(true).open(path)
}

/// Puts the names in the folder of `file` on the disk, where the system can.
pub(crate) fn sync_folder_of(file: &Path) {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // Folders cannot be opened on every system; without this, the names are only lost if the machine crashes.
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

/// Returns the file type as text, with its article.
pub(crate) fn kind_of(metadata: &Metadata) -> &'static str {
    if metadata.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        let kind = metadata.file_type();
        if kind.is_fifo() {
            return "a named pipe (FIFO)";
        } else if kind.is_socket() {
            return "a socket";
        } else if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
    }
    if metadata.is_file() { "a file" } else { "no file" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_reported_as_such() {
        let folder = tempfile::tempdir().unwrap();
        let reason = open(folder.path()).unwrap_err();
        assert_eq!(reason.kind(), ErrorKind::IsADirectory);
        assert_eq!(reason.to_string(), "it is a folder, expected a file");
        let missing = read(&folder.path().join("missing")).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::NotFound);
        let file = folder.path().join("a.txt");
        fs::write(&file, "text").unwrap();
        assert_eq!(read_to_string(&file).unwrap(), "text");
        assert_eq!(read(&file).unwrap(), b"text");
    }

    #[test]
    fn links_are_the_same_file_and_are_not_written_through() {
        let folder = tempfile::tempdir().unwrap();
        let [file, hard, other] = ["a.ply", "b.ply", "c.ply"].map(|name| folder.path().join(name));
        fs::write(&file, "source").unwrap();
        fs::write(&other, "source").unwrap();
        fs::hard_link(&file, &hard).unwrap();
        assert!(are_same(&file, &hard) || !cfg!(unix));
        assert!(are_same(&file, &folder.path().join("./a.ply")));
        assert!(!are_same(&file, &other) && !are_same(&file, &folder.path().join("missing")));
        #[cfg(unix)]
        {
            let link = folder.path().join("link");
            std::os::unix::fs::symlink(&file, &link).unwrap();
            assert!(are_same(&file, &link));
            drop(create(&link).unwrap());
            assert!(!link.is_symlink());
        }
        drop(create(&hard).unwrap());
        assert_eq!(fs::read_to_string(&file).unwrap(), "source");
        assert_eq!(fs::read_to_string(&hard).unwrap(), "");
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_sockets_are_not_opened() {
        let zero = read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert_eq!(zero, "it is a device, expected a file");
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let link = folder.path().join("link.ply");
        std::os::unix::fs::symlink(&socket, &link).unwrap();
        let reason = open(&link).unwrap_err().to_string();
        assert_eq!(reason, "it is a socket, expected a file");
    }
}
