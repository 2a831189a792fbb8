//! Autosave of unsaved session changes, stored without prompting, as editors do with unsaved files.
//!
//! **How it works.** A session has its own file, which only the user writes. Changes made in the meantime are in the
//! folder of documents, in one file per session, named by the session's path: the text of the whole document, and a
//! hash of the text of the session that it is based on. When the session is opened again and still has that text, the
//! document is restored. Where another program has written the session since, that version takes precedence, and the
//! unsaved changes stay as a session file that can be opened. Once the session is saved, or is back in its saved state,
//! the file is removed.

use super::model::Document;
use super::text_hash::{TextHash, hex_hash};
use super::{DocumentFolder, EXTENSION, ReadSession, Unsaved, text};
use crate::persist;
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Field for the hash of the text of the session.
const BASE: &str = "unsaved_changes_of";

/// Location of the unsaved changes of a session, and the hash of the text they are based on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnsavedPlace {
    file: PathBuf,
    base: TextHash,
}

impl DocumentFolder {
    /// Returns the location of the unsaved changes of `session`, whose text has the hash `base`.
    pub fn unsaved_place(&self, session: &Path, base: TextHash) -> UnsavedPlace {
        let path = std::path::absolute(session).unwrap_or_else(|_| session.to_owned());
        let name = hex_hash(path.as_os_str().as_encoded_bytes());
        UnsavedPlace {
            file: self.folder().join(format!("unsaved-{name}.{EXTENSION}")),
            base,
        }
    }

    /// Restores the unsaved changes into `read`.
    pub fn restore(&self, read: &mut ReadSession) {
        let UnsavedPlace { file, base } = self.unsaved_place(&read.file, read.text_hash.clone());
        if !file.exists() {
            return;
        }
        let mut document = match ReadSession::read(&file) {
            Ok(unsaved) => unsaved.document,
            Err(reason) => return log::warn!("unsaved changes cannot be restored: {reason}"),
        };
        let based_on = document.unknown.session.remove(BASE);
        if based_on == Some(Value::from(base.text())) {
            document.inputs.clone_from(&read.document.inputs);
            let saved = std::mem::replace(&mut read.document, document);
            read.unsaved = Unsaved::Restored(Box::new(saved));
            return;
        }
        // Another program has written the session since: changes are never merged without asking.
        match set_aside(&file) {
            Ok(aside) => read.unsaved = Unsaved::Outdated(aside),
            Err(reason) => log::warn!("{} stays where it is ({reason})", file.display()),
        }
    }

    /// Keeps `document`, which has unsaved changes of a session. `Err` is a text for a notice.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn keep_unsaved(&self, place: &UnsavedPlace, document: &Document) -> Result<(), String> {
        let failed = |reason: String| format!("The unsaved changes could not be kept ({reason}): save the session");
        let base = Value::from(place.base.text());
        let fields = document.fields(None).map_err(|reason| failed(reason.to_string()))?;
        let fields = fields.iter().map(|(name, value)| (*name, value));
        let text = text::of_fields(fields.chain([(BASE, &base)]));
        persist::replace(&place.file, text.as_bytes()).map_err(|reason| failed(reason.to_string()))
    }

    /// Removes the unsaved changes of a session, which is saved, or as it was saved.
    pub fn forget_unsaved(&self, place: &UnsavedPlace) {
        self.forget(&place.file);
    }
}

/// Renames a file to a free name.
fn set_aside(file: &Path) -> std::io::Result<PathBuf> {
    let stem = file.file_stem().and_then(OsStr::to_str).unwrap_or_default();
    let mut names = (1..).map(|number| file.with_file_name(format!("{stem}-{number}.{EXTENSION}")));
    let aside = names.find(|aside| !aside.exists()).unwrap_or_else(|| file.to_owned());
    std::fs::rename(file, &aside)?;
    Ok(aside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn unsaved_changes_are_restored_onto_the_text_they_were_based_on() {
        let folder = tempfile::tempdir().unwrap();
        let documents = DocumentFolder::at(folder.path().join("documents"), folder.path().join("timelines"));
        let session = folder.path().join("walk.pointreel");
        let saved = Document {
            inputs: vec![folder.path().join("a.ply")],
            ..Document::default()
        };
        let hash = saved.write(&session).unwrap();
        let read = ReadSession::read(&session).unwrap();
        assert_eq!(read.text_hash, hash);
        let restored = || {
            let mut read = ReadSession::read(&session).unwrap();
            documents.restore(&mut read);
            read
        };
        assert_eq!(restored(), read, "nothing was changed");

        let changed = Document {
            notes: "later".to_owned(),
            ..read.document.clone()
        };
        let place = documents.unsaved_place(&session, hash);
        documents.keep_unsaved(&place, &changed).unwrap();
        let expected = ReadSession {
            document: changed.clone(),
            unsaved: Unsaved::Restored(Box::new(read.document.clone())),
            ..read.clone()
        };
        assert_eq!(restored(), expected);

        // Someone else has written the session: both versions exist, and nothing is restored twice.
        let other = Document {
            notes: "elsewhere".to_owned(),
            ..read.document
        };
        other.write(&session).unwrap();
        let Unsaved::Outdated(aside) = restored().unsaved else {
            panic!("they are not of this text");
        };
        assert_eq!(ReadSession::read(&aside).unwrap().document.notes, "later");
        assert_eq!(
            (restored().document.notes.as_str(), restored().unsaved),
            ("elsewhere", Unsaved::None)
        );

        documents.keep_unsaved(&place, &changed).unwrap();
        documents.forget_unsaved(&place);
        assert_eq!(restored().unsaved, Unsaved::None);
        assert_eq!(
            fs::read_dir(folder.path().join("documents")).unwrap().count(),
            1,
            "what was set aside"
        );
    }
}
