//! What keys, menus, dialogs and tasks do to the state.

use super::dialogs::DialogKind;
use super::steering::steer;
use super::{State, WindowRequest};
use crate::app::command::{self, Command};
use crate::app::features::camera_path::Question;
use crate::app::features::comparison::Comparison;
use crate::app::features::export::ExportSubject;
use crate::app::features::palette::Palette;
use crate::app::sequence_name::name_of;
use crate::app::side::Side;
use crate::document::Edited;
use crate::playback::Player;
use crate::scene::describe::Value;
use crate::scene::{PointSizing, PointStyle, Primitive, Settings, Style, SurfelSettings};
use crate::sequence::Sequence;
use crate::timeline::PlayRange;
use std::sync::Arc;
use std::time::Duration;

/// The keys change sizes by this factor.
const SIZE_STEP: f32 = 1.25;

impl State {
    /// Moves the camera until all points are seen, and those beside them, keeping its direction.
    pub fn frame_all(&mut self) {
        if let Some(camera) = self.all_framed(&self.bounds_beside()) {
            self.glide_to(camera);
        }
    }

    /// Does what a key or menu asks for.
    pub fn run(&mut self, command: Command) {
        match command {
            Command::TogglePlay
            | Command::Step(_)
            | Command::First
            | Command::Last
            | Command::ToggleFollow
            | Command::NextLoopMode
            | Command::Slower
            | Command::Faster
            | Command::Reverse => self.play_with(|player, now| steer(player, command, now)),
            Command::SetIn => self.set_range(PlayRange::beginning_at),
            Command::SetOut => self.set_range(PlayRange::ending_at),
            Command::ClearRange => self.set_range(|_, _| PlayRange::default()),
            Command::ToggleMarker => self.toggle_marker(),
            Command::NextMarker => self.go_to_marker(true),
            Command::PreviousMarker => self.go_to_marker(false),
            Command::ResetView => self.reset_view(),
            Command::FrameAll => self.frame_all(),
            Command::LookFromSensor => self.look_from_sensor(),
            Command::Look(preset) => self.camera.look_from(preset),
            Command::ToggleOrthographic => self.toggle_projection(),
            Command::ToggleTurntable => self.motion.turntable.is_on ^= true,
            Command::Focus => self.focus_at_pointer(),
            Command::CopyView => self.copy_view(),
            Command::PasteView => self.requests.push(WindowRequest::PasteView),
            Command::ToggleTool(tool) => self.toggle_tool(tool),
            Command::ToggleGrid => self.style.backdrop.grid ^= true,
            Command::ToggleScaleBar => self.appearance.shows_scale_bar ^= true,
            Command::Smaller => self.scale_size(1.0 / SIZE_STEP),
            Command::Larger => self.scale_size(SIZE_STEP),
            Command::OpenFiles => self.ask(DialogKind::OpenFiles, None),
            Command::OpenFolder => self.ask(DialogKind::OpenFolder, None),
            Command::CompareFiles => self.ask(DialogKind::CompareFiles, None),
            Command::CompareFolder => self.ask(DialogKind::CompareFolder, None),
            Command::CloseComparison => {
                self.opened.compared = None;
                self.close_beside();
                self.end_comparison(Side::A);
            }
            Command::CloseSequence => {
                self.end_comparison(Side::A);
                self.close_sequence();
            }
            Command::NextLayout => self.next_layout(),
            Command::OpenDemo => self.open(Arc::new(Sequence::demo())),
            Command::OpenExample(example) => self.open(Arc::new(Sequence::example(example))),
            Command::ToggleRecording => self.toggle_recording(),
            Command::Screenshot => self.requests.push(WindowRequest::Screenshot(None)),
            Command::SaveScreenshotAs => {
                let name = format!("{}.png", self.picture_stem());
                self.ask(DialogKind::SavePicture, Some(name));
            }
            Command::ToggleExport => self.toggle_export(None),
            Command::ExportPath => self.toggle_export(Some(ExportSubject::Path)),
            Command::ToggleSave => self.toggle_save(),
            Command::AddKeyframe => self.add_keyframe(),
            Command::TogglePreview => self.toggle_preview(),
            Command::NewPath => self.ask_or_do(Question::New),
            Command::OpenPath => self.ask_or_do(Question::Open),
            Command::SavePath => self.save_path(false),
            Command::SavePathAs => self.save_path(true),
            Command::SaveSession => self.save_session(false),
            Command::SaveSessionAs => self.save_session(true),
            Command::FullScreen => self.requests.push(WindowRequest::FullScreen),
            Command::ToggleComparison => self.toggle_comparison(),
            Command::Undo => {
                let before = self.history.undo();
                self.take_edited(before);
            }
            Command::Redo => {
                let after = self.history.redo();
                self.take_edited(after);
            }
            Command::BeginAgain => self.begin_again(),
            Command::UseAsDefaults => self.use_as_defaults(),
            Command::TogglePanel(panel) => self.panels.toggle(panel),
            Command::ToggleTrails => self.toggle_trails(),
            Command::Theme(theme) => self.appearance.theme = theme,
            Command::ToggleThumbnails => self.thumbnails.is_on ^= true,
            Command::RedoThumbnails => self.thumbnails.redo(),
            Command::TogglePalette => {
                self.palette = match self.palette.take() {
                    Some(_) => None,
                    None => Some(Palette::default()),
                };
            }
            Command::Escape => self.escape(),
            Command::Quit => self.ask_or_do(Question::Quit),
        }
    }

