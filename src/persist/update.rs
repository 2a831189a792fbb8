//! Changes of a persisted file by one of several processes that have it open.
//!
//! **How it works.** No process writes out its in-memory state: the file is re-read, the local changes are applied to
//! it, and the file is replaced, while the other processes wait ([`exclusive`]). So a window that saves later undoes
//! nothing of another one, and additions by a later version are preserved. Objects with one field per setting are
//! merged ([`merge`]): a value counts as changed here if it differs from what this process began with.

use super::lenient::{Fields, copy_alongside};
use super::{read, replace};
use serde_json::Value;
use std::fs::{self, File, TryLockError};
use std::io::Error;
use std::path::Path;
use std::thread;
use std::time::Duration;

/// Longest time that another process may take to replace a file (timeout). One that was stopped does not stop this one.
const PATIENCE: Duration = Duration::from_millis(500);
const LOOK_INTERVAL: Duration = Duration::from_millis(5);

/// Reads the object in `file`, has `change` change it, and writes it. `change` notes in the list the parts that it
/// could not read: then, and if it is not an object at all, the file is first copied to a name next to it, and the log
/// names the copy. Without a file, an empty object is changed.
///
/// # Errors
/// An error if it cannot be copied or written: the file stays as it is.
pub(crate) fn update(
    file: &Path,
    what: &str,
    change: impl FnOnce(&mut Fields, &mut Vec<String>),
) -> std::io::Result<()> {
    let pretty = |fields: &Fields| serde_json::to_vec_pretty(fields).map_err(Error::other);
    update_as(file, what, pretty, change)
}

/// [`update`], with the text of the file made by `layout`.
///
/// # Errors
/// As [`update`], and the errors of `layout`.
pub(crate) fn update_as(
    file: &Path,
    what: &str,
    layout: impl FnOnce(&Fields) -> std::io::Result<Vec<u8>>,
    change: impl FnOnce(&mut Fields, &mut Vec<String>),
) -> std::io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    // Several windows share the file: re-reading, changing and replacing it are one step, and unknown fields are
    // preserved.
    let _exclusive = exclusive(file);
    let mut unread = Vec::new();
    let mut fields = match read(file) {
        Ok(None) => Fields::new(),
        Ok(Some(bytes)) => serde_json::from_slice(&bytes).unwrap_or_else(|reason| {
            unread.push(reason.to_string());
            Fields::new()
        }),
        Err(reason) => return Err(Error::other(reason)),
    };
    change(&mut fields, &mut unread);
    if !unread.is_empty() {
        let copy = copy_alongside(file)?;
        log::warn!(
            "not all of {what} in {} can be read ({}): the file as it was is {}",
            file.display(),
            unread.join("; "),
            copy.display()
        );
    }
    replace(file, &layout(&fields)?)
}

/// Keeps other processes from an [`update`] of the files in the folder of `file` until the answer is dropped; `None`
/// where folders cannot be locked, or another process holds one for too long: then the time between reading and writing
/// is short.
fn exclusive(file: &Path) -> Option<File> {
    let folder = File::open(file.parent()?).ok()?;
    for _ in 0..PATIENCE.as_millis() / LOOK_INTERVAL.as_millis() {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) => thread::sleep(LOOK_INTERVAL),
            Err(TryLockError::Error(_)) => return None,
        }
    }
    None
}

/// Puts into `stored` the values that differ between `before` and `now`, and those missing from it. Objects are merged
/// field by field.
pub(crate) fn merge(stored: &mut Fields, before: &Fields, now: &Fields) {
    for (name, value) in now {
        let was = before.get(name);
        match (stored.get_mut(name), value) {
            (Some(Value::Object(stored)), Value::Object(now)) => {
                let none = Fields::new();
                let was = was.and_then(Value::as_object).unwrap_or(&none);
                merge(stored, was, now);
            }
            (Some(_), _) if was == Some(value) => {}
            _ => {
                stored.insert(name.clone(), value.clone());
            }
        }
    }
    // Values that are no longer set, such as an unknown window size.
    for name in before.keys().filter(|name| !now.contains_key(*name)) {
        stored.remove(name);
    }
}

/// Keeps those entries of the list `name` in `stored` that `is_readable`, with everything else they hold. Removed
/// entries, and a value that is not a list, are noted.
pub(crate) fn readable_entries(
    stored: &Fields,
    name: &str,
    unread: &mut Vec<String>,
    is_readable: impl Fn(&Value) -> bool,
) -> Vec<Value> {
    let mut entries = super::entries(stored, name, unread).to_vec();
    entries.retain(|entry| {
        let keeps = is_readable(entry);
        if !keeps {
            unread.push(format!("{name}: an entry cannot be read"));
        }
        keeps
    });
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn fields(value: &Value) -> Fields {
        value.as_object().unwrap().clone()
    }

    #[test]
    fn changes_of_another_process_are_preserved() {
        let before = fields(&json!({"speed": 1, "light": {"ao": true, "gain": 1}, "size": [1, 2]}));
        let mut stored = fields(&json!({"speed": 2, "light": {"ao": true, "gain": 3, "later": 0}, "of later": 1}));
        let now = fields(&json!({"speed": 1, "light": {"ao": false, "gain": 1}}));
        merge(&mut stored, &before, &now);
        let expected = json!({"speed": 2, "light": {"ao": false, "gain": 3, "later": 0}, "of later": 1});
        assert_eq!(Value::Object(stored), expected);
    }

    #[test]
    fn concurrent_processes_lose_no_changes() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("list.json");
        thread::scope(|scope| {
            for writer in 0..4 {
                let file = &file;
                scope.spawn(move || {
                    for number in 0..8 {
                        let name = format!("{writer}-{number}");
                        let change = |fields: &mut Fields, _: &mut Vec<String>| {
                            fields.insert(name, number.into());
                        };
                        update(file, "the list", change).unwrap();
                    }
                });
            }
        });
        let there: Fields = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
        assert_eq!(there.len(), 32);
    }

    #[test]
    fn non_object_files_are_backed_up_before_being_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("list.json");
        fs::write(&file, "[1, 2").unwrap();
        let change = |fields: &mut Fields, _: &mut Vec<String>| {
            fields.insert("a".to_owned(), 1.into());
        };
        update(&file, "the list", change).unwrap();
        assert_eq!(
            fs::read_to_string(folder.path().join("list.json.unreadable")).unwrap(),
            "[1, 2"
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    proptest! {
        /// Changes of different settings do not depend on who saves first, and none is lost.
        #[test]
        fn different_settings_are_merged_in_any_order(
            values in proptest::collection::vec((0_u8..4, 0_u8..4, 0_u8..3), 1..8),
        ) {
            let of = |value: fn(&(u8, u8, u8)) -> u8| -> Fields {
                values.iter().enumerate().map(|(index, row)| (index.to_string(), value(row).into())).collect()
            };
            let before = of(|row| row.0);
            // Each setting is changed by at most one of the two.
            let first = of(|row| if row.2 == 1 { row.1 } else { row.0 });
            let second = of(|row| if row.2 == 2 { row.1 } else { row.0 });
            let expected = of(|row| if row.2 == 0 { row.0 } else { row.1 });
            for order in [[&first, &second], [&second, &first]] {
                let mut stored = before.clone();
                for now in order {
                    merge(&mut stored, &before, now);
                }
                prop_assert_eq!(&stored, &expected);
            }
        }
    }
}
