//! Automatic saving of the document: while it is edited, when it is closed, and at the end of the program.
//!
//! **How it works.** Each sequence has a file ([`DocumentFolder`](crate::document::DocumentFolder)). Once per pass the
//! document is compared with its initial state; differences are written shortly after the last change, so that a killed
//! program has lost little. Looking at frames is not a change, and a file that was only opened leaves nothing behind. A
//! session has its own file: it is written when the user saves it. Until then changes are stored next to the documents,
//! and restored when the session is opened again (`document/unsaved.rs`), so that the window closes and other files are
//! opened without a question.

use super::State;
use super::keeper::Keeper;
use super::measured_way::MeasuredWay;
use crate::app::side::Side;
use crate::document::Document;
use crate::scene::{DrawingSettings, Settings};
use crate::sequence::Sequence;
use std::sync::Arc;
use std::time::Duration;

/// A slider that is being dragged is not written at each of its steps.
const WRITE_DELAY: Duration = Duration::from_secs(1);

/// A document that is to be opened.
pub(super) struct Found {
    /// As it is to be shown.
    pub(super) document: Document,
    keeper: Keeper,
    /// Stored parts of the document, for a notice.
    stored: Vec<String>,
    problem: Option<String>,
}

impl State {
    /// Returns the stored document of `sequence`, or a new one.
    pub(super) fn find_document(&mut self, sequence: &Sequence) -> Found {
        let new = self.new_document();
        let folder = self.shared.options.documents.as_ref();
        let file = folder.and_then(|folder| folder.file_of(sequence));
        let mut read = folder
            .zip(file.as_ref())
            .map(|(folder, file)| folder.read(file, &new))
            .unwrap_or_default();
        let written = read.document.clone().unwrap_or_else(|| new.clone());
        if std::mem::take(&mut self.shared.options.is_fresh) {
            read.document = None;
        }
        let stored = read
            .document
            .as_ref()
            .map(|document| document.summary(&undrawn(new.clone())));
        let mut document = read.document.unwrap_or_else(|| new.clone());
        document.settings.drawing = new.settings.drawing;
        let before = document.style();
        let mut chosen = self.shared.options.given.over(before);
        if self.player.is_some() {
            // A clip given on the command line applies only to its first sequence.
            chosen.clip = before.clip;
        }
        document.clip = chosen.clip;
        document.settings = chosen.with(|style| style.clip = None);
        if self.player.is_none() {
            document.frame = self.shared.options.frame.unwrap_or(document.frame);
        }
        let end = document.range.of(sequence.len()).end;
        if !self.shared.options.paused && document.frame + 1 >= end {
            // Playback would end at once.
            document.frame = document.range.of(sequence.len()).start;
        }
        Found {
            document,
            keeper: Keeper {
                file: file.filter(|_| read.is_writable),
                written,
                new: undrawn(new),
                given: (chosen != before).then_some(MeasuredWay { before, chosen }),
                ..Keeper::default()
            },
            stored: stored.unwrap_or_default(),
            problem: read.problem,
        }
    }

    /// Shows the document that was found for the sequence that was just opened.
    pub(super) fn open_document(&mut self, found: Found) {
        self.apply_document(found.document);
        self.opening.keeper = found.keeper;
        self.note_begun();
        if let Some(problem) = found.problem {
            self.notices.warn(problem);
        }
        if !found.stored.is_empty() {
            let stored = found.stored.join(", ");
            self.notices.info(format!(
                "As you left it: {stored}. Edit, Begin again from defaults opens it as new"
            ));
        }
    }

    /// The document as it is stored: without changes by the command line, and without the renderer.
    pub(super) fn stored_document(&self) -> Document {
        self.as_stored(self.current_document())
    }

    fn as_stored(&self, mut document: Document) -> Document {
        if let Some(way) = self.opening.keeper.given {
            document.settings = way.undone(document.settings);
            if document.clip == way.chosen.clip {
                document.clip = way.before.clip;
            }
        }
        if document.inputs.is_empty()
            && let Some(player) = self.player.as_ref().filter(|player| !player.sequence().is_empty())
        {
            document.inputs = vec![player.sequence().entry(0).path.clone()];
        }
        undrawn(document)
    }

