//! Documents stored automatically: one file per sequence, in the settings folder.
//!
//! **How it works.** A sequence is identified by path, name and size of its first frame: added frames do not change it.
//! Its file holds the text of a session with absolute paths, and is written as a whole. Two windows may have the same
//! sequence open: each merges the parts changed in it into the current file (`stored/update.rs`); if both changed a
//! part, the later write wins. A file that cannot be read is copied before it is replaced. The number and the size of
//! the files are bounded: the oldest are removed.

use super::model::Document;
use super::text_hash::hex_hash;
use super::{EXTENSION, ReadSession, text, timeline_file};
use crate::persist::{self, Fields};
use crate::sequence::Sequence;
use serde_json::Value;
use std::fs::{self, File};
use std::io::Error;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Max number of files.
const MAX_DOCUMENTS: usize = 500;

/// Bytes of all of them.
const MAX_TOTAL_BYTES: u64 = 64 << 20;

/// Bytes of one of them.
const MAX_DOCUMENT_BYTES: usize = 1 << 20;

/// Messages call the contents of a file so.
const WHAT: &str = "the document";

/// Name of the field whose settings are merged one by one.
const SETTINGS: &str = "settings";

/// The folder of the documents of a user.
#[derive(Debug, Clone)]
pub struct DocumentFolder {
    folder: PathBuf,
    /// Files of marks from before there were documents.
    timelines: PathBuf,
}

/// Stored document of a sequence.
#[derive(Debug, Default)]
pub struct StoredDocument {
    /// The document; `None` if nothing was stored, or it cannot be read.
    pub document: Option<Document>,
    /// Description of the unreadable parts: a text for a notice.
    pub problem: Option<String>,
    /// True if the file may be replaced.
    pub is_writable: bool,
}

impl DocumentFolder {
    /// The folder of this user; `None` where the system has no folder for settings.
    pub fn of_user() -> Option<Self> {
        Some(Self::at(
            persist::place_of("documents")?,
            persist::place_of("timelines")?,
        ))
    }

    /// Documents in `folder`, and files of marks from before in `timelines`.
    pub fn at(folder: PathBuf, timelines: PathBuf) -> Self {
        Self { folder, timelines }
    }

