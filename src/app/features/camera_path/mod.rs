//! The camera path being edited: its keyframes ([`Draft`]), the time at which the next one is set, and its file.
//!
//! A path belongs to the document. Unsaved changes are never lost without a question.

mod in_window;
mod keyframes;
pub(in crate::app) mod marks;
pub(in crate::app) mod panel;
mod question;
pub(in crate::app) mod request;

mod file;
mod preview;

pub use crate::document::Draft;
pub use file::PathFile;
pub(in crate::app) use file::{read_path, save_path};

use crate::scene::{Camera, Keyframe, PathError};
use preview::{Preview, PreviewTime};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Default time from one keyframe to the next, seconds.
const DEFAULT_STEP_S: f64 = 2.0;

/// The camera path of the window.
#[derive(Debug)]
pub struct PathEditor {
    /// Current state of the path; undo keeps its states.
    pub draft: Arc<Draft>,
    /// Time in the video at which the next keyframe is set, seconds.
    pub(in crate::app) time_s: f64,
    /// The time moves on by so much after a keyframe at the end, seconds.
    pub(in crate::app) step_s: f64,
    /// Saved state in its file.
    saved: Arc<Draft>,
    file: Option<PathBuf>,
    preview: Option<Preview>,
    /// Question waiting for an answer.
    pub(in crate::app) question: Option<Question>,
}

/// Action that would lose unsaved data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum Question {
    /// Another path is to be opened.
    Open,
    /// A new path is to be begun.
    New,
    /// The program is to end.
    Quit,
}

impl Default for PathEditor {
    fn default() -> Self {
        Self {
            draft: Arc::default(),
            time_s: 0.0,
            step_s: DEFAULT_STEP_S,
            saved: Arc::default(),
            file: None,
            preview: None,
            question: None,
        }
    }
}

impl PathEditor {
    /// True if the path is not as in its file.
    pub fn is_unsaved(&self) -> bool {
        !Arc::ptr_eq(&self.draft, &self.saved) && self.draft != self.saved
    }

    /// True while it plays in the window.
    pub fn is_playing(&self) -> bool {
        self.preview.is_some()
    }

    /// Its file, if it has one.
    pub fn file(&self) -> Option<&PathBuf> {
        self.file.as_ref()
    }

    /// Changes the path as one step of undo.
    pub(in crate::app) fn edit(&mut self, change: impl FnOnce(&mut Draft)) {
        change(Arc::make_mut(&mut self.draft));
    }

    /// Sets a keyframe at its time, or replaces an existing one. At the end the time advances.
    pub(in crate::app) fn set_keyframe(&mut self, camera: Camera, frame: f64) -> Result<(), PathError> {
        let key = Keyframe {
            time_s: self.time_s,
            camera,
            frame,
        };
        let mut draft = (*self.draft).clone();
        draft.put(key)?;
        let is_last = draft.times_s().is_some_and(|times| key.time_s >= *times.end());
        if is_last && self.draft.key_at(key.time_s).is_none() {
            self.time_s += self.step_s;
        }
        self.draft = Arc::new(draft);
        Ok(())
    }

    /// Gives keyframe `index` another view and frame.
    pub(in crate::app) fn replace_keyframe(
        &mut self,
        index: usize,
        camera: Camera,
        frame: f64,
    ) -> Result<(), PathError> {
        let mut draft = (*self.draft).clone();
        draft.replace(index, camera, frame)?;
        self.draft = Arc::new(draft);
        Ok(())
    }

    /// Returns the camera and frame at its time, if that is within the path.
    pub(in crate::app) fn at_time(&self) -> Option<(Camera, usize)> {
        let (path, times_s) = (self.draft.path()?, self.draft.times_s()?);
        times_s
            .contains(&self.time_s)
            .then(|| path.at(self.time_s - times_s.start()))
    }

    /// Plays it from its time on. `resumes`: the sequence was playing before. False without keyframes.
    pub(in crate::app) fn play(&mut self, camera: Camera, now: Duration, resumes: bool) -> bool {
        let preview = self.draft.path().cloned();
        self.preview = preview.map(|path| Preview::new(path, self.time_s, camera, now, resumes));
        self.is_playing()
    }

    /// Stops it; whether the sequence was playing before, if the path was playing.
    pub(in crate::app) fn stop(&mut self) -> Option<bool> {
        self.preview.take().map(|preview| preview.resumes)
    }

    /// Returns the position of the playing path at `now`; `None` if the camera has been moved by something else.
    pub(in crate::app) fn step(&mut self, camera: &Camera, now: Duration) -> Option<PreviewTime> {
        let preview_time = self.preview.as_mut()?.step(camera, now)?;
        self.time_s = preview_time.time_s;
        Some(preview_time)
    }

    /// Replaces the path by another.
    pub(in crate::app) fn take(&mut self, draft: Arc<Draft>, file: Option<PathBuf>) {
        self.saved = Arc::clone(&draft);
        self.time_s = draft.times_s().map_or(0.0, |times| *times.start());
        self.draft = draft;
        self.file = file;
    }

    /// Records that `draft` is stored in another file: its own stays unchanged.
    pub(in crate::app) fn note_stored(&mut self, draft: Arc<Draft>) {
        self.saved = draft;
    }

    /// Takes notice that `draft` is in `file` now.
    pub(in crate::app) fn note_saved(&mut self, file: PathBuf, draft: Arc<Draft>) {
        self.saved = draft;
        self.file = Some(file);
    }
}
