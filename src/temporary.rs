//! Temporary files, on disk only until a command ends: hidden files that are being written, locks, new folders, and
//! helper processes that write.
//!
//! **How it works.** One list of the process names them all. Each is removed by its creator ([`Temporary`] is dropped),
//! by a signal that ends the process, or at the end of the program, whichever comes first ([`remove_all`]). A file gets
//! its final name while the list is locked, so a signal finds either the hidden file or the finished one. After
//! [`remove_all`] the list stays locked: nothing new is written to disk while the process ends. Files that a process
//! leaves when it is killed outright (SIGKILL, power) are not removed.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Polling interval for the end of a helper process.
const LOOK_INTERVAL: Duration = Duration::from_millis(5);

/// Number of attempts by an out-of-memory process to lock the list that another thread holds, one per
/// [`LOOK_INTERVAL`].
const LOCK_TRIES: u32 = 20;

static LISTED: Mutex<List> = Mutex::new(List {
    next: 0,
    entries: BTreeMap::new(),
});

#[derive(Debug)]
struct List {
    next: u64,
    /// In the order in which they were made.
    entries: BTreeMap<u64, Entry>,
}

#[derive(Debug)]
enum Entry {
    File(PathBuf),
    /// Removed while nothing is in it.
    Folder(PathBuf),
    /// Removed with all that is in it.
    FolderAndContents(PathBuf),
    Helper(Arc<Mutex<Child>>),
}

impl Entry {
    fn remove(&self) {
        // A file that is gone needs no removal, and there is no one to report a failed removal to.
        let _ = match self {
            Self::File(path) => fs::remove_file(path),
            Self::Folder(path) => fs::remove_dir(path),
            Self::FolderAndContents(path) => fs::remove_dir_all(path),
            Self::Helper(child) => {
                let mut child = locked(child);
                child.kill().and_then(|()| child.wait().map(|_| ()))
            }
        };
    }
}

/// Locks a mutex, ignoring poisoning: a list of paths is still valid after another thread's panic.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl List {
    fn add(&mut self, entry: Entry) -> Listed {
        let number = self.next;
        self.next += 1;
        self.entries.insert(number, entry);
        Listed(number)
    }

    /// Removes everything from the disk, the latest first; allocates nothing.
    fn remove_from_disk(&self) {
        for entry in self.entries.values().rev() {
            entry.remove();
        }
    }

    /// Removes everything, also from the list; allocates nothing.
    fn remove_all(&mut self) {
        self.remove_from_disk();
        self.entries.clear();
    }
}

/// Number of an entry, which is removed with it.
#[derive(Debug)]
struct Listed(u64);

impl Drop for Listed {
    fn drop(&mut self) {
        let mut list = locked(&LISTED);
        if let Some(entry) = list.entries.remove(&self.0) {
            entry.remove();
        }
    }
}

/// Removes everything that is listed, the latest first. From then on every thread that makes, names or removes a
/// temporary waits: call it only before the process ends.
pub(crate) fn remove_all() {
    let mut list = locked(&LISTED);
    list.remove_all();
    std::mem::forget(list);
}

/// [`remove_all`] where memory has run out: nothing is allocated, and the list is waited for only briefly, since this
/// thread itself may hold it.
pub(crate) fn remove_all_without_memory() {
    for _ in 0..LOCK_TRIES {
        if let Ok(mut list) = LISTED.try_lock() {
            list.remove_from_disk();
            // Another thread may have listed a file and be about to create it.
            thread::sleep(LOOK_INTERVAL);
            list.remove_all();
            std::mem::forget(list);
            return;
        }
        thread::sleep(LOOK_INTERVAL);
    }
}

/// A file or folder that is removed when this is dropped.
#[derive(Debug)]
pub(crate) struct Temporary {
    listed: Listed,
    path: PathBuf,
}

impl Temporary {
    /// The file at `path`, which is made after this.
    pub(crate) fn file(path: &Path) -> Self {
        Self::of(path, Entry::File)
    }

    /// A new folder, removed while it is empty.
    pub(crate) fn folder(path: &Path) -> Self {
        Self::of(path, Entry::Folder)
    }

