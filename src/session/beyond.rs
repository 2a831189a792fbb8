//! What a session names beyond its folder: addresses, and files elsewhere.
//!
//! **How it works.** Inputs, what is beside them, poses, intrinsics and the picture around the scene are looked at
//! before any of them is opened. A word with `://` is an address. Of other paths the longest part that is there is
//! followed through all links, and compared with the folder of the session as it really is; what is behind that part (a
//! pattern, a file that is not there) must not lead up. Words such as `demo:` are no files.

use super::file::ReadSession;
use super::paths::is_word;
use super::reach::Beyond;
use super::{Session, SessionError};
use crate::scene::Environment;
use crate::source::SessionReach;
use std::path::{Component, Path};

impl ReadSession {
    /// What it would open that `reach` does not allow.
    pub fn beyond(&self, reach: SessionReach) -> Beyond {
        beyond(&self.session, &self.file, reach)
    }

    /// Fails if it would open what `reach` does not allow.
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

fn beyond(session: &Session, file: &Path, reach: SessionReach) -> Beyond {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let compared = session
        .compare
        .iter()
        .flat_map(|compared| compared.inputs.iter().cloned());
    let environment = match session.settings.light.environment {
        Environment::File(file) => Some(file.path()),
        _ => None,
    };
    let inputs = session.inputs.iter().cloned();
    let named = inputs.chain(compared).chain(session.reading.files()).chain(environment);
    let mut beyond = Beyond::default();
    for path in named {
        match path.to_str() {
            Some(text) if text.contains("://") => {
                if !reach.network && !beyond.addresses.iter().any(|known| known == text) {
                    beyond.addresses.push(text.to_owned());
                }
            }
            Some(text) if is_word(text) => {}
            _ => {
                if !reach.outside && !is_inside(&path, folder) && !beyond.outside.contains(&path) {
                    beyond.outside.push(path);
                }
            }
        }
    }
    beyond
}

/// Whether `path` is in or below `folder`, through all links.
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
        // A link that leads nowhere now may lead elsewhere later.
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
    fn addresses_are_named_with_the_option() {
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
        let beside = read(folder.path(), "[\"demo:\"]", r#", "compare": {"files": ["tcp://a:1"]}"#);
        assert_eq!(beside.beyond(SessionReach::default()).addresses, ["tcp://a:1"]);
        assert!(beside.check_reach(SessionReach::ANYWHERE).is_ok());
    }

    #[test]
    fn files_outside_are_named_and_those_inside_open() {
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
        for input in ["link", "link/x.ply", "dead.ply"] {
            let session = read(&folder, &format!("[\"{input}\"]"), "");
            assert_eq!(session.beyond(SessionReach::default()).outside.len(), 1, "{input}");
        }
    }
}
