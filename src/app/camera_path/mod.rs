//! The camera path that is being made: its keyframes ([`Draft`]), the time at which the next one is set, and its file.
//!
//! A path belongs to no sequence and stays when another one is opened. What is not in a file is never lost without a
//! question.

mod draft;
mod preview;

pub use draft::Draft;

use super::State;
use super::progress::WorkKind;
use super::state::WindowRequest;
use super::tasks::{DialogKind, Outcome};
use crate::playback::Player;
use crate::scene::{Camera, CameraPath, Keyframe};
use preview::Preview;
use std::path::PathBuf;
use std::sync::Arc;

/// From one keyframe to the next, unless a person says otherwise, seconds.
const DEFAULT_STEP_S: f64 = 2.0;

/// The camera path of the window.
#[derive(Debug)]
pub struct PathEditor {
    /// What there is of it; undo knows its states.
    pub draft: Arc<Draft>,
    /// Where in the video the next keyframe is set, seconds.
    pub(super) time_s: f64,
    /// The time moves on by so much after a keyframe at the end, seconds.
    pub(super) step_s: f64,
    /// What its file has.
    saved: Arc<Draft>,
    file: Option<PathBuf>,
    preview: Option<Preview>,
    /// What waits for an answer.
    pub(super) question: Option<Question>,
}

/// What would lose something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Question {
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
    pub(super) fn edit(&mut self, change: impl FnOnce(&mut Draft)) {
        change(Arc::make_mut(&mut self.draft));
    }
}

impl State {
    /// Sets a keyframe of what is shown at the path's time, or does so in place of the one that is there. At the end
    /// the time moves on.
    pub(super) fn add_keyframe(&mut self) {
        self.panels.path = true;
        let key = Keyframe {
            time_s: self.path.time_s,
            camera: self.camera,
            frame: self.frame_for_path(),
        };
        let mut draft = (*self.path.draft).clone();
        if let Err(reason) = draft.put(key) {
            return self
                .notices
                .error(format!("There is no keyframe of this view: {reason}"));
        }
        let is_last = draft
            .times_s()
            .is_some_and(|times| key.time_s >= *times.end());
        if is_last && self.path.draft.key_at(key.time_s).is_none() {
            self.path.time_s += self.path.step_s;
        }
        self.path.draft = Arc::new(draft);
    }

    /// Gives keyframe `index` the view and the frame that are shown.
    pub(super) fn replace_keyframe(&mut self, index: usize) {
        let mut draft = (*self.path.draft).clone();
        let frame = self.frame_for_path();
        match draft.replace(index, self.camera, frame) {
            Ok(()) => self.path.draft = Arc::new(draft),
            Err(reason) => self
                .notices
                .error(format!("The keyframe stays as it was: {reason}")),
        }
    }

    fn frame_for_path(&self) -> f64 {
        self.player.as_ref().map_or(0.0, |player| {
            player.waiting_for().unwrap_or(player.clock().frame()) as f64
        })
    }

    /// Puts the time of the path somewhere; where there is a part of the path, that is shown.
    pub fn set_path_time(&mut self, time_s: f64) {
        self.stop_preview();
        self.path.time_s = time_s;
        let draft = Arc::clone(&self.path.draft);
        if let (Some(path), Some(times_s)) = (draft.path(), draft.times_s())
            && times_s.contains(&time_s)
        {
            let (camera, frame) = path.at(time_s - times_s.start());
            self.show_of_path(camera, frame);
        }
    }

    /// Beyond its last frame the sequence begins anew, as in videos.
    fn show_of_path(&mut self, camera: Camera, frame: usize) {
        self.turntable.is_on = false;
        self.camera = camera;
        self.play_with(|player, now| {
            let frame = frame % player.sequence().len().max(1);
            if player.waiting_for().unwrap_or(player.clock().frame()) != frame {
                player.seek(frame, now);
            }
        });
    }

    /// Plays the path in the window, or stops that.
    pub(super) fn toggle_preview(&mut self) {
        if self.stop_preview() {
            return;
        }
        let Some(path) = self.path.draft.path().cloned() else {
            return self
                .notices
                .warn("The camera path has no keyframes yet: K sets one of what is shown");
        };
        let resumes = self.player.as_ref().is_some_and(Player::is_playing);
        if resumes {
            self.play_with(Player::toggle);
        }
        self.turntable.is_on = false;
        let at = (self.camera, self.now());
        self.path.preview = Some(Preview::new(path, self.path.time_s, at, resumes));
    }

