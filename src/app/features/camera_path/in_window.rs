//! The camera path in the window: keyframes of the view, the playing path, its file, and unsaved changes.

use super::PathEditor;
use super::marks::paint_path;
use super::panel::camera_path_ui;
use super::question::question_ui;
use super::request::PathRequest;
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group};
use crate::app::features::Features;
use crate::app::features::camera_path::{Draft, PathFile, Question, read_path, save_path};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::open_panels::PanelId;
use crate::app::panel_row::PanelRow;
use crate::app::state::{Dialog, State, WindowRequest};
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::files::with_extension;
use crate::app::work::outcome::Outcome;
use crate::document::Document;
use crate::playback::Player;
use crate::scene::Camera;
use crate::timeline::DEFAULT_FPS;
use egui::Key;
use egui::Ui;
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// Sets a keyframe of the view at the path's time.
    pub(in crate::app) fn add_keyframe(&mut self) {
        self.panels.set(PanelId::CAMERA_PATH, true);
        let frame = self.frame_for_path();
        if let Err(reason) = self.features.path.set_keyframe(self.camera, frame) {
            self.notices.error(format!("No keyframe can be set here: {reason}"));
        }
    }

    /// Gives keyframe `index` the view and the frame that are shown.
    pub(in crate::app) fn replace_keyframe(&mut self, index: usize) {
        let frame = self.frame_for_path();
        if let Err(reason) = self.features.path.replace_keyframe(index, self.camera, frame) {
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
        self.features.path.time_s = time_s;
        if let Some((camera, frame)) = self.features.path.at_time() {
            self.show_of_path(camera, frame);
        }
    }

    /// Shows a frame of the path; beyond its last frame the sequence restarts, as in videos.
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
    pub(in crate::app) fn toggle_preview(&mut self) {
        if self.stop_preview() {
            return;
        }
        let resumes = self.player.as_ref().is_some_and(Player::is_playing);
        if !self.features.path.play(self.camera, self.shared.now, resumes) {
            return self
                .notices
                .warn("The camera path has no keyframes yet: press K to set one");
        }
        if resumes {
            self.play_with(Player::toggle);
        }
        self.motion.turntable.is_on = false;
    }

    /// True if the path was playing.
    pub(in crate::app) fn stop_preview(&mut self) -> bool {
        let Some(resumes) = self.features.path.stop() else {
            return false;
        };
        let is_paused = self.player.as_ref().is_some_and(|player| !player.is_playing());
        if resumes && is_paused {
            self.play_with(Player::toggle);
        }
        true
    }

    /// Moves a path that plays on.
    pub(in crate::app) fn move_on_path(&mut self) {
        if !self.features.path.is_playing() {
            return;
        }
        let preview_time = self.features.path.step(&self.camera, self.shared.now);
        if let Some(preview_time) = preview_time {
            self.show_of_path(preview_time.camera, preview_time.frame);
        }
        if preview_time.is_none_or(|preview_time| preview_time.is_end) {
            self.stop_preview();
        }
    }

    /// Opens another path, begins a new one or ends the program, after a question if something would be lost.
    pub(in crate::app) fn ask_or_do(&mut self, what: Question) {
        let would_lose = match what {
            Question::Open | Question::New => self.features.path.is_unsaved(),
            Question::Quit => !self.losses().is_empty(),
        };
        if would_lose {
            self.features.path.question = Some(what);
        } else {
            self.go_on_with(what);
        }
    }

    /// Continues with the action of the question.
    pub(in crate::app) fn go_on_with(&mut self, what: Question) {
        self.features.path.question = None;
        match what {
            Question::Open => self.ask(
                Dialog::file("Open a camera path", State::open_path)
                    .filter("Camera path", ["json"])
                    .without("Name a session with the camera path on the command line: pointreel view FILE.pointreel"),
            ),
            Question::New => self.take_path(Arc::new(Draft::default()), None),
            Question::Quit => self.request(WindowRequest::Quit),
        }
    }

    /// Ends the program, after a question if something would be lost.
    pub(in crate::app) fn quit(&mut self) {
        self.ask_or_do(Question::Quit);
    }

    /// Returns the unsaved data that would be lost by quitting the program, one sentence each.
    pub(in crate::app) fn losses(&self) -> Vec<&'static str> {
        let losses = Features::rows::<Self>().into_iter();
        let losses = losses.filter_map(|feature| feature.loss(self));
        let of_session = self.session_would_be_lost();
        let of_session = of_session.then_some("The session has changes that are not saved.");
        losses.chain(of_session).collect()
    }

    /// True if nothing is lost when the window closes; else the user is asked, and closing it again closes it.
    pub fn may_close(&mut self) -> bool {
        if self.features.path.question == Some(Question::Quit) || self.losses().is_empty() {
            return true;
        }
        self.features.path.question = Some(Question::Quit);
        false
    }

    /// Reads a path from a file on a thread.
    pub fn open_path(&mut self, file: PathBuf) {
        self.shared.tasks.try_start("read camera path", move || read_path(file));
    }

    /// Saves the path to its file, or asks for one.
    pub(in crate::app) fn save_path(&mut self, asks: bool) {
        match self.features.path.file() {
            _ if self.features.path.draft.path().is_none() => {}
            Some(file) if !asks => self.save_path_to(file.clone()),
            _ => {
                let save = |state: &mut State, file| state.save_path_to(with_extension(file, "json"));
                let dialog = Dialog::new_file("Save the camera path", "camera-path.json".to_owned(), save);
                self.ask(dialog.filter("Camera path", ["json"]).of_own_work());
            }
        }
    }

    /// Writes the path to a file on a thread.
    pub fn save_path_to(&self, file: PathBuf) {
        let draft = Arc::clone(&self.features.path.draft);
        self.shared
            .tasks
            .try_start("save camera path", move || save_path(file, draft));
    }

    /// Takes the result of a file operation.
    pub(in crate::app) fn take_path_file(&mut self, path: PathFile) {
        match path {
            PathFile::Read { file, draft } => self.take_path(draft, Some(file)),
            PathFile::Saved { file, draft } => {
                self.notices.info(format!("Saved {}", file.display()));
                self.features.path.note_saved(file, draft);
            }
        }
    }

    fn take_path(&mut self, draft: Arc<Draft>, file: Option<PathBuf>) {
        self.stop_preview();
        self.features.path.take(draft, file);
    }
}

