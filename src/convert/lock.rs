//! Output lock, one writer per output: a companion file that the writer locks, and that identifies the writer.
//!
//! **How it works.** The system releases a lock when its process ends, for whatever reason: a lock left by a killed
//! process is taken over, with a message. Some network disks have no locks: there the content of the file counts, and
//! only a process of this machine that has ended is replaced. A lock file that was removed and created again during the
//! wait is another file.

use super::error::ConvertError;
use crate::regular_file;
use crate::temporary::Temporary;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Upper bound of the size of the holder's record in the lock file.
const MAX_BYTES: u64 = 4096;

/// Held by the process that writes a file. The lock of a killed process is free for the next.
#[derive(Debug)]
pub(super) struct Lock {
    /// Removed first. If that fails, an unlocked file remains.
    _listed: Temporary,
    _file: File,
}

/// Process that holds the lock of an output.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Holder {
    pid: u32,
    host: String,
    /// Since 1970.
    since_s: u64,
}

impl fmt::Display for Holder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "process {} of {}", self.pid, self.host)
    }
}

impl Holder {
    fn this() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            pid: std::process::id(),
            host: host(),
            since_s: since.map_or(0, |since| since.as_secs()),
        }
    }

    fn read(file: &mut File) -> Option<Self> {
        let mut text = Vec::new();
        file.take(MAX_BYTES).read_to_end(&mut text).ok()?;
        serde_json::from_slice(&text).ok()
    }

    fn write(&self, file: &mut File) -> std::io::Result<()> {
        file.set_len(0)?;
        file.rewind()?;
        file.write_all(&serde_json::to_vec(self).unwrap_or_default())
    }

    /// Returns true if the process has certainly ended.
    fn has_ended(&self) -> bool {
        let processes = Path::new("/proc");
        self.host == host() && processes.join("self").exists() && !processes.join(self.pid.to_string()).exists()
    }
}

/// The name of this machine.
fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    match name.trim() {
        "" => std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this machine".to_owned()),
        name => name.to_owned(),
    }
}

/// Locks `output` against other processes until the returned lock is dropped; `path` is its companion lock file.
pub(super) fn lock(path: &Path, output: &Path) -> Result<Lock, ConvertError> {
    let failed = |reason| ConvertError::Write {
        path: path.to_owned(),
        reason,
    };
    if path.symlink_metadata().is_ok_and(|there| there.is_symlink()) {
        fs::remove_file(path).map_err(failed)?;
    } else if path.exists() {
        regular_file::check(path).map_err(failed)?;
    }
    let opened = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path);
    let mut file = opened.map_err(failed)?;
    let taken = file.try_lock();
    let before = Holder::read(&mut file);
    let busy = |holder: Option<&Holder>| ConvertError::Busy {
        path: output.to_owned(),
        holder: holder.map_or_else(|| "another process".to_owned(), Holder::to_string),
        lock: path.to_owned(),
    };
    match taken {
        Err(TryLockError::WouldBlock) => return Err(busy(before.as_ref())),
        // Another process has just ended and removed it, and perhaps a third one has created it again.
        Ok(()) if !is_at(&file, path) => return Err(busy(None)),
        // Where files cannot be locked, their content decides.
        Err(TryLockError::Error(_)) if before.as_ref().is_some_and(|holder| !holder.has_ended()) => {
            return Err(busy(before.as_ref()));
        }
        Ok(()) | Err(TryLockError::Error(_)) => {}
    }
    if let Some(before) = before {
        log::warn!(
            "{}: {before} has ended without finishing it, and its lock is taken over",
            output.display()
        );
    }
    // From here on it belongs to this process.
    let listed = Temporary::file(path);
    Holder::this().write(&mut file).map_err(failed)?;
    Ok(Lock {
        _listed: listed,
        _file: file,
    })
}

/// Returns true if the file at `path` is still the one that is open.
fn is_at(file: &File, path: &Path) -> bool {
    let open = file.metadata().ok().as_ref().and_then(regular_file::id_of);
    match open {
        Some(open) => regular_file::id(path) == Some(open),
        None => path.exists(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_process_learns_which_one_holds_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let [path, output] = [".walk.reel.lock", "walk.reel"].map(|name| folder.path().join(name));
        let first = lock(&path, &output).unwrap();
        let refused = lock(&path, &output).unwrap_err().to_string();
        let pid = std::process::id().to_string();
        assert!(
            refused.contains("walk.reel is being written by process ") && refused.contains(&pid),
            "{refused}"
        );
        drop(first);
        assert!(!path.exists());
        drop(lock(&path, &output).unwrap());
    }

    #[test]
    fn the_lock_of_a_killed_process_is_taken_over() {
        let folder = tempfile::tempdir().unwrap();
        let [path, output] = [".walk.reel.lock", "walk.reel"].map(|name| folder.path().join(name));
        let gone = Holder {
            pid: u32::MAX,
            host: host(),
            since_s: 0,
        };
        fs::write(&path, serde_json::to_vec(&gone).unwrap()).unwrap();
        assert!(gone.has_ended() || !cfg!(target_os = "linux"));
        assert!(!Holder::this().has_ended());
        let held = lock(&path, &output).unwrap();
        let there: Holder = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        assert_eq!(there.pid, std::process::id());
        drop(held);
        // An empty or truncated lock belongs to no one.
        fs::write(&path, "{\"pid\": 1").unwrap();
        drop(lock(&path, &output).unwrap());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let [path, output, scan] = [".walk.reel.lock", "walk.reel", "scan.ply"].map(|name| folder.path().join(name));
        fs::write(&scan, "ply").unwrap();
        std::os::unix::fs::symlink(&scan, &path).unwrap();
        drop(lock(&path, &output).unwrap());
        assert_eq!(fs::read_to_string(&scan).unwrap(), "ply");
    }
}