    /// True if the path was playing.
    pub(super) fn stop_preview(&mut self) -> bool {
        let Some(preview) = self.path.preview.take() else {
            return false;
        };
        let is_paused = self
            .player
            .as_ref()
            .is_some_and(|player| !player.is_playing());
        if preview.resumes && is_paused {
            self.play_with(Player::toggle);
        }
        true
    }

    /// Moves a path that plays on.
    pub(super) fn move_on_path(&mut self) {
        let now = self.now();
        let Some(preview) = &mut self.path.preview else {
            return;
        };
        let Some(moment) = preview.step(&self.camera, now) else {
            self.stop_preview();
            return;
        };
        self.path.time_s = moment.time_s;
        self.show_of_path(moment.camera, moment.frame);
        if moment.is_end {
            self.stop_preview();
        }
    }

    /// Opens another path, begins a new one or ends the program, after a question if something would be lost.
    pub(super) fn ask_or_do(&mut self, what: Question) {
        let would_lose = match what {
            Question::Open | Question::New => self.path.is_unsaved(),
            Question::Quit => !self.losses().is_empty(),
        };
        if would_lose {
            self.path.question = Some(what);
        } else {
            self.go_on_with(what);
        }
    }

    /// Does what was asked about.
    pub(super) fn go_on_with(&mut self, what: Question) {
        self.path.question = None;
        match what {
            Question::Open => self.tasks.ask(DialogKind::OpenPath, None),
            Question::New => self.take_path(Draft::default(), None),
            Question::Quit => self.request(WindowRequest::Quit),
        }
    }

    /// What would be lost by the end of the program, a sentence each.
    pub(super) fn losses(&self) -> Vec<&'static str> {
        let path = self.path.is_unsaved();
        let export = self.works.has(WorkKind::Export);
        [
            (path, "The camera path is not saved."),
            (export, "An export is under way: it would be cancelled."),
        ]
        .into_iter()
        .filter_map(|(is_so, text)| is_so.then_some(text))
        .collect()
    }

    /// True if nothing is lost when the window closes; else the person is asked, and closing it again closes it.
    pub fn may_close(&mut self) -> bool {
        if self.path.question == Some(Question::Quit) || self.losses().is_empty() {
            return true;
        }
        self.path.question = Some(Question::Quit);
        false
    }

    /// Reads a path from a file on a thread.
    pub fn open_path(&mut self, file: PathBuf) {
        self.tasks
            .start("read camera path", move || match CameraPath::read(&file) {
                Ok(path) => Outcome::PathRead {
                    file,
                    draft: Arc::new(Draft::of(path)),
                },
                Err(reason) => Outcome::Failed(reason.to_string()),
            });
    }

    /// Saves the path to its file, or asks for one.
    pub(super) fn save_path(&mut self, asks: bool) {
        match &self.path.file {
            _ if self.path.draft.path().is_none() => {}
            Some(file) if !asks => self.save_path_to(file.clone()),
            _ => self
                .tasks
                .ask(DialogKind::SavePath, Some("camera-path.json".to_owned())),
        }
    }

    /// Writes the path to a file on a thread.
    pub fn save_path_to(&self, file: PathBuf) {
        let draft = Arc::clone(&self.path.draft);
        self.tasks.start("save camera path", move || {
            match draft.path().map(|path| path.write(&file)) {
                Some(Err(reason)) => Outcome::Failed(reason.to_string()),
                Some(Ok(())) | None => Outcome::PathSaved { file, draft },
            }
        });
    }

    pub(super) fn path_is_saved(&mut self, file: PathBuf, draft: Arc<Draft>) {
        self.notices.info(format!("Saved {}", file.display()));
        self.path.saved = draft;
        self.path.file = Some(file);
    }

    /// Takes another path in place of the one there is.
    pub(super) fn take_path(&mut self, draft: impl Into<Arc<Draft>>, file: Option<PathBuf>) {
        self.stop_preview();
        let draft = draft.into();
        self.path.saved = Arc::clone(&draft);
        self.path.time_s = draft.times_s().map_or(0.0, |times| *times.start());
        self.path.draft = draft;
        self.path.file = file;
    }
}
