//! Dialogs and the files that are chosen with them.

use super::State;
use super::dialogs::{Dialog, DialogAnswer};
use crate::app::work::files::{PicturePlace, document_folder, numbered_files, picture_folder, save_picture};
use crate::sequence::Sequence;
use std::path::{Path, PathBuf};

impl State {
    /// Asks the user. Does nothing while another dialog is open.
    pub(in crate::app) fn ask(&mut self, dialog: Dialog<Self>) {
        self.shared.dialogs.ask(dialog, &self.shared.tasks);
    }

    /// Takes the answer to a dialog.
    pub(in crate::app) fn take_answer(&mut self, answer: DialogAnswer<Self>) {
        self.shared.dialogs.note_answer();
        match answer {
            DialogAnswer::Chosen(dialog, paths) => dialog.answer(self, paths),
            DialogAnswer::Cancelled => {}
            DialogAnswer::NoDialog(dialog) => {
                let text = format!(
                    "No file dialog could be opened: on Linux one needs xdg-desktop-portal or zenity. {}",
                    dialog.advice()
                );
                match dialog.name_without_dialogs().map(|name| self.new_file(name)) {
                    Some(file) => {
                        self.notices.warn(text);
                        dialog.answer(self, vec![file]);
                    }
                    None => self.notices.error(text),
                }
            }
        }
    }

    /// Returns the path of a file that does not exist yet: with this name, or with a number appended to it, next to the
    /// open sequence.
    fn new_file(&self, name: &str) -> PathBuf {
        let data_folder = self.player.as_ref().and_then(|player| folder_of(player.sequence()));
        let folder = data_folder.unwrap_or_else(document_folder);
        let name = Path::new(name);
        let [stem, extension] =
            [name.file_stem(), name.extension()].map(|part| part.unwrap_or_default().to_string_lossy());
        let mut files = numbered_files(&folder, &stem, &extension);
        files.find(|file| !file.exists()).unwrap_or_default()
    }

    /// Writes `image` to `path`, or to a new file in the Pictures folder.
    pub fn save_picture(&mut self, image: image::RgbaImage, path: Option<PathBuf>) {
        let place = match path {
            Some(path) => PicturePlace::File(path),
            None => PicturePlace::New {
                folder: picture_folder(),
                stem: self.picture_stem(),
            },
        };
        self.shared
            .tasks
            .try_start("save image", move || save_picture(&image, place));
    }
}

/// Returns the folder in which users expect files made from a sequence: next to it.
pub(in crate::app) fn folder_of(sequence: &Sequence) -> Option<PathBuf> {
    let input = sequence.source().inputs().first()?;
    let folder = std::path::absolute(input).ok()?.parent()?.to_owned();
    let can_be_written = |folder: &PathBuf| folder.metadata().is_ok_and(|folder| !folder.permissions().readonly());
    Some(folder).filter(|folder| folder.is_dir() && can_be_written(folder))
}

#[cfg(test)]
mod tests {
    use super::super::session::session_dialog;
    use super::*;
    use crate::app::StateOptions;
    use std::fs;
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    #[test]
    fn without_a_dialog_a_session_is_saved_next_to_the_data_and_replaces_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let scan = folder.path().join("scan.xyz");
        fs::write(&scan, "0 0 0\n1 0 0\n0 1 0\n").unwrap();
        let other = folder.path().join("scan.pointreel");
        fs::write(&other, "not ours").unwrap();
        let mut state = State::new(StateOptions::default());
        state.open(Arc::new(Sequence::discover(&[scan]).unwrap()));
        state.take_answer(DialogAnswer::NoDialog(session_dialog("scan.pointreel".to_owned())));
        let saved = folder.path().join("scan-2.pointreel");
        let begin = Instant::now();
        while state.session_file() != Some(&saved) {
            assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", state.notices.list());
            let now = state.now();
            state.update(now);
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(fs::read_to_string(saved).unwrap().contains("scan.xyz"));
        assert_eq!(fs::read_to_string(other).unwrap(), "not ours");
    }

    #[test]
    fn opening_without_a_dialog_is_reported() {
        let mut state = State::new(StateOptions::default());
        let dialog = Dialog::files("Open point clouds", |_: &mut State, _| panic!("there is no dialog"));
        state.take_answer(DialogAnswer::NoDialog(dialog));
        let [notice] = state.notices.list() else {
            panic!("{:?}", state.notices.list())
        };
        assert!(notice.text.contains("Drop files"), "{}", notice.text);
    }
}