    /// Takes notice that the document is as it begins.
    pub(super) fn note_begun(&mut self) {
        let now = self.stored_document();
        self.opening.keeper.begun = now.clone();
        self.note_saved(now);
    }

    /// Takes notice that `document` was saved.
    pub(in crate::app) fn note_saved(&mut self, document: Document) {
        self.opening.keeper.saved = document;
        self.opening.keeper.seen = None;
        self.gather_document();
        self.look_at_document();
    }

    /// Looks whether the document, which is up to date, has changed. Copies nothing while it has not.
    pub(super) fn look_at_document(&mut self) {
        if self.player.is_none() {
            self.opening.keeper = Keeper::default();
            return;
        }
        let now = &self.document;
        match &mut self.opening.keeper.seen {
            Some(seen) if seen.is_same_work(now) => {
                if seen.view == now.view {
                    return;
                }
                seen.view = now.view;
            }
            _ => {
                let stored = self.as_stored(now.clone());
                let keeper = &mut self.opening.keeper;
                keeper.is_unsaved = !stored.is_same_work(&keeper.saved);
                keeper.is_other_work = !stored.is_same_work(&keeper.begun);
                keeper.seen = Some(self.document.clone());
            }
        }
        let keeper = &mut self.opening.keeper;
        let differs = keeper.is_other_work || self.document.view != keeper.begun.view;
        keeper.changed = differs.then_some(self.shared.now);
    }

    /// True if the document differs from the last saved or opened state.
    pub fn is_unsaved(&self) -> bool {
        self.opening.keeper.is_unsaved
    }

    /// Returns true if the user's work is saved automatically.
    pub(in crate::app) fn is_persisted(&self) -> bool {
        self.opening.keeper.file.is_some() || self.opening.keeper.unsaved.is_some()
    }

    /// When [`State::keep_if_due`] has something to do.
    pub(in crate::app) fn keeping_deadline(&self) -> Option<Duration> {
        let changed = self.opening.keeper.changed.filter(|_| self.is_persisted())?;
        Some(changed + WRITE_DELAY)
    }

    /// Stores changes made long enough before `now`.
    pub(in crate::app) fn keep_if_due(&mut self, now: Duration) {
        if self.keeping_deadline().is_some_and(|due| due <= now) {
            self.keep_document();
        }
    }

    /// Stores the document, if it was changed and may be stored.
    pub(in crate::app) fn keep_document(&mut self) {
        if !self.is_persisted() || self.player.is_none() {
            return;
        }
        let now = self.stored_document();
        if now.is_stored_same(&self.opening.keeper.begun) {
            return;
        }
        for stored in [self.keep_of_sequence(&now), self.keep_of_session(&now)] {
            if let Err(problem) = stored {
                self.notices.warn(problem);
            }
        }
        // Also after a failure: it would fail again every second.
        self.opening.keeper.written = now.clone();
        self.opening.keeper.begun = now;
        self.opening.keeper.changed = None;
        self.opening.keeper.seen = None;
    }

    fn keep_of_sequence(&self, now: &Document) -> Result<(), String> {
        let keeper = &self.opening.keeper;
        let (Some(folder), Some(file)) = (&self.shared.options.documents, &keeper.file) else {
            return Ok(());
        };
        if now.summary(&keeper.new).is_empty() {
            folder.forget(file);
            return Ok(());
        }
        folder.write(file, &keeper.written, now)
    }

    /// Stores the unsaved changes of the session, in its format.
    fn keep_of_session(&self, now: &Document) -> Result<(), String> {
        let keeper = &self.opening.keeper;
        let (Some(folder), Some(place)) = (&self.shared.options.documents, &keeper.unsaved) else {
            return Ok(());
        };
        if now.is_same_work(&keeper.saved) {
            folder.forget_unsaved(place);
            return Ok(());
        }
        folder.keep_unsaved(place, &self.session()?)
    }