    /// A new folder, removed with all that is in it.
    pub(crate) fn folder_and_contents(path: &Path) -> Self {
        Self::of(path, Entry::FolderAndContents)
    }

    fn of(path: &Path, entry: fn(PathBuf) -> Entry) -> Self {
        Self {
            listed: locked(&LISTED).add(entry(path.to_owned())),
            path: path.to_owned(),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Renames the file to `target`, replacing any existing file of that name: it is temporary no longer.
    pub(crate) fn rename(&self, target: &Path) -> io::Result<()> {
        let mut list = locked(&LISTED);
        // While the list is locked: a signal finds either the hidden file or the finished one.
        fs::rename(&self.path, target)?;
        list.entries.remove(&self.listed.0);
        Ok(())
    }

    /// Leaves it where it is.
    pub(crate) fn keep(self) {
        locked(&LISTED).entries.remove(&self.listed.0);
    }
}

/// Another program that writes for this one. It is killed when this is dropped, and when this process is ended. It
/// inherits that signals are blocked (`signals.rs`): Ctrl+C reaches it through this process alone.
#[derive(Debug)]
pub(crate) struct Helper {
    _listed: Listed,
    child: Arc<Mutex<Child>>,
}

impl Helper {
    /// Starts it.
    pub(crate) fn spawn(command: &mut Command) -> io::Result<Self> {
        let mut list = locked(&LISTED);
        let child = Arc::new(Mutex::new(command.spawn()?));
        let listed = list.add(Entry::Helper(Arc::clone(&child)));
        Ok(Self { _listed: listed, child })
    }

    /// The process, for its pipes. It must not be waited for under this lock.
    pub(crate) fn child(&self) -> MutexGuard<'_, Child> {
        locked(&self.child)
    }

    /// Waits until it has ended. A signal can kill it meanwhile.
    pub(crate) fn wait(&self) -> io::Result<ExitStatus> {
        loop {
            if let Some(status) = self.child().try_wait()? {
                return Ok(status);
            }
            thread::sleep(LOOK_INTERVAL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_files_are_removed_and_renamed_or_retained_ones_stay() {
        let folder = tempfile::tempdir().unwrap();
        let [dropped, hidden, named, retained] =
            ["dropped", ".hidden", "named", "kept"].map(|name| folder.path().join(name));
        let temporaries = [&dropped, &hidden, &retained].map(|path| {
            let temporary = Temporary::file(path);
            fs::write(path, "bytes").unwrap();
            temporary
        });
        let [at_dropped, at_hidden, at_retained] = temporaries;
        at_hidden.rename(&named).unwrap();
        // By now it is someone else's file.
        fs::write(&hidden, "of others").unwrap();
        at_retained.keep();
        drop((at_dropped, at_hidden));
        let is_there = [&dropped, &hidden, &named, &retained].map(|path| path.exists());
        assert_eq!(is_there, [false, true, true, true]);
    }

    #[test]
    fn a_folder_with_a_file_in_it_is_not_removed() {
        let folder = tempfile::tempdir().unwrap();
        let [empty, full, whole] = ["empty", "full", "whole"].map(|name| folder.path().join(name));
        let temporaries = (
            Temporary::folder(&empty),
            Temporary::folder(&full),
            Temporary::folder_and_contents(&whole),
        );
        for path in [&empty, &full, &whole] {
            fs::create_dir(path).unwrap();
        }
        fs::write(full.join("frame.png"), "").unwrap();
        fs::write(whole.join("report.json"), "").unwrap();
        drop(temporaries);
        assert_eq!([&empty, &full, &whole].map(|path| path.exists()), [false, true, false]);
    }

    #[cfg(unix)]
    #[test]
    fn a_helper_process_ends_with_its_owner() {
        let helper = Helper::spawn(Command::new("sleep").arg("600")).unwrap();
        let child = Arc::clone(&helper.child);
        assert!(locked(&child).try_wait().unwrap().is_none());
        drop(helper);
        assert!(locked(&child).try_wait().unwrap().is_some());
    }
}
