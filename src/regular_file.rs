//! Files that are opened for reading: named pipes, sockets and devices are refused before they are opened, as those
//! wait for a writer, never end, or act when they are opened.

use std::fs::{self, File, Metadata};
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;

/// [`File::open`] of what is a file, by whatever links.
pub(crate) fn open(path: &Path) -> Result<File> {
    check(path)?;
    File::open(path)
}

/// [`fs::read`] of what is a file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    check(path)?;
    fs::read(path)
}

/// [`fs::read_to_string`] of what is a file.
pub(crate) fn read_to_string(path: &Path) -> Result<String> {
    let mut text = String::new();
    open(path)?.read_to_string(&mut text)?;
    Ok(text)
}

/// Fails for what is there and is no file.
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

/// What it is, with its article.
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
    fn folders_are_named() {
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
