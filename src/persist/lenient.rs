//! Lenient reading of user-owned files, as far as they can be read.
//!
//! **How it works.** Such a file outlives program versions. Its JSON object is read field by field ([`fields`]): fields
//! that are missing, or have a value that cannot be read, take their defaults; unknown names are ignored. The reader
//! notes in a list everything that could not be read. If the list is not empty, the file is first copied to a sidecar
//! file ([`read_leniently`]), since the next change rewrites it. A file that cannot be copied is not overwritten.

use super::{read, write_whole};
use crate::regular_file;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// The object that a file holds.
pub(crate) type Fields = Map<String, Value>;

/// Maximum number of copies of one file. With this many there is a fault that another copy does not mend.
const MAX_COPIES: u32 = 99;

/// Maximum number of reasons in the text of a notice.
const MAX_REASONS: usize = 3;

/// Result of reading a file leniently.
#[derive(Debug)]
pub(crate) struct Lenient<T> {
    /// Value with everything that could be read, and defaults for the rest.
    pub(crate) value: T,
    /// Problem report for a notice: the parts that could not be read, and the location of the copy.
    pub(crate) problem: Option<String>,
    /// The file, if it may be replaced.
    pub(crate) file: Option<PathBuf>,
}

/// Reads as much of `file` as possible; the file need not exist. `parse` is given its object and notes in the list the
/// parts that it could not read. `what` is the name used in a notice for the things in it.
pub(crate) fn read_leniently<T: Default>(
    file: &Path,
    what: &str,
    parse: impl FnOnce(&Fields, &mut Vec<String>) -> T,
) -> Lenient<T> {
    let mut unread = Vec::new();
    let object = read(file).and_then(|bytes| match bytes {
        Some(bytes) => serde_json::from_slice(&bytes).map_err(|reason| reason.to_string()),
        None => Ok(None),
    });
    let value = match object {
        Ok(Some(object)) => parse(&object, &mut unread),
        Ok(None) => T::default(),
        Err(reason) => {
            unread.push(reason);
            T::default()
        }
    };
    let (problem, file) = if unread.is_empty() {
        (None, Some(file.to_owned()))
    } else {
        let (problem, file) = copied(file, what, &in_short(&unread));
        (Some(problem), file)
    };
    Lenient { value, problem, file }
}

/// Copies `file`, which is only partly readable. Returns the text for a notice, and the file if it was copied.
fn copied(file: &Path, what: &str, reasons: &str) -> (String, Option<PathBuf>) {
    let unread = format!("Not all of {what} in {} can be read ({reasons})", file.display());
    match copy_alongside(file) {
        Ok(copy) => (
            format!("{unread}: the file as it is was copied to {}", copy.display()),
            Some(file.to_owned()),
        ),
        Err(reason) => (
            format!("{unread}, nor can the file be copied ({reason}): it stays as it is, and changes are not kept"),
            None,
        ),
    }
}

/// The fields of `T` that `stored` has, each by itself: unreadable ones get the default and are noted in `unread`. `T`
/// must take defaults for missing fields (`#[serde(default)]`).
pub(crate) fn fields<T: DeserializeOwned + Default>(stored: &Fields, unread: &mut Vec<String>) -> T {
    let mut readable = stored.clone();
    retain_readable::<T>(&mut readable, unread);
    serde_json::from_value(Value::Object(readable)).unwrap_or_else(|reason| {
        unread.push(reason.to_string());
        T::default()
    })
}

/// Removes fields of `stored` that `T` cannot be read of, and notes them in `unread`. Those that `T` does not know
/// stay.
pub(crate) fn retain_readable<T: DeserializeOwned>(stored: &mut Fields, unread: &mut Vec<String>) {
    stored.retain(|name, value| {
        let alone = Fields::from_iter([(name.clone(), value.clone())]);
        let read = serde_json::from_value::<T>(Value::Object(alone));
        if let Err(reason) = &read {
            unread.push(format!("{name}: {reason}"));
        }
        read.is_ok()
    });
}

/// The entries of the list `name` in `stored`; none, which is noted, if it is not a list. A missing list has none.
pub(crate) fn entries<'a>(stored: &'a Fields, name: &str, unread: &mut Vec<String>) -> &'a [Value] {
    match stored.get(name) {
        Some(Value::Array(entries)) => entries,
        Some(_) => {
            unread.push(format!("{name}: it is not a list"));
            &[]
        }
        None => &[],
    }
}

