//! Recently opened inputs, stored in a small JSON file. Several windows share it: each puts its opened inputs first in
//! the current list.

use crate::persist::{self, Fields};
use serde::Deserialize as _;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Max number of entries.
const MAX_ENTRIES: usize = 10;

/// An entry of more files than this is not stored: it is a selection, not a place.
pub(super) const MAX_INPUTS: usize = 100;

/// The inputs of sequences, latest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recent {
    entries: Vec<Vec<PathBuf>>,
    file: Option<PathBuf>,
}

/// The name of the list in the file.
const LIST: &str = "recent";

/// Name of the list in messages.
const WHAT: &str = "the list of recent files";

impl Recent {
    /// The list of this user, and a text for a notice about unreadable entries.
    pub fn load() -> (Self, Option<String>) {
        match persist::place_of("recent.json") {
            Some(file) => Self::load_from(&file),
            None => (Self::default(), None),
        }
    }

    /// The list in `file`, which need not be there yet.
    pub fn load_from(file: &Path) -> (Self, Option<String>) {
        let read = persist::read_leniently(file, WHAT, entries_of);
        let recent = Self {
            entries: read.value,
            file: read.file,
        };
        (recent, read.problem)
    }

    /// The inputs of each entry, latest first.
    pub fn entries(&self) -> &[Vec<PathBuf>] {
        &self.entries
    }

    /// Puts `inputs` first and writes the list. `Err` is a text for a notice.
    pub fn add(&mut self, inputs: &[PathBuf]) -> Result<(), String> {
        if inputs.is_empty() || inputs.len() > MAX_INPUTS {
            return Ok(());
        }
        let inputs = absolute(inputs);
        self.change(|entries| {
            entries.retain(|entry| *entry != inputs);
            entries.insert(0, inputs);
            entries.truncate(MAX_ENTRIES);
        })
    }

    /// Empties the list. `Err` is a text for a notice.
    pub fn clear(&mut self) -> Result<(), String> {
        self.change(Vec::clear)
    }

    /// Returns the thumbnail path of these inputs, regardless of whether the file exists; `None` if nothing is stored,
    /// or they are not in the list.
    pub(super) fn picture_of(&self, inputs: &[PathBuf]) -> Option<PathBuf> {
        let inputs = absolute(inputs);
        let is_listed = self.entries.contains(&inputs);
        let folder = self.file.as_ref()?.parent()?.join("recent");
        is_listed.then(|| folder.join(format!("{:016x}.png", hash(&inputs))))
    }

    fn forget_picture(&self, inputs: &[PathBuf]) {
        let folder = self.file.as_ref().and_then(|file| file.parent());
        if let Some(folder) = folder {
            // The file may not exist.
            let _ = std::fs::remove_file(folder.join("recent").join(format!("{:016x}.png", hash(inputs))));
        }
    }

    /// Changes the list as it is in the file now, and writes it.
    fn change(&mut self, change: impl FnOnce(&mut Vec<Vec<PathBuf>>)) -> Result<(), String> {
        let before = self.entries.clone();
        let Some(file) = self.file.clone() else {
            change(&mut self.entries);
            return Ok(());
        };
        let mut in_file = Vec::new();
        let (entries, read) = (&mut self.entries, &mut in_file);
        let written = persist::update(&file, WHAT, |stored, unread| {
            *entries = entries_of(stored, unread);
            read.clone_from(entries);
            change(entries);
            let listed = serde_json::to_value(&*entries).unwrap_or_else(|_| Value::Array(Vec::new()));
            stored.insert(LIST.to_owned(), listed);
        });
        for entry in before.iter().chain(&in_file) {
            if !self.entries.contains(entry) {
                self.forget_picture(entry);
            }
        }
        written.map_err(|reason| format!("{WHAT} could not be written to {} ({reason})", file.display()))
    }
}

/// The next run may start in another folder.
pub(super) fn absolute(inputs: &[PathBuf]) -> Vec<PathBuf> {
    let absolute = |input: &PathBuf| std::path::absolute(input).unwrap_or_else(|_| input.clone());
    inputs.iter().map(absolute).collect()
}

