//! External references of a session, beyond its folder: addresses, and files elsewhere.
//!
//! **How it works.** Inputs, compared sequences, poses, intrinsics and the environment map are checked before any of
//! them is opened. A word with `://` is an address. Of other paths the longest existing prefix is resolved through all
//! links, and compared with the real path of the session's folder; the remainder (a pattern, a file that does not
//! exist) must not lead up. The same goes for all files of a pattern, and all links in or below a folder. Words such as
//! `demo:` are not files.

use super::file::ReadSession;
use super::paths::is_word;
use super::reach::Beyond;
use super::{Document, SessionError};
use crate::scene::Environment;
use crate::source::{SessionReach, is_address};
use std::path::{Component, Path};

impl ReadSession {
    /// Returns the external references that the session would open and that `reach` does not allow.
    pub fn beyond(&self, reach: SessionReach) -> Beyond {
        beyond(&self.document, &self.file, reach)
    }

    /// Fails if the document would open anything that `reach` does not allow.
    ///
    /// # Errors
    /// [`SessionError::Beyond`].
    pub fn check_reach(&self, reach: SessionReach) -> Result<(), SessionError> {
        let beyond = self.beyond(reach);
        if beyond.is_empty() {
            return Ok(());
        }
        Err(SessionError::Beyond {
            file: self.file.clone(),
            beyond,
        })
    }
}

fn beyond(document: &Document, file: &Path, reach: SessionReach) -> Beyond {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let compared = document
        .compare
        .iter()
        .flat_map(|compared| compared.inputs.iter().cloned());
    let environment = match document.settings.light.environment {
        Environment::File(file) => Some(file.path()),
        _ => None,
    };
    let inputs = document.inputs.iter().cloned();
    let named = inputs
        .chain(compared)
        .chain(document.reading.files())
        .chain(environment);
    let mut beyond = Beyond::default();
    for path in named {
        match path.to_str() {
            Some(text) if is_address(text) => {
                if !reach.network && !beyond.addresses.iter().any(|known| known == text) {
                    beyond.addresses.push(text.to_owned());
                }
            }
            Some(text) if is_word(text) => {}
            _ => {
                if !reach.outside && !stays_inside(&path, folder) && !beyond.outside.contains(&path) {
                    beyond.outside.push(path);
                }
            }
        }
    }
    beyond
}

/// Folders below one another in which links are looked for: more than frames are looked for.
const MAX_DEPTH: usize = 16;

/// Entries of folders that are looked through. A folder of more is asked about, as if it were elsewhere.
const MAX_ENTRIES: usize = 500_000;

/// Returns true if everything that is read for `path`, a file, folder or pattern, is in or below `folder`.
fn stays_inside(path: &Path, folder: &Path) -> bool {
    let mut left = MAX_ENTRIES;
    let mut is_all_inside = |path: &Path| is_inside(path, folder) && has_no_way_out(path, folder, MAX_DEPTH, &mut left);
    if !is_all_inside(path) {
        return false;
    }
    let is_pattern = |text: &&str| !path.exists() && text.contains(['*', '?', '[']);
    match path.to_str().filter(is_pattern).map(glob::glob) {
        // A path that cannot be read is not opened.
        Some(Ok(matches)) => matches.flatten().all(|path| is_all_inside(&path)),
        // Not a pattern, or an invalid one.
        None | Some(Err(_)) => true,
    }
}

/// Returns true if no link in or below `path` leads out of `folder`; `left` counts the entries that may still be
/// visited.
fn has_no_way_out(path: &Path, folder: &Path, depth: usize, left: &mut usize) -> bool {
    let Ok(entries) = path.read_dir() else {
        return true;
    };
    for entry in entries.flatten() {
        let Some(fewer) = left.checked_sub(1) else {
            return false;
        };
        *left = fewer;
        let (path, kind) = (entry.path(), entry.file_type());
        let is_link = kind.as_ref().is_ok_and(std::fs::FileType::is_symlink);
        if is_link && !is_inside(&path, folder) {
            return false;
        }
        let is_folder = kind.is_ok_and(|kind| kind.is_dir());
        if is_folder && depth > 0 && !has_no_way_out(&path, folder, depth - 1, left) {
            return false;
        }
    }
    true
}