    fn toggle_trails(&mut self) {
        self.trails.is_on ^= true;
        if self.trails.is_on && self.inspection.picked().next().is_none() {
            self.notices.hint("Pick a point (I and a click): its trail is shown");
        }
    }

    fn toggle_comparison(&mut self) {
        if self.beside.is_some() {
            let text = "Two sequences are compared: File, Close comparison ends that";
            return self.notices.hint(text);
        }
        if self.comparison.is_some() {
            self.end_comparison(Side::A);
        } else {
            self.comparison = Some(Comparison::new(self.style));
        }
    }

    /// Back to one picture, drawn as `side` was.
    pub(in crate::app) fn end_comparison(&mut self, side: Side) {
        self.edit_side(side);
        self.comparison = None;
    }

    /// The settings are those of `side` of two ways to draw from now on.
    pub(in crate::app) fn edit_side(&mut self, side: Side) {
        if let Some(comparison) = self.comparison.as_mut().filter(|comparison| comparison.edited != side) {
            comparison.edited = side;
            std::mem::swap(&mut comparison.other, &mut self.style);
        }
    }

    /// Ends what lies over all else: a question, a window, then what a tool has begun, the tool, the full screen. Menus
    /// close by themselves.
    fn escape(&mut self) {
        // The key has taken the keyboard from their fields already, so they do not see it. One thing at a time.
        let has_closed = self.palette.take().is_some()
            || self.preset_name.take().is_some()
            || self.timeline.renaming.take().is_some()
            || self.path.question.take().is_some()
            || self.stop_preview()
            || self.panels.close_topmost()
            || self.inspection.escape();
        if !has_closed && self.appearance.full_screen {
            self.requests.push(WindowRequest::FullScreen);
        }
    }

    /// Changes the player, if there is one, at the present time.
    pub(in crate::app) fn play_with(&mut self, change: impl FnOnce(&mut Player, Duration)) {
        if let Some(player) = &mut self.player {
            change(player, self.now);
        }
    }

    /// Looks whether something that undo takes back has changed. Call after the panels.
    pub(in crate::app) fn note_settings(&mut self, ctx: &egui::Context) {
        let (is_held, seconds) = ctx.input(|input| (input.pointer.any_down(), input.time));
        let now = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        let edited = self.edited();
        self.history.note(&edited, is_held, now);
        self.note_document();
    }

    /// What undo takes back.
    fn edited(&self) -> Edited {
        let player = self.player.as_ref();
        Edited {
            style: self.style,
            path: Arc::clone(&self.path.draft),
            labels: Arc::clone(&self.labels.list),
            markers: self.timeline.markers.list().to_vec(),
            range: player.map_or_else(PlayRange::default, |player| player.clock().range()),
            notes: self.notes.clone(),
        }
    }

