//! Code shared by the targets.

use std::path::{Path, PathBuf};

/// Crates whose panics the readers catch.
const CAUGHT: [&str; 2] = ["/laz-", "/draco-core-"];

/// A panic that the readers catch is a refusal like any other; every other one ends the run as a finding.
pub fn let_caught_panics_pass() {
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let file = panic.location().map_or("", |place| place.file());
        if !CAUGHT.iter().any(|name| file.contains(name)) {
            abort(panic);
        }
    }));
}

/// Memory that looks like a disk, where there is such.
pub fn memory_folder() -> PathBuf {
    let folder = Path::new("/dev/shm");
    if folder.is_dir() { folder.to_owned() } else { std::env::temp_dir() }
}

/// Hands a file of these bytes to `read`.
pub fn with_file(extension: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    let name = format!("pointreel-fuzz-{}.{extension}", std::process::id());
    let path = memory_folder().join(name);
    if std::fs::write(&path, bytes).is_ok() {
        read(&path);
    }
    let _ = std::fs::remove_file(&path);
}