const COMMANDS: &[Row] = &[
    Row::new(Command::panel(PanelId::CAMERA_PATH), "Camera path…", |state| {
        state.panels.toggle(PanelId::CAMERA_PATH);
    })
    .what("Camera path…")
    .also(&[
        "fly-through",
        "animation",
        "keyframes",
        "trajectory",
        "path editor",
        "camera animation",
    ])
    .keys(group::VIEW, "F4", &[Chord::plain(Key::F4)])
    .on_if(|state| state.panels.has(PanelId::CAMERA_PATH)),
    Row::new(
        Command::ADD_KEYFRAME,
        "Add a keyframe of the current view",
        State::add_keyframe,
    )
    .also(&["record view", "bookmark view", "save viewpoint"])
    .keys(group::VIEW, "K", &[Chord::plain(Key::K)]),
    Row::new(
        Command::TOGGLE_PREVIEW,
        "Play the camera path, or stop",
        State::toggle_preview,
    )
    .also(&["preview", "animate", "fly-through"])
    .keys(group::VIEW, "Shift+K", &[Chord::shift(Key::K)])
    .applies(needs_path),
    Row::new(Command::NEW_PATH, "New camera path", |state| {
        state.ask_or_do(Question::New);
    }),
    Row::new(Command::OPEN_PATH, "Open a camera path", |state| {
        state.ask_or_do(Question::Open);
    }),
    Row::new(Command::SAVE_PATH, "Save the camera path", |state| {
        state.save_path(false);
    })
    .applies(needs_path),
    Row::new(
        Command::SAVE_PATH_AS,
        "Save the camera path as a file of a name",
        |state| state.save_path(true),
    )
    .applies(needs_path),
];

fn needs_path(state: &State) -> Result<(), &'static str> {
    match state.features.path.draft.path() {
        Some(_) => Ok(()),
        None => Err("The camera path has no keyframes yet: press K to set one"),
    }
}

impl Feature<State> for FeatureOf<PathEditor> {
    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|path: PathFile| state.take_path_file(path))
    }

    /// Forgets the sequence; unsaved data is not lost without a question.
    fn forget_sequence(&self, state: &mut State) {
        if state.is_persisted() || !state.features.path.is_unsaved() {
            state.stop_preview();
            state.features.path.take(Arc::default(), None);
        }
    }

    fn save(&self, state: &State, document: &mut Document) {
        document.path = Arc::clone(&state.features.path.draft);
    }

    fn load(&self, state: &mut State, document: &Document) {
        if document.path.path().is_some() {
            state.stop_preview();
            state.features.path.take(Arc::clone(&document.path), None);
        }
    }

    /// It is edited on, at its time and with its file.
    fn put_back(&self, state: &mut State, document: &Document) {
        state.features.path.draft = Arc::clone(&document.path);
    }

    fn escape(&self, state: &mut State) -> bool {
        state.features.path.question.take().is_some() || state.stop_preview()
    }

    fn loss(&self, state: &State) -> Option<&'static str> {
        let is_unsaved = state.features.path.is_unsaved() && !state.is_persisted();
        is_unsaved.then_some("The camera path is not saved.")
    }

    fn paint(&self, state: &State, canvas: &PictureOverlay<'_>, _is_first: bool) {
        if let Some(path) = state.features.path.draft.path()
            && state.panels.has(PanelId::CAMERA_PATH)
            && !state.features.path.is_playing()
        {
            paint_path(canvas, path);
        }
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[
            PanelRow::in_menu(PanelId::CAMERA_PATH, "Camera path…", camera_path),
            PanelRow::by_itself(question_ui),
        ];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn camera_path(ui: &mut Ui, state: &mut State) {
    let player = state.player.as_ref();
    let fps = player.map_or(DEFAULT_FPS, |player| player.clock().fps());
    let corner = state.viewport.rect.left_top();
    let mut is_open = state.panels.has(PanelId::CAMERA_PATH);
    let request = camera_path_ui(ui, &mut is_open, &mut state.features.path, fps, corner);
    state.panels.set(PanelId::CAMERA_PATH, is_open);
    match request {
        Some(PathRequest::Run(command)) => state.run(command),
        Some(PathRequest::GoTo(time_s)) => state.set_path_time(time_s),
        Some(PathRequest::Replace(index)) => state.replace_keyframe(index),
        None => {}
    }
}
