//! The camera path in the window: keyframes of what is shown, the path as it plays, its file, and what would be lost.

use super::dialogs::DialogKind;
use super::{State, WindowRequest};
use crate::app::features::camera_path::{Draft, PathFile, Question, read_path, save_path};
use crate::app::open_panels::PanelId;
use crate::app::work::works::WorkKind;
use crate::playback::Player;
use crate::scene::Camera;
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// Sets a keyframe of what is shown at the path's time.
    pub(super) fn add_keyframe(&mut self) {
        self.panels.set(PanelId::CAMERA_PATH, true);
        let frame = self.frame_for_path();
        if let Err(reason) = self.path.set_keyframe(self.camera, frame) {
            self.notices
                .error(format!("There is no keyframe of this view: {reason}"));
        }
    }

    /// Gives keyframe `index` the view and the frame that are shown.
    pub(in crate::app) fn replace_keyframe(&mut self, index: usize) {
        let frame = self.frame_for_path();
        if let Err(reason) = self.path.replace_keyframe(index, self.camera, frame) {
            self.notices.error(format!("The keyframe stays as it was: {reason}"));
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
        if let Some((camera, frame)) = self.path.at_time() {
            self.show_of_path(camera, frame);
        }
    }

    /// Beyond its last frame the sequence begins anew, as in videos.
    fn show_of_path(&mut self, camera: Camera, frame: usize) {
        self.motion.turntable.is_on = false;
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
        let resumes = self.player.as_ref().is_some_and(Player::is_playing);
        if !self.path.play((self.camera, self.now), resumes) {
            return self
                .notices
                .warn("The camera path has no keyframes yet: K sets one of what is shown");
        }
        if resumes {
            self.play_with(Player::toggle);
        }
        self.motion.turntable.is_on = false;
    }

    /// True if the path was playing.
    pub(super) fn stop_preview(&mut self) -> bool {
        let Some(resumes) = self.path.stop() else {
            return false;
        };
        let is_paused = self.player.as_ref().is_some_and(|player| !player.is_playing());
        if resumes && is_paused {
            self.play_with(Player::toggle);
        }
        true
    }

    /// Moves a path that plays on.
    pub(super) fn move_on_path(&mut self) {
        if !self.path.is_playing() {
            return;
        }
        let moment = self.path.step(&self.camera, self.now);
        if let Some(moment) = moment {
            self.show_of_path(moment.camera, moment.frame);
        }
        if moment.is_none_or(|moment| moment.is_end) {
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
    pub(in crate::app) fn go_on_with(&mut self, what: Question) {
        self.path.question = None;
        match what {
            Question::Open => self.ask(DialogKind::OpenPath, None),
            Question::New => self.take_path(Arc::new(Draft::default()), None),
            Question::Quit => self.request(WindowRequest::Quit),
        }
    }

    /// What would be lost by the end of the program, a sentence each.
    pub(in crate::app) fn losses(&self) -> Vec<&'static str> {
        let path = self.path.is_unsaved() && !self.is_kept();
        let export = self.works.has(WorkKind::Export);
        let save = self.works.has(WorkKind::Save);
        [
            (path, "The camera path is not saved."),
            (export, "An export is under way: it would be cancelled."),
            (
                save,
                "The sequence is being saved: saving it again would go on from there.",
            ),
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
        self.tasks.try_start("read camera path", move || read_path(file));
    }

    /// Saves the path to its file, or asks for one.
    pub(super) fn save_path(&mut self, asks: bool) {
        match self.path.file() {
            _ if self.path.draft.path().is_none() => {}
            Some(file) if !asks => self.save_path_to(file.clone()),
            _ => self.ask(DialogKind::SavePath, Some("camera-path.json".to_owned())),
        }
    }

    /// Writes the path to a file on a thread.
    pub fn save_path_to(&self, file: PathBuf) {
        let draft = Arc::clone(&self.path.draft);
        self.tasks.try_start("save camera path", move || save_path(file, draft));
    }

    /// Takes what became of a file.
    pub(super) fn take_path_file(&mut self, path: PathFile) {
        match path {
            PathFile::Read { file, draft } => self.take_path(draft, Some(file)),
            PathFile::Saved { file, draft } => {
                self.notices.info(format!("Saved {}", file.display()));
                self.path.note_saved(file, draft);
            }
        }
    }

    fn take_path(&mut self, draft: Arc<Draft>, file: Option<PathBuf>) {
        self.stop_preview();
        self.path.take(draft, file);
    }
}