    fn take_edited(&mut self, edited: Option<Edited>) {
        let Some(edited) = edited else { return };
        self.style = edited.style;
        self.path.draft = edited.path;
        self.labels.take(edited.labels);
        if let Some(problem) = self.timeline.take_markers(edited.markers) {
            self.notices.warn(problem);
        }
        self.notes = edited.notes;
        self.play_with(|player, now| player.set_range(edited.range, now));
        self.keep_document();
    }

    /// Asks the window for what only it can do.
    pub(in crate::app) fn request(&mut self, request: WindowRequest) {
        self.requests.push(request);
    }

    /// How an export draws: as the window does, but at full resolution.
    pub(in crate::app) fn style_of_export(&self) -> Style {
        self.drawn_style().with(|style| style.drawing.resolution = 1.0)
    }

    /// Draws as `way` from now on.
    pub fn draw_as(&mut self, way: &Settings) {
        self.style = self.style.drawn_as(way);
    }

    fn scale_size(&mut self, factor: f32) {
        let scaled = match self.drawn_style().primitive {
            Primitive::Mesh => &PointStyle::SIZE_PX,
            Primitive::Point if self.style.points.sizing == PointSizing::Pixels => &PointStyle::SIZE_PX,
            Primitive::Point => &PointStyle::SCALE,
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite | Primitive::Voxel => {
                &SurfelSettings::SPLAT_SCALE
            }
        };
        self.style.edit(&mut |described, value| match value {
            Value::Number(size) if described.key == scaled.key => {
                described.nearest(Value::Number(size * f64::from(factor)))
            }
            _ => value,
        });
    }

    /// Takes the keys out of egui's input and does what they ask for. Call before the panels.
    pub fn handle_keys(&mut self, ctx: &egui::Context) {
        let typing = ctx.text_edit_focused();
        let (events, modifiers, now_secs) = ctx.input(|input| (input.raw.events.clone(), input.modifiers, input.time));
        self.motion.fly.note(&events, typing);
        self.handle_clipboard(ctx);
        for command in command::dispatch(ctx) {
            // While flying, Ctrl is the slow pace and Q the way down.
            if command != Command::Quit || !self.motion.fly.is_flying() {
                self.run(command);
            }
        }
        if self.motion.fly.is_flying() {
            self.motion.fly.step(&mut self.camera, now_secs, modifiers);
            ctx.request_repaint();
        }
    }

    /// What is open, for the title and for names of files.
    pub fn sequence_name(&self) -> Option<String> {
        name_of(self.player.as_ref()?.sequence())
    }

    pub(super) fn picture_stem(&self) -> String {
        let stem = self.sequence_stem();
        let shown = self.player.as_ref().and_then(|player| {
            let frame = player.shown()?;
            Some((frame.index + 1, player.sequence().len()))
        });
        // As the timeline has it: names by {frame} have the index, which would be taken for another place.
        shown.map_or(format!("pointreel-{stem}"), |(place, count)| {
            let digits = count.to_string().len();
            format!("pointreel-{stem}-{place:0digits$}-of-{count}")
        })
    }

    /// What is open, for names of files: without extension.
    pub(in crate::app) fn sequence_stem(&self) -> String {
        let name = self.sequence_name().unwrap_or_else(|| "empty".to_owned());
        name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.to_owned())
    }

    /// Compares the picture of the window's settings, or of the open sequence, with the other one.
    pub fn compare_pictures(&self, edited: image::RgbaImage, other: image::RgbaImage) {
        let edited_side = self.comparison.as_ref().map(|comparison| comparison.edited);
        let pair = match edited_side {
            Some(Side::B) => [other, edited],
            Some(Side::A) | None => [edited, other],
        };
        if let Some(pictures) = self.pictures() {
            pictures.compare(pair, &self.tasks);
        }
    }

    /// From now on the processor draws in place of the graphics card whose device was lost, until a person chooses who
    /// draws.
    pub(in crate::app) fn draw_without_gpu(&mut self) {
        self.main.without_gpu = Some(self.style.drawing.renderer);
        self.forget_picture();
    }
}
