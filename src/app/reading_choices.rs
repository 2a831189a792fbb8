//! Reading options that the user has chosen for inputs in the window, stored in a small JSON file.

use super::recent::{MAX_INPUTS, absolute, entry_name};
use crate::document::Reading;
use crate::persist::{self, Fields};
use crate::progress::Progress;
use crate::rgbd::Filters;
use crate::sequence::{OpenOptions, Sequence};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Changes where the same word would mean something else. Further fields need no other version.
const VERSION: u32 = 1;

/// Max number of entries, latest first.
const MAX_ENTRIES: usize = 500;

/// Frames that are tried before a choice is taken to be wrong: one or two may be broken.
const TRIED_FRAMES: usize = 3;

/// The choices for each input, latest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadingChoices {
    entries: Vec<Entry>,
    file: Option<PathBuf>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Entry {
    inputs: Vec<PathBuf>,
    reading: Reading,
}

/// Name of the file's contents in messages.
const WHAT: &str = "the choices of reading";

/// The name of the list in the file.
const LIST: &str = "choices";

impl ReadingChoices {
    /// The choices of this user, and a text for a notice about unreadable ones.
    pub fn load() -> (Self, Option<String>) {
        match persist::place_of("reading.json") {
            Some(file) => Self::load_from(&file),
            None => (Self::default(), None),
        }
    }

    /// The choices in `file`, which need not exist yet.
    pub fn load_from(file: &Path) -> (Self, Option<String>) {
        let read = persist::read_leniently(file, WHAT, entries_of);
        let choices = Self {
            entries: read.value,
            file: read.file,
        };
        (choices, read.problem)
    }

    /// The choices for `inputs`.
    pub fn of(&self, inputs: &[PathBuf]) -> Option<&Reading> {
        let inputs = absolute(inputs);
        let entry = self.entries.iter().find(|entry| entry.inputs == inputs);
        entry.map(|entry| &entry.reading)
    }

    /// Changes the choices for `inputs` and writes the file. `Err` is a text for a notice.
    pub(super) fn change(&mut self, inputs: &[PathBuf], change: impl FnOnce(&mut OpenOptions)) -> Result<(), String> {
        if inputs.is_empty() || inputs.len() > MAX_INPUTS {
            return Ok(());
        }
        let mut usual = OpenOptions::default();
        // Unless the user chose otherwise, the window filters depth images.
        usual.rgbd.filters = Filters::USUAL;
        let mut open = self.of(inputs).map_or(usual.clone(), |reading| reading.over(&usual));
        change(&mut open);
        let (inputs, reading) = (absolute(inputs), Reading::of(&open));
        let entry = (reading != Reading::default()).then_some(Entry {
            inputs: inputs.clone(),
            reading,
        });
        let Some(file) = &self.file else {
            self.entries.retain(|entry| entry.inputs != inputs);
            self.entries.splice(0..0, entry);
            self.entries.truncate(MAX_ENTRIES);
            return Ok(());
        };
        let stored_entry = entry.map(serde_json::to_value).transpose();
        let stored_entry = stored_entry.map_err(|reason| reason.to_string())?;
        let entries = &mut self.entries;
        // Other windows may have stored choices for other inputs in the meantime.
        let written = persist::update(file, WHAT, |stored, unread| {
            persist::note_later_version(stored, VERSION, unread);
            let mut listed = persist::readable_entries(stored, LIST, unread, |entry| Entry::deserialize(entry).is_ok());
            listed.retain(|entry| !Entry::deserialize(entry).is_ok_and(|entry| entry.inputs == inputs));
            listed.splice(0..0, stored_entry);
            listed.truncate(MAX_ENTRIES);
            stored.insert(LIST.to_owned(), Value::Array(listed));
            stored.insert("version".to_owned(), VERSION.into());
            *entries = entries_of(stored, unread);
        });
        written.map_err(|reason| {
            let file = file.display();
            format!("{WHAT} could not be written to {file} ({reason})")
        })
    }
}

