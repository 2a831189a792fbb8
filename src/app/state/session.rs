//! Sessions: saved with all of the user's work around the open sequence, and reopened.

use super::State;
use super::dialogs::Dialog;
use super::document::inputs_of;
use super::keeping::undrawn;
use super::measured_way::MeasuredWay;
use super::opened::{Opened, SavedSession};
use crate::app::side::Side;
use crate::app::work::files::with_extension;
use crate::app::work::tasks::TaskFailed;
use crate::document::{Document, EXTENSION, ReadSession, Reading, TextHash, Unsaved, UnsavedPlace};
use crate::playback::Player;
use crate::sequence::{OpenOptions, Sequence};
use crate::source::SessionReach;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl State {
    /// Records the names of the open sequence, and its open options.
    pub(in crate::app) fn note_opened(&mut self, inputs: Vec<PathBuf>, options: Option<OpenOptions>) {
        self.opening.opened.inputs = inputs;
        self.opening.opened.options = options;
        self.note_begun();
    }

    /// Records that the open sequence is another one, without a name.
    pub(in crate::app) fn note_unnamed(&mut self) {
        self.opening.opened = Opened::default();
        self.document = Document::default();
    }

    /// The file of the session that is open.
    pub fn session_file(&self) -> Option<&PathBuf> {
        self.opening.opened.file.as_ref()
    }

    /// The document as a session holds it, with a view and files that can be opened again. `Err` is a text for a
    /// notice.
    pub fn session(&self) -> Result<Document, String> {
        let Some(player) = &self.player else {
            return Err("There is nothing to save yet: open a sequence first".to_owned());
        };
        let inputs = self.named_inputs(player)?;
        Ok(Document {
            inputs,
            view: Some(self.camera),
            ..self.current_document()
        })
    }

    pub(in crate::app) fn named_inputs(&self, player: &Player) -> Result<Vec<PathBuf>, String> {
        if !self.opening.opened.inputs.is_empty() {
            return Ok(self.opening.opened.inputs.clone());
        }
        inputs_of(player.sequence())
            .ok_or_else(|| "The open sequence is not a file: its session could not be reopened".to_owned())
    }

    /// Searches for the document's second sequence.
    pub(in crate::app) fn open_companion(&mut self) {
        let Some(compared) = &self.opening.opened.compared else {
            return;
        };
        let inputs = compared.inputs.clone();
        let open = OpenOptions {
            topic: compared.topic.as_deref().map(Arc::from),
            // If it contains another session, that one is asked about separately.
            session_reach: SessionReach::default(),
            ..self.opened_with().clone()
        };
        self.find(inputs, open, Side::B);
    }

    /// Shows `sequence`, named by `inputs`, next to the open one: with the document's settings, if it is the
    /// document's.
    pub(in crate::app) fn compare_found(&mut self, sequence: Arc<Sequence>, inputs: &[PathBuf]) {
        let compared = self
            .opening
            .opened
            .compared
            .take_if(|compared| compared.inputs == inputs);
        self.compare_with(sequence);
        let (Some(compared), Some(split_view)) = (compared, &mut self.features.split_view) else {
            return;
        };
        split_view.arrange(&compared);
    }

    /// Saves the session to its file, or asks for one.
    pub(in crate::app) fn save_session(&mut self, asks: bool) {
        if let Err(reason) = self.session() {
            return self.notices.error(reason);
        }
        match &self.opening.opened.file {
            Some(file) if !asks => self.save_session_to(file.clone()),
            _ => {
                let name = format!("{}.{EXTENSION}", self.sequence_stem());
                self.ask(session_dialog(name));
            }
        }
    }

    /// Writes the session to a file on a thread.
    pub fn save_session_to(&mut self, file: PathBuf) {
        let session = match self.session() {
            Ok(session) => session,
            Err(reason) => return self.notices.error(reason),
        };
        if let skipped @ 1.. = self.features.inspection.undocumented() {
            let text = format!("Not in the session: {skipped} measured on the compared sequence");
            self.notices.warn(text);
        }
        let path = Arc::clone(&self.features.path.draft);
        let document = Box::new(self.stored_document());
        let copies = self.opening.opened.is_damaged && self.opening.opened.file.as_ref() == Some(&file);
        self.shared.tasks.try_start("save session", move || {
            if copies {
                copy_alongside(&file).map_err(TaskFailed)?;
            }
            let hash = session.write(&file).map_err(|reason| TaskFailed(reason.to_string()))?;
            Ok(SavedSession {
                file,
                path,
                document,
                hash,
            })
        });
    }

    /// Takes notice that it is written.
    pub(in crate::app) fn session_was_saved(&mut self, saved: SavedSession) {
        let SavedSession {
            file,
            path,
            document,
            hash,
        } = saved;
        self.notices.info(format!("Saved {}", file.display()));
        // A path stored in the session is not lost.
        self.features.path.note_stored(path);
        if let Err(problem) = self.stored.recent.add(std::slice::from_ref(&file)) {
            self.notices.warn(problem);
        }
        // Changes made while it was being written are stored as changes to the current file.
        self.keep_document();
        if let (Some(folder), Some(before)) = (&self.shared.options.documents, &self.opening.keeper.unsaved) {
            folder.forget_unsaved(before);
        }
        self.opening.keeper.unsaved = self.unsaved_place(&file, hash);
        self.opening.keeper.begun = (*document).clone();
        self.opening.opened.file = Some(file);
        self.opening.opened.is_damaged = false;
        self.note_saved(*document);
    }

    fn unsaved_place(&self, session: &Path, hash: TextHash) -> Option<UnsavedPlace> {
        let documents = self.shared.options.documents.as_ref()?;
        Some(documents.unsaved_place(session, hash))
    }

    /// The session is as it was saved, which is a change that can be undone.
    pub(in crate::app) fn revert_session(&mut self) {
        let mut saved = self.opening.keeper.saved.clone();
        saved.settings.drawing = self.style.drawing;
        if saved.up != self.document.up {
            self.take_chosen_up(saved.up);
        }
        self.take_undone(Some(saved));
    }

    /// Returns true if unsaved changes of the open session would be lost when the window closes.
    pub(in crate::app) fn session_would_be_lost(&self) -> bool {
        self.session_file().is_some() && self.is_unsaved() && !self.is_persisted()
    }

    /// Shows `sequence` of a session, in the session's state.
    pub fn open_session(&mut self, sequence: Arc<Sequence>, read: ReadSession) {
        let ReadSession {
            file,
            document,
            warnings,
            text_hash,
            mut unsaved,
        } = read;
        self.keep_document();
        let mut changes = String::new();
        if let Unsaved::Restored(saved) = &mut unsaved {
            // In the form that the window would have written.
            let read = Reading::of(&saved.reading.over(&self.shared.options.open));
            let topic = read.topic.clone().or_else(|| document.reading.topic.clone());
            saved.reading = Reading { topic, ..read };
            changes = document.changes_from(saved);
        }
        let before = self.new_style();
        let chosen = document.style();
        if !self.show(sequence, chosen) {
            return;
        }
        // The previous renderer is restored once another sequence is opened.
        self.opening.measured_way = Some(MeasuredWay { before, chosen });
        let is_damaged = !warnings.is_empty();
        for warning in warnings {
            self.notices.warn(warning);
        }
        let is_playing = self.player.as_ref().is_some_and(Player::is_playing);
        self.motion.turntable.is_on = false;
        self.apply_document(document);
        self.play_with(|player, now| {
            if is_playing && !player.sequence().source().is_live() {
                player.toggle(now);
            }
        });
        self.shared.options.is_fresh = false;
        // A document reopened in place does not have its own file.
        self.opening.keeper.unsaved = (!file.as_os_str().is_empty())
            .then(|| self.unsaved_place(&file, text_hash))
            .flatten();
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        self.opening.opened.file = Some(file);
        self.opening.opened.is_damaged = is_damaged;
        self.note_begun();
        self.tell_of_unsaved(&name, unsaved, &changes);
    }

    fn tell_of_unsaved(&mut self, name: &str, unsaved: Unsaved, changes: &str) {
        match unsaved {
            Unsaved::None => {}
            Unsaved::Restored(saved) => {
                self.note_saved(undrawn(*saved));
                self.notices.info(format!(
                    "Unsaved changes of {name} were restored: {changes}. Save session keeps them, Edit, Revert to \
                     saved session takes them back"
                ));
            }
            Unsaved::Outdated(aside) => self.notices.warn(format!(
                "{name} was written by another program since it was changed here: those changes are in {}, which opens \
                 as a session",
                aside.display()
            )),
        }
    }
}

/// Asks where to write the session.
pub(super) fn session_dialog(name: String) -> Dialog<State> {
    let save = |state: &mut State, file| state.save_session_to(with_extension(file, EXTENSION));
    Dialog::new_file("Save the session", name, save)
        .filter("Session", [EXTENSION])
        .of_own_work()
}

/// Copies the session file next to itself before saving, so that content that could not be read is not lost.
fn copy_alongside(file: &Path) -> Result<(), String> {
    match crate::persist::copy_alongside(file) {
        Ok(_) => Ok(()),
        Err(reason) if reason.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(reason) => Err(format!(
            "Not all of {} could be read, nor can it be copied ({reason}): save the session under another name",
            file.display()
        )),
    }
}
