//! Shader hot reload: shaders of a development build are re-read when they change: if `POINTREEL_SHADERS` names a
//! folder, files in it replace those that were compiled in. Other builds have the latter alone.

use super::shader_file::ShaderFile;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Polling interval: the maximum time for which changes may go unnoticed.
const PERIOD: Duration = Duration::from_millis(300);

/// The folder, if there is one.
fn folder() -> Option<PathBuf> {
    let is_development = cfg!(debug_assertions);
    let named = is_development.then(|| std::env::var_os("POINTREEL_SHADERS"));
    named.flatten().map(PathBuf::from)
}

/// The text of a file.
pub(super) fn text_of(file: &ShaderFile) -> Cow<'static, str> {
    let read = folder().and_then(|folder| std::fs::read_to_string(folder.join(file.name)).ok());
    read.map_or(Cow::Borrowed(file.text), Cow::Owned)
}

/// Notices that a file of the folder has changed.
#[derive(Debug)]
pub(super) struct Watch {
    folder: PathBuf,
    newest: Option<SystemTime>,
    looked: Instant,
}

impl Watch {
    /// `None` where there is nothing to watch.
    pub(super) fn begin() -> Option<Self> {
        folder().map(Self::of)
    }

    fn of(folder: PathBuf) -> Self {
        Self {
            newest: newest(&folder),
            folder,
            looked: Instant::now(),
        }
    }

    /// Returns true if files have changed since the last call.
    pub(super) fn has_news(&mut self) -> bool {
        if self.looked.elapsed() < PERIOD {
            return false;
        }
        self.looked = Instant::now();
        self.has_changed()
    }

    fn has_changed(&mut self) -> bool {
        let newest = newest(&self.folder);
        let has_news = newest != self.newest;
        self.newest = newest;
        has_news
    }
}

/// Time of the last change of a file in a folder, or in one below it.
fn newest(folder: &Path) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let times = entries.filter_map(|entry| {
        let kind = entry.file_type().ok()?;
        if kind.is_dir() {
            return newest(&entry.path());
        }
        entry.metadata().ok()?.modified().ok()
    });
    times.max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{self, File};

    #[test]
    fn a_rewritten_file_is_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("effects/tone.wgsl");
        fs::create_dir(folder.path().join("effects")).unwrap();
        fs::write(&file, "fn first() {}").unwrap();
        let mut watch = Watch::of(folder.path().to_owned());
        assert!(!watch.has_changed());
        let later = SystemTime::now() + Duration::from_mins(1);
        File::options()
            .write(true)
            .open(&file)
            .unwrap()
            .set_modified(later)
            .unwrap();
        assert!(watch.has_changed());
        assert!(!watch.has_changed());
    }
}