    /// The open document is empty again, as if its sequence was opened for the first time.
    pub(in crate::app) fn begin_again(&mut self) {
        if self.player.is_none() {
            return;
        }
        self.close_split_view();
        self.end_comparison(Side::A);
        let now = self.current_document();
        self.shared.options.view = None;
        self.opening.measured_way = None;
        self.opening.keeper.given = None;
        self.stop_preview();
        self.features.path.take(Arc::default(), None);
        let (file, options) = (self.opening.opened.file.take(), self.opening.opened.options.take());
        self.apply_document(Document {
            inputs: now.inputs,
            reading: now.reading,
            frame: now.frame,
            unknown: now.unknown,
            ..self.new_document()
        });
        (self.opening.opened.file, self.opening.opened.options) = (file, options);
        self.guess_up();
        self.reset_view();
        self.keep_document();
        self.notices
            .info("Begun again from defaults: Undo brings settings, labels, markers and camera path back");
    }

    /// New documents begin with the look of the open one.
    pub(in crate::app) fn use_as_defaults(&mut self) {
        let style = self.style_of_a();
        let stored = self.opening.keeper.given.map_or(style, |way| way.undone(style));
        self.shared.options.preferences.settings = Settings { clip: None, ..stored };
        self.opening.keeper.new = undrawn(self.new_document());
        self.notices
            .info("New files begin with this look; those that were opened before keep theirs");
    }

    /// Reopens the sequence of the document with `open`, which continues with the document and its undo history.
    pub(in crate::app) fn with_document_stored(&mut self, open: impl FnOnce(&mut Self)) {
        let keeper = std::mem::take(&mut self.opening.keeper);
        let history = std::mem::take(&mut self.history);
        open(self);
        self.opening.keeper = keeper;
        self.history = history;
        if let (Some(_), Some(folder), Some(player)) =
            (&self.opening.keeper.file, &self.shared.options.documents, &self.player)
        {
            // Its first frame may have a different name.
            self.opening.keeper.file = folder.file_of(player.sequence());
        }
    }
}

/// A document without the renderer, which is not a part of it.
pub(super) fn undrawn(mut document: Document) -> Document {
    document.settings.drawing = DrawingSettings::default();
    document
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::StateOptions;
    use crate::cloud::{Positions, RawCloud};
    use crate::document::DocumentFolder;
    use crate::sequence::FrameEntry;

    #[test]
    fn a_change_is_persisted_once_it_has_been_stable_briefly() {
        let folder = tempfile::tempdir().unwrap();
        let documents = folder.path().join("documents");
        let mut state = State::new(StateOptions {
            documents: Some(DocumentFolder::at(documents.clone(), folder.path().join("timelines"))),
            ..StateOptions::default()
        });
        let note = |state: &mut State| {
            state.gather_document();
            state.look_at_document();
        };
        let decode = |_: &FrameEntry| Ok(RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0; 3]])));
        let sequence = Sequence::with_decoder(vec![FrameEntry::file("/scans/a.ply")], decode);
        state.open(Arc::new(sequence));
        note(&mut state);
        assert_eq!((state.keeping_deadline(), state.is_unsaved()), (None, false));
        state.document.notes.push('a');
        note(&mut state);
        state.shared.now += WRITE_DELAY / 2;
        state.document.notes.push('b');
        note(&mut state);
        let due = state.shared.now + WRITE_DELAY;
        assert_eq!((state.keeping_deadline(), state.is_unsaved()), (Some(due), true));
        state.keep_if_due(due.saturating_sub(Duration::from_millis(1)));
        assert!(!documents.exists());
        state.keep_if_due(due);
        assert_eq!(documents.read_dir().unwrap().count(), 1);
        assert_eq!(
            (state.keeping_deadline(), state.is_unsaved()),
            (None, true),
            "no session has it"
        );
        // Back to the initial state: nothing is left to save.
        state.document.notes.clear();
        note(&mut state);
        state.keep_if_due(due + 2 * WRITE_DELAY);
        assert_eq!(documents.read_dir().unwrap().count(), 0);
        assert!(!state.is_unsaved());
    }
}