    /// The file for `sequence`; `None` without frames.
    pub fn file_of(&self, sequence: &Sequence) -> Option<PathBuf> {
        let key = key_of(sequence)?;
        Some(self.folder.join(format!("{key}.{EXTENSION}")))
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    fn timeline_of(&self, file: &Path) -> PathBuf {
        let name = file.with_extension("json");
        self.timelines.join(name.file_name().unwrap_or_default())
    }

    /// Reads the document stored in `file`, where `new` is a new document.
    pub fn read(&self, file: &Path, new: &Document) -> StoredDocument {
        let unread = |reason: String| {
            let (copied, is_writable) = match persist::copy_alongside(file) {
                Ok(copy) => (format!("the file as it is was copied to {}", copy.display()), true),
                Err(_) => ("changes are not kept".to_owned(), false),
            };
            let problem = format!("Not all that was kept of this sequence can be read ({reason}): {copied}");
            (Some(problem), is_writable)
        };
        let bytes = match persist::read(file) {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return self.read_timeline(file, new),
            Err(reason) => {
                let (problem, is_writable) = unread(reason);
                return StoredDocument {
                    document: None,
                    problem,
                    is_writable,
                };
            }
        };
        let (document, warnings) = match ReadSession::of_text(&bytes, file) {
            Ok(read) => (Some(read.document), read.warnings),
            Err(reason) => (None, vec![reason.to_string()]),
        };
        let (problem, is_writable) = match warnings.first() {
            None => (None, true),
            Some(reason) => unread(reason.clone()),
        };
        if document.is_some() {
            note_used(file);
        }
        StoredDocument {
            document,
            problem,
            is_writable,
        }
    }

    fn read_timeline(&self, file: &Path, new: &Document) -> StoredDocument {
        let mut document = new.clone();
        let problem = timeline_file::read_into(&mut document, &self.timeline_of(file));
        StoredDocument {
            document: (document != *new).then_some(document),
            problem,
            is_writable: true,
        }
    }

    /// Writes the differences of `now` from `before`, the document that this window read or wrote last. `Err` is a text
    /// for a notice.
    ///
    /// # Errors
    /// Failures to write, with the reason.
    pub fn write(&self, file: &Path, before: &Document, now: &Document) -> Result<(), String> {
        let failed = |reason: String| format!("What you made of this sequence could not be kept ({reason})");
        let ordered = now.fields(None).map_err(|reason| failed(reason.to_string()))?;
        let before = before.fields(None).map_err(|reason| failed(reason.to_string()))?;
        let [now, before] = [&ordered, &before].map(|fields| object_of(fields));
        let is_new = !file.exists();
        let written = persist::update_as(
            file,
            WHAT,
            |fields| text_of(fields, &ordered),
            |stored, unread| merge_into(stored, unread, &before, &now, file),
        );
        written.map_err(|reason| failed(reason.to_string()))?;
        if is_new {
            remove_oldest(&self.folder, file, MAX_DOCUMENTS, MAX_TOTAL_BYTES);
        }
        Ok(())
    }

    /// Removes the stored `file`.
    pub fn forget(&self, file: &Path) {
        for file in [file, &self.timeline_of(file)] {
            match fs::remove_file(file) {
                Err(reason) if reason.kind() != std::io::ErrorKind::NotFound => {
                    log::warn!("{} could not be removed ({reason})", file.display());
                }
                _ => {}
            }
        }
    }
}

/// Name of the file of a sequence, without extension.
fn key_of(sequence: &Sequence) -> Option<String> {
    if sequence.is_empty() {
        return None;
    }
    let entry = sequence.entry(0);
    let path = std::path::absolute(&entry.path).unwrap_or_else(|_| entry.path.clone());
    let bytes = fs::metadata(&path).map_or(0, |metadata| metadata.len());
    let mut hashed = path.as_os_str().as_encoded_bytes().to_vec();
    // A separator, so that no two lists of texts hash alike.
    hashed.push(0);
    hashed.extend(format!("{} {bytes}", entry.name).into_bytes());
    Some(hex_hash(&hashed))
}

fn object_of(fields: &[(&str, Value)]) -> Fields {
    let fields = fields.iter();
    fields
        .map(|(name, value)| ((*name).to_owned(), value.clone()))
        .collect()
}

/// The text of a session with `fields`, in the order of those that are `ordered`.
fn text_of(fields: &Fields, ordered: &[(&str, Value)]) -> std::io::Result<Vec<u8>> {
    let place = |name: &str| ordered.iter().position(|(known, _)| *known == name);
    let mut fields: Vec<(&str, &Value)> = fields.iter().map(|(name, value)| (name.as_str(), value)).collect();
    fields.sort_by_key(|(name, _)| place(name).unwrap_or(usize::MAX));
    let text = text::of_fields(fields);
    if text.len() > MAX_DOCUMENT_BYTES {
        let (bytes, max) = (text.len(), MAX_DOCUMENT_BYTES >> 20);
        return Err(Error::other(format!(
            "it has {bytes} bytes, at most {max} MiB are kept: save a session"
        )));
    }
    Ok(text.into_bytes())
}

/// Merges the differences between `before` and `now` into `stored`.
fn merge_into(stored: &mut Fields, unread: &mut Vec<String>, before: &Fields, now: &Fields, file: &Path) {
    let was_read = serde_json::to_vec(stored)
        .map_err(|reason| reason.to_string())
        .and_then(|bytes| ReadSession::of_text(&bytes, file).map_err(|reason| reason.to_string()));
    if let Err(reason) = was_read {
        // Nothing was stored, or nothing that could be merged with.
        if !stored.is_empty() {
            unread.push(reason);
        }
        stored.clone_from(now);
        return;
    }
    for name in before.keys().filter(|name| !now.contains_key(*name)) {
        stored.remove(name);
    }
    for (name, value) in now.iter().filter(|(name, value)| before.get(*name) != Some(*value)) {
        match (name.as_str(), stored.get_mut(name), before.get(name), value) {
            (SETTINGS, Some(Value::Object(stored)), Some(Value::Object(before)), Value::Object(now)) => {
                persist::merge(stored, before, now);
            }
            _ => {
                stored.insert(name.clone(), value.clone());
            }
        }
    }
}

/// Takes notice that a file is used: the oldest are removed first.
fn note_used(file: &Path) {
    let touched = File::options().append(true).open(file);
    if let Err(reason) = touched.and_then(|file| file.set_modified(SystemTime::now())) {
        log::debug!("{} stays as old as it was ({reason})", file.display());
    }
}

/// Removes the oldest files of `folder` beyond these numbers of files and bytes; `stored` stays.
fn remove_oldest(folder: &Path, stored: &Path, max_files: usize, max_bytes: u64) {
    let Ok(entries) = folder.read_dir() else { return };
    let files = entries.flatten().filter_map(|entry| {
        let metadata = entry.metadata().ok().filter(fs::Metadata::is_file)?;
        let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        (!is_hidden).then_some((metadata.modified().ok()?, entry.path(), metadata.len()))
    });
    let mut files: Vec<(SystemTime, PathBuf, u64)> = files.collect();
    files.sort();
    let (mut count, mut bytes) = (files.len(), files.iter().map(|(_, _, bytes)| bytes).sum::<u64>());
    for (_, file, of_file) in files.iter().filter(|(_, file, _)| file != stored) {
        if count <= max_files && bytes <= max_bytes {
            return;
        }
        match fs::remove_file(file) {
            Ok(()) => (count, bytes) = (count - 1, bytes - of_file),
            Err(reason) => log::warn!("{} could not be removed ({reason})", file.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Marker;
    use crate::scene::{Primitive, Settings};
    use crate::sequence::FrameEntry;
    use std::time::Duration;

    fn sequence(names: &[&str]) -> Sequence {
        let entries = names.iter().map(|name| FrameEntry::file(format!("/scans/{name}")));
        Sequence::with_decoder(entries.collect(), |_| Err("unread".into()))
    }

    fn documents(folder: &Path) -> (DocumentFolder, PathBuf) {
        let documents = DocumentFolder::at(folder.join("documents"), folder.join("timelines"));
        let file = documents.file_of(&sequence(&["a.ply"])).unwrap();
        (documents, file)
    }

    fn document() -> Document {
        Document {
            inputs: vec!["/scans/a.ply".into()],
            notes: "a note".to_owned(),
            ..Document::new(Settings::default())
        }
    }

    fn marker(frame: usize) -> Marker {
        Marker {
            frame,
            name: String::new(),
        }
    }

    #[test]
    fn sequences_are_distinguished_by_their_first_frame() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, of_a) = documents(folder.path());
        let file = |names: &[&str]| documents.file_of(&sequence(names));
        assert_eq!(file(&[]), None);
        assert_eq!(file(&["a.ply", "b.ply"]), Some(of_a.clone()));
        assert_ne!(file(&["b.ply"]), Some(of_a));
    }

    #[test]
    fn documents_are_stored_as_session_text() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, file) = documents(folder.path());
        let new = Document::new(Settings::default());
        assert!(documents.read(&file, &new).document.is_none());
        let document = document();
        documents.write(&file, &new, &document).unwrap();
        let read = ReadSession::read(&file).unwrap();
        assert_eq!((&read.document, read.warnings.len()), (&document, 0));
        assert_eq!(documents.read(&file, &new).document, Some(document.clone()));
        // A copy instead of a session counts as the same session if its text is identical.
        if cfg!(unix) {
            let text = document.to_text(Path::new("/elsewhere/walk.pointreel")).unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
        documents.forget(&file);
        assert!(documents.read(&file, &new).document.is_none());
    }

    #[test]
    fn marks_of_older_versions_are_read_until_a_document_is_stored() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, file) = documents(folder.path());
        let timeline = documents.timeline_of(&file);
        fs::create_dir_all(timeline.parent().unwrap()).unwrap();
        fs::write(
            &timeline,
            r#"{"version": 1, "markers": [{"frame": 5}], "primitive": "voxel"}"#,
        )
        .unwrap();
        let new = Document::new(Settings::default());
        let read = documents.read(&file, &new).document.unwrap();
        assert_eq!(
            (&read.markers, read.settings.primitive),
            (&vec![marker(5)], Primitive::Voxel.into())
        );
        documents.write(&file, &new, &document()).unwrap();
        assert_eq!(documents.read(&file, &new).document, Some(document()));
        documents.forget(&file);
        assert!(
            documents.read(&file, &new).document.is_none(),
            "nor do the marks come back"
        );
    }

    #[test]
    fn changes_of_two_windows_are_merged() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, file) = documents(folder.path());
        let new = Document::new(Settings::default());
        let before = document();
        documents.write(&file, &new, &before).unwrap();
        let mut one = before.clone();
        one.markers = vec![marker(3)];
        one.settings.primitive = Primitive::Point.into();
        let mut other = before.clone();
        other.notes = "changed".to_owned();
        other.settings.backdrop.grid = true;
        documents.write(&file, &before, &one).unwrap();
        documents.write(&file, &before, &other).unwrap();
        let mut both = one;
        both.notes = "changed".to_owned();
        both.settings.backdrop.grid = true;
        assert_eq!(documents.read(&file, &new).document, Some(both));
    }

    #[test]
    fn concurrent_writers_leave_a_complete_file() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, file) = documents(folder.path());
        let new = Document::new(Settings::default());
        std::thread::scope(|scope| {
            for writer in 0..4usize {
                let (documents, file, new) = (&documents, &file, &new);
                scope.spawn(move || {
                    let mut before = new.clone();
                    for number in 0..8 {
                        let mut now = document();
                        now.markers = (0..=writer * 8 + number).map(marker).collect();
                        documents.write(file, &before, &now).unwrap();
                        before = now;
                    }
                });
            }
        });
        let read = documents.read(&file, &new);
        assert!(read.document.is_some() && read.problem.is_none(), "{:?}", read.problem);
        assert_eq!(fs::read_dir(file.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn unreadable_files_are_backed_up_before_being_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, file) = documents(folder.path());
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, r#"{"pointreel_session": 99, "files": ["/a"]}"#).unwrap();
        let new = Document::new(Settings::default());
        let read = documents.read(&file, &new);
        assert!(read.document.is_none() && read.is_writable);
        assert!(read.problem.unwrap().contains("version 99"));
        documents.write(&file, &new, &document()).unwrap();
        assert_eq!(documents.read(&file, &new).document, Some(document()));
        let copy = file.with_extension("pointreel.unreadable");
        assert!(fs::read_to_string(copy).unwrap().contains("99"));
    }

    #[test]
    fn the_oldest_documents_are_removed_and_oversized_ones_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let (documents, file) = documents(folder.path());
        let new = Document::new(Settings::default());
        documents.write(&file, &new, &document()).unwrap();
        let old = Duration::from_secs(1000);
        for number in 0..5u32 {
            let other = file.with_file_name(format!("{number}.pointreel"));
            fs::write(&other, "{}").unwrap();
            let at = SystemTime::now() - old * (number + 1);
            File::options()
                .append(true)
                .open(other)
                .unwrap()
                .set_modified(at)
                .unwrap();
        }
        remove_oldest(file.parent().unwrap(), &file, 3, u64::MAX);
        let left = |name: &str| file.with_file_name(name).exists();
        assert!(left("0.pointreel") && left("1.pointreel") && !left("2.pointreel"));
        remove_oldest(file.parent().unwrap(), &file, usize::MAX, 0);
        assert!(file.exists() && !left("0.pointreel"), "what is open stays");
        let mut large = document();
        large.notes = "x".repeat(MAX_DOCUMENT_BYTES);
        assert!(
            documents
                .write(&file, &new, &large)
                .unwrap_err()
                .contains("save a session")
        );
        assert_eq!(documents.read(&file, &new).document, Some(document()));
    }
}