fn entries_of(stored: &Fields, unread: &mut Vec<String>) -> Vec<Entry> {
    persist::note_later_version(stored, VERSION, unread);
    let mut entries = Vec::new();
    for entry in persist::entries(stored, LIST, unread) {
        match Entry::deserialize(entry) {
            Ok(entry) => entries.push(entry),
            Err(reason) => unread.push(reason.to_string()),
        }
    }
    entries.truncate(MAX_ENTRIES);
    entries
}

/// Opens `inputs` with the options in `chosen`, applied over the `usual` options. `Err` is a text for a notice: files
/// that have been rewritten may not fit a choice that was made for them before, and are then opened with the usual
/// options.
///
/// # Errors
/// As [`Sequence::open`], or no frame can be decoded.
pub fn open_as_chosen(
    inputs: &[PathBuf],
    chosen: &Reading,
    usual: &OpenOptions,
    progress: &Progress,
) -> Result<(Sequence, OpenOptions), String> {
    let open = chosen.over(usual);
    let opened = Sequence::open_observed(inputs, &open, progress).map_err(|reason| reason.to_string());
    let opened = opened.and_then(|sequence| match first_failure(&sequence) {
        Some(reason) => Err(reason),
        None => Ok((sequence, open)),
    });
    opened.map_err(|reason| {
        let name = entry_name(inputs);
        format!("{name} cannot be read any more as you chose in View > Assumptions: opened as usual ({reason})")
    })
}

/// Why no frame can be decoded; `None` if one can.
pub(super) fn first_failure(sequence: &Sequence) -> Option<String> {
    if sequence.source().is_live() {
        return None;
    }
    let mut tried = sequence.frames().take(TRIED_FRAMES).map(|index| sequence.decode(index));
    let first = tried.next()?.err()?;
    tried.all(|frame| frame.is_err()).then(|| first.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_stored_per_input_and_automatic_ones_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("deeper/reading.json");
        let (mut choices, problem) = ReadingChoices::load_from(&file);
        assert_eq!(problem, None);
        let inputs = |name: &str| vec![PathBuf::from(format!("/scans/{name}"))];
        choices
            .change(&inputs("a"), |open| open.rgbd.depth_scale = Some(5000.0))
            .unwrap();
        choices.change(&inputs("a"), |open| open.fps = Some(30.0)).unwrap();
        choices
            .change(&inputs("b"), |open| open.rgbd.filters = Filters::NONE)
            .unwrap();
        let (again, problem) = ReadingChoices::load_from(&file);
        assert_eq!((&again, problem), (&choices, None));
        let of_a = again.of(&inputs("a")).unwrap();
        assert_eq!(
            (of_a.depth_scale, of_a.fps, of_a.rgbd_filters),
            (Some(5000.0), Some(30.0), None)
        );
        assert_eq!(again.of(&inputs("b")).unwrap().rgbd_filters, Some(Filters::NONE));
        choices
            .change(&inputs("b"), |open| open.rgbd.filters = Filters::USUAL)
            .unwrap();
        assert_eq!(choices.of(&inputs("b")), None);
        assert_eq!(ReadingChoices::load_from(&file).0, choices);
    }

    #[test]
    fn an_unreadable_entry_does_not_affect_others() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("reading.json");
        let text = r#"{"version": 1, "choices": [
            {"inputs": ["/a"], "reading": {"fps": -1}}, 7,
            {"inputs": ["/b"], "reading": {"fps": 12}, "of later": 1}]}"#;
        std::fs::write(&file, text).unwrap();
        let (choices, problem) = ReadingChoices::load_from(&file);
        assert!(problem.is_some_and(|text| text.contains("reading.json")));
        assert_eq!(choices.of(&["/a".into()]), None);
        assert_eq!(choices.of(&["/b".into()]).and_then(|reading| reading.fps), Some(12.0));
    }
}