/// FNV-1a over the inputs, the same for all versions of the program.
fn hash(inputs: &[PathBuf]) -> u64 {
    let bytes = inputs.iter().flat_map(|input| {
        let path = input.as_os_str().as_encoded_bytes().iter().copied();
        path.chain([0])
    });
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn entries_of(stored: &Fields, unread: &mut Vec<String>) -> Vec<Vec<PathBuf>> {
    let mut entries = Vec::new();
    for entry in persist::entries(stored, LIST, unread) {
        match Vec::<PathBuf>::deserialize(entry) {
            Ok(entry) => entries.push(entry),
            Err(reason) => unread.push(reason.to_string()),
        }
    }
    entries.retain(|entry| !entry.is_empty() && entry.len() <= MAX_INPUTS);
    entries.truncate(MAX_ENTRIES);
    entries
}

/// An entry as a menu shows it.
pub(super) fn entry_name(inputs: &[PathBuf]) -> String {
    let first = inputs
        .first()
        .map_or_else(String::new, |path| path.display().to_string());
    match inputs.len() {
        0 | 1 => first,
        count => format!("{first} and {} more", count - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_list_is_bounded_latest_first_and_persistent() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("deeper/recent.json");
        let (mut recent, problem) = Recent::load_from(&file);
        assert_eq!(problem, None);
        for number in 0..15 {
            recent.add(&[format!("/scans/{number}").into()]).unwrap();
        }
        recent.add(&["/scans/9".into()]).unwrap();
        let (again, problem) = Recent::load_from(&file);
        assert_eq!(problem, None);
        assert_eq!(again, recent);
        assert_eq!(again.entries().len(), MAX_ENTRIES);
        assert_eq!(again.entries()[0], [PathBuf::from("/scans/9")]);
        assert_eq!(again.entries()[1], [PathBuf::from("/scans/14")]);
    }

    #[test]
    fn two_windows_share_one_list() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("recent.json");
        fs::write(&file, r#"{"recent": [["/a"]], "of later": 1}"#).unwrap();
        let [mut first, mut second] = [(); 2].map(|()| Recent::load_from(&file).0);
        first.add(&["/b".into()]).unwrap();
        second.add(&["/c".into()]).unwrap();
        first.add(&["/a".into()]).unwrap();
        let expected = ["/a", "/c", "/b"].map(|path| vec![PathBuf::from(path)]);
        assert_eq!(first.entries(), expected);
        assert_eq!(Recent::load_from(&file).0, first);
        let stored: Fields = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
        assert_eq!(stored["of later"], 1);
        second.clear().unwrap();
        first.add(&["/d".into()]).unwrap();
        assert_eq!(first.entries(), [[PathBuf::from("/d")]]);
    }

    #[test]
    fn a_damaged_list_is_reported_backed_up_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("recent.json");
        for damaged in ["", "{", "[1,2]", r#"{"recent":[[7]]}"#, "\0\u{1}"] {
            fs::write(&file, damaged).unwrap();
            let (mut recent, problem) = Recent::load_from(&file);
            assert!(problem.is_some_and(|text| text.contains("recent.json")), "{damaged:?}");
            assert!(recent.entries().is_empty());
            recent.add(&["/a".into()]).unwrap();
            assert_eq!(Recent::load_from(&file).1, None);
        }
        let copy = folder.path().join("recent.json.unreadable-2");
        assert_eq!(fs::read_to_string(copy).unwrap(), "{");
    }

    #[test]
    fn an_unreadable_entry_does_not_affect_others() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("recent.json");
        fs::write(&file, r#"{"recent": [["/a"], 7, ["/b", "/c"]], "of later": 1}"#).unwrap();
        let (recent, problem) = Recent::load_from(&file);
        let expected: [Vec<PathBuf>; 2] = [vec!["/a".into()], vec!["/b".into(), "/c".into()]];
        assert_eq!(recent.entries(), expected);
        assert!(problem.is_some());
    }

    #[test]
    fn thumbnails_belong_to_entries_and_are_removed_with_them() {
        let folder = tempfile::tempdir().unwrap();
        let (mut recent, _) = Recent::load_from(&folder.path().join("recent.json"));
        let inputs = |number: usize| vec![PathBuf::from(format!("/scans/{number}"))];
        assert_eq!(recent.picture_of(&inputs(0)), None, "it is not in the list");
        let mut pictures = Vec::new();
        for number in 0..MAX_ENTRIES {
            recent.add(&inputs(number)).unwrap();
            let picture = recent.picture_of(&inputs(number)).unwrap();
            fs::create_dir_all(picture.parent().unwrap()).unwrap();
            fs::write(&picture, "picture").unwrap();
            assert!(!pictures.contains(&picture), "each has its own");
            pictures.push(picture);
        }
        recent.add(&inputs(MAX_ENTRIES)).unwrap();
        assert!(!pictures[0].exists() && pictures[1].exists());
        recent.clear().unwrap();
        assert!(pictures.iter().all(|picture| !picture.exists()));
        assert_eq!(Recent::default().picture_of(&inputs(1)), None, "nothing is kept");
    }

    #[test]
    fn relative_inputs_are_stored_as_absolute_paths() {
        let mut recent = Recent::default();
        recent.add(&["scans".into()]).unwrap();
        assert!(recent.entries()[0][0].is_absolute());
    }
}
