//! Paths of a session, relative to its folder, which may be moved to another place or machine with its content.
//!
//! How it works: paths that share a folder with the session below the root become relative, with `/` between names on
//! every system; others stay absolute. Words that are not files (`demo:`, `http://`, `udp://`) stay as they are.

use super::SessionError;
use crate::source;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// `input` as a session in `folder` holds it; absolute without a folder.
pub(super) fn as_text(input: &Path, folder: Option<&Path>) -> Result<String, SessionError> {
    let no_text = || SessionError::Name {
        input: input.to_owned(),
    };
    let text = input.to_str().ok_or_else(no_text)?;
    if is_word(text) {
        return Ok(text.to_owned());
    }
    if let Some(names) = folder.and_then(|folder| from_folder(input, folder)) {
        let names = names.iter().map(|name| name.to_str());
        let names: Option<Vec<&str>> = names.collect();
        return names.map(|names| names.join("/")).ok_or_else(no_text);
    }
    let absolute = std::path::absolute(input).unwrap_or_else(|_| input.to_owned());
    absolute.to_str().map(str::to_owned).ok_or_else(no_text)
}

/// Resolves the path `text` of a session in `folder`.
pub(super) fn joined(folder: &Path, text: &str) -> PathBuf {
    if is_word(text) {
        return text.into();
    }
    match text {
        // The folder itself, which may be empty for the current folder.
        "." if folder.as_os_str().is_empty() => ".".into(),
        "." => folder.to_owned(),
        // An absolute path replaces the one that it is joined to.
        text => folder.join(text),
    }
}

/// Returns true if `text` names an input that is not a file.
pub(super) fn is_word(text: &str) -> bool {
    source::is_address(text) || source::is_word(Path::new(text))
}

/// The names of the path from `folder` to `input`, `..` for each folder up; `None` if they share no folder but the
/// root.
fn from_folder(input: &Path, folder: &Path) -> Option<Vec<OsString>> {
    // The folder of a bare file name is the current folder.
    let from = if folder.as_os_str().is_empty() {
        std::env::current_dir().ok()?
    } else {
        std::path::absolute(folder).ok()?
    };
    let to = std::path::absolute(input).ok()?;
    // The parent of a link cannot be determined from names.
    let is_plain = |path: &Path| !path.components().any(|part| part == Component::ParentDir);
    if !is_plain(&from) || !is_plain(&to) {
        return None;
    }
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b);
    let is_name = |part: &Component<'_>| matches!(part, Component::Normal(_));
    let shared: Vec<Component<'_>> = shared.map(|(part, _)| part).collect();
    if !shared.iter().any(is_name) {
        return None;
    }
    let up = from.components().count() - shared.len();
    let down = to.components().skip(shared.len());
    let mut names = vec![OsString::from(".."); up];
    names.extend(down.map(|part| part.as_os_str().to_owned()));
    if names.is_empty() {
        names.push(".".into());
    }
    Some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_near_the_session_are_stored_relative_to_it() {
        for (input, folder, expected) in [
            ("/data/walk/scans", "/data/walk", "scans"),
            ("/data/walk", "/data/walk", "."),
            ("/data/other/f_*.ply", "/data/walk/sessions", "../../other/f_*.ply"),
            ("/elsewhere/a.ply", "/data/walk", "/elsewhere/a.ply"),
            ("/data/x/../a.ply", "/data/walk", "/data/x/../a.ply"),
            ("demo:", "/data/walk", "demo:"),
            ("torus:2000", "/data/walk", "torus:2000"),
            ("example:lidar", "/data/walk", "example:lidar"),
            ("http://127.0.0.1:80/a.reel", "/data/walk", "http://127.0.0.1:80/a.reel"),
            ("udp://:2368", "/data", "udp://:2368"),
        ] {
            let (input, folder) = (Path::new(input), Path::new(folder));
            if cfg!(windows) && input.has_root() {
                continue;
            }
            let text = as_text(input, Some(folder)).unwrap();
            assert_eq!(text, expected);
            let there = joined(folder, &text);
            let same = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
            if !text.starts_with("..") {
                assert_eq!(same(&there), same(input));
            }
        }
    }

    #[test]
    fn relative_inputs_are_resolved_from_another_folder() {
        // From where the test runs.
        let here = std::env::current_dir().unwrap();
        let text = as_text(Path::new("scans/a.ply"), Some(&here.join("sessions"))).unwrap();
        assert_eq!(text, "../scans/a.ply");
        let text = as_text(Path::new("scans"), Some(Path::new(""))).unwrap();
        assert_eq!(text, "scans");
        let text = as_text(Path::new("scans"), None).unwrap();
        assert_eq!(Path::new(&text), here.join("scans"));
        assert_eq!(joined(Path::new(""), "scans"), Path::new("scans"));
        assert_eq!(joined(Path::new(""), "."), Path::new("."));
    }

    #[cfg(unix)]
    #[test]
    fn a_non_utf8_name_is_rejected() {
        use std::os::unix::ffi::OsStrExt as _;
        let input = Path::new("/data").join(std::ffi::OsStr::from_bytes(b"scan\xff"));
        let error = as_text(&input, Some(Path::new("/data"))).unwrap_err().to_string();
        assert!(error.contains("rename it"), "{error}");
    }
}