/// Returns true if `path`, with all links resolved, is in or below `folder`.
fn is_inside(path: &Path, folder: &Path) -> bool {
    let Ok(folder) = folder.canonicalize() else {
        return false;
    };
    let mut there = path;
    let real = loop {
        let here = if there.as_os_str().is_empty() {
            Path::new(".")
        } else {
            there
        };
        if let Ok(real) = here.canonicalize() {
            break real;
        }
        // A dangling link may lead elsewhere later.
        if here.symlink_metadata().is_ok_and(|metadata| metadata.is_symlink()) {
            return false;
        }
        match there.parent() {
            Some(above) => there = above,
            None => return false,
        }
    };
    let leads_up = path
        .strip_prefix(there)
        .is_ok_and(|rest| rest.components().any(|part| part == Component::ParentDir));
    real.starts_with(folder) && !leads_up
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::path::PathBuf;

    fn read(folder: &Path, files: &str, more: &str) -> ReadSession {
        let text = format!(r#"{{"pointreel_session": 1, "files": {files}{more}}}"#);
        ReadSession::of_text(text.as_bytes(), &folder.join("a.pointreel")).unwrap()
    }

    #[test]
    fn addresses_are_reported_with_the_option() {
        let folder = tempfile::tempdir().unwrap();
        for address in ["tcp://127.0.0.1:1", "udp://:19368", "http://127.0.0.1/a.reel"] {
            let session = read(folder.path(), &format!("[\"{address}\"]"), "");
            let reason = session.check_reach(SessionReach::default()).unwrap_err().to_string();
            assert!(
                reason.contains(address) && reason.contains("--allow-network"),
                "{reason}"
            );
            let network = SessionReach {
                network: true,
                outside: false,
            };
            assert!(session.check_reach(network).is_ok());
        }
        let adjacent = read(folder.path(), "[\"demo:\"]", r#", "compare": {"files": ["tcp://a:1"]}"#);
        assert_eq!(adjacent.beyond(SessionReach::default()).addresses, ["tcp://a:1"]);
        assert!(adjacent.check_reach(SessionReach::ANYWHERE).is_ok());
    }

    #[test]
    fn outside_files_are_reported_and_inside_ones_open() {
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("walk");
        fs::create_dir_all(folder.join("scans")).unwrap();
        fs::write(above.path().join("secret.xyz"), "0 0 0").unwrap();
        for inside in [
            ".",
            "scans",
            "scans/f_*.ply",
            "scans/missing/f.ply",
            "demo:",
            "torus:2000",
            "./scans/../scans",
        ] {
            let session = read(&folder, &format!("[\"{inside}\"]"), "");
            assert_eq!(session.beyond(SessionReach::default()), Beyond::default(), "{inside}");
        }
        for outside in [
            "../secret.xyz",
            "..",
            "/etc/hostname",
            "scans/../../secret.xyz",
            "missing/../../secret.xyz",
        ] {
            let session = read(&folder, &format!("[\"{outside}\"]"), "");
            let beyond = session.beyond(SessionReach::default());
            assert_eq!(beyond.outside.len(), 1, "{outside}");
            let reason = session.check_reach(SessionReach::default()).unwrap_err().to_string();
            assert!(
                reason.contains("--allow-outside") && !reason.contains("network"),
                "{reason}"
            );
        }
        let poses = read(&folder, "[\"scans\"]", r#", "reading": {"poses": "../poses.txt"}"#);
        assert_eq!(poses.beyond(SessionReach::default()).outside.len(), 1);
        let settings = r#", "settings": {"environment": "/tmp/elsewhere/sky.hdr"}"#;
        let around = read(&folder, "[\"scans\"]", settings).beyond(SessionReach::default());
        assert_eq!(around.outside, [PathBuf::from("/tmp/elsewhere/sky.hdr")]);
        let numbers = read(
            &folder,
            "[\"scans\"]",
            r#", "reading": {"intrinsics": "1,2,3,4", "poses": "none"}"#,
        );
        assert!(numbers.beyond(SessionReach::default()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed() {
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("walk");
        fs::create_dir(&folder).unwrap();
        std::os::unix::fs::symlink(above.path(), folder.join("link")).unwrap();
        std::os::unix::fs::symlink("/nowhere/at/all", folder.join("dead.ply")).unwrap();
        fs::write(above.path().join("secret.ply"), "").unwrap();
        fs::create_dir_all(folder.join("below/deeper")).unwrap();
        fs::create_dir_all(folder.join("fine")).unwrap();
        fs::write(folder.join("fine/a.ply"), "").unwrap();
        std::os::unix::fs::symlink("a.ply", folder.join("fine/b.ply")).unwrap();
        std::os::unix::fs::symlink(above.path().join("secret.ply"), folder.join("below/deeper/f_0.ply")).unwrap();
        for input in [
            "link",
            "link/x.ply",
            "dead.ply",
            "*/secret.ply",
            "**/secret.ply",
            "lin?/secret.ply",
            "[l]ink/secret.ply",
            "below",
            "below/deeper/*.ply",
            ".",
        ] {
            let session = read(&folder, &format!("[\"{input}\"]"), "");
            assert_eq!(session.beyond(SessionReach::default()).outside.len(), 1, "{input}");
        }
        for input in ["fine", "fine/*.ply", "f*/b.ply"] {
            let session = read(&folder, &format!("[\"{input}\"]"), "");
            assert!(session.beyond(SessionReach::default()).is_empty(), "{input}");
        }
    }
}