/// Notes if `stored` is of a later version than `known`: its contents may mean something else.
pub(crate) fn note_later_version(stored: &Fields, known: u32, unread: &mut Vec<String>) {
    let version = stored.get("version").and_then(Value::as_u64);
    if let Some(version) = version.filter(|&version| version > u64::from(known)) {
        unread.push(format!("it has version {version}, this program knows {known}"));
    }
}

fn in_short(reasons: &[String]) -> String {
    let shown = &reasons[..reasons.len().min(MAX_REASONS)];
    let text = shown.join("; ");
    match reasons.len() - shown.len() {
        0 => text,
        more => format!("{text}; {more} more"),
    }
}

/// Copies `file` to the first of `name.unreadable`, `name.unreadable-2` and so on that is free, or has the same bytes
/// already.
pub(crate) fn copy_alongside(file: &Path) -> std::io::Result<PathBuf> {
    let bytes = regular_file::read(file)?;
    for number in 1..=MAX_COPIES {
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(".unreadable");
        if number > 1 {
            name.push(format!("-{number}"));
        }
        let copy = file.with_file_name(name);
        match regular_file::read(&copy) {
            Ok(there) if there == bytes => return Ok(copy),
            Err(reason) if reason.kind() == ErrorKind::NotFound => {
                write_whole(&copy, &bytes)?;
                return Ok(copy);
            }
            // Something else has this name, and is left alone.
            Ok(_) | Err(_) => {}
        }
    }
    Err(Error::other(format!("there are {MAX_COPIES} copies of it")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use std::fs;

    #[derive(Debug, Default, PartialEq, Deserialize)]
    #[serde(default)]
    struct Few {
        edge: u32,
        name: String,
    }

    fn read_few(file: &Path) -> Lenient<Few> {
        read_leniently(file, "the settings", |stored, unread| {
            note_later_version(stored, 3, unread);
            fields(stored, unread)
        })
    }

    fn few(edge: u32, name: &str) -> Few {
        let name = name.to_owned();
        Few { edge, name }
    }

    #[test]
    fn each_field_is_read_independently() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("few.json");
        for (text, expected, is_whole) in [
            (r#"{"edge": 3, "name": "a"}"#, few(3, "a"), true),
            (r#"{"name": "a", "version": 3}"#, few(0, "a"), true),
            (r#"{"edge": 3, "later": [1]}"#, few(3, ""), true),
            (r#"{"edge": "three", "name": "a"}"#, few(0, "a"), false),
            (r#"{"edge": 3, "version": 4}"#, few(3, ""), false),
            (r"[]", few(0, ""), false),
            (r#"{"edge": 3"#, few(0, ""), false),
        ] {
            fs::write(&file, text).unwrap();
            let read = read_few(&file);
            assert_eq!(read.value, expected, "{text}");
            assert_eq!(read.problem.is_none(), is_whole, "{text}: {read:?}");
            assert_eq!(read.file.as_ref(), Some(&file), "{text}");
        }
    }

    #[test]
    fn unreadable_files_are_backed_up_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("few.json");
        let copies = || fs::read_dir(folder.path()).unwrap().count() - 1;
        for (text, name) in [
            ("{", "few.json.unreadable"),
            ("{", "few.json.unreadable"),
            ("[", "few.json.unreadable-2"),
            ("{", "few.json.unreadable"),
        ] {
            fs::write(&file, text).unwrap();
            let problem = read_few(&file).problem.unwrap();
            let copy = folder.path().join(name);
            assert!(problem.ends_with(&copy.display().to_string()), "{problem}");
            assert_eq!(fs::read_to_string(copy).unwrap(), text);
        }
        assert_eq!(copies(), 2);
        fs::write(&file, "{}").unwrap();
        assert!(read_few(&file).problem.is_none());
        assert_eq!(copies(), 2);
    }

    #[test]
    fn files_that_cannot_be_backed_up_are_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let read = read_few(folder.path());
        assert_eq!(read.file, None);
        assert!(read.problem.unwrap().contains("changes are not kept"));
        // Without a file, nothing can be lost.
        let file = folder.path().join("deeper/few.json");
        let read = read_few(&file);
        assert_eq!((read.value, read.problem), (few(0, ""), None));
        assert_eq!(read.file, Some(file));
    }

    #[test]
    fn the_notice_lists_the_first_reasons() {
        let reasons: Vec<String> = (0..5).map(|number| format!("r{number}")).collect();
        assert_eq!(in_short(&reasons[..2]), "r0; r1");
        assert_eq!(in_short(&reasons), "r0; r1; r2; 2 more");
    }
}
