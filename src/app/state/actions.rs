//! State actions triggered by keys, menus, dialogs and tasks.

use super::{State, WindowRequest};
use crate::app::command::Command;
use crate::app::commands::dispatch;
use crate::app::features::Features;
use crate::app::sequence_name::name_of;
use crate::document::{Document, History};
use crate::playback::Player;
use crate::scene::describe::Value;
use crate::scene::{PointSizing, PointStyle, Primitive, Settings, Style, SurfelSettings};
use std::time::Duration;

impl State {
    /// Moves the camera until all points are in view, including the compared sequence, keeping its direction.
    pub fn frame_all(&mut self) {
        if let Some(camera) = self.all_framed(&self.second_bounds()) {
            self.glide_to(camera);
        }
    }

    /// Closes the topmost of: a question, a window, the unfinished work of a tool, the tool, the full screen. Menus
    /// close by themselves.
    pub(in crate::app) fn escape(&mut self) {
        // The key has already been taken from the text fields, so they do not see it. Only one thing is closed at a
        // time.
        let has_closed = Features::rows::<Self>().iter().any(|feature| feature.escape(self))
            || self.stored.preset_name.take().is_some()
            || self.panels.close_topmost()
            || self.features.inspection.escape();
        if !has_closed && self.appearance.full_screen {
            self.shared.requests.push(WindowRequest::FullScreen);
        }
    }

    /// Changes the player, if there is one, at the present time.
    pub(in crate::app) fn play_with(&mut self, change: impl FnOnce(&mut Player, Duration)) {
        if let Some(player) = &mut self.player {
            change(player, self.shared.now);
        }
    }

    /// Checks for changes of undoable or stored data. Call after the panels.
    pub(in crate::app) fn note_changes(&mut self, ctx: &egui::Context) {
        let (is_held, seconds) = ctx.input(|input| (input.pointer.any_down(), input.time));
        let now = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.note_in_history(|history, document| history.note(document, is_held, now));
        self.look_at_document();
    }

    /// Check between two steps that are undone separately, as above: lines of a script, and before undo.
    pub(in crate::app) fn note_step(&mut self) {
        self.note_in_history(History::note_step);
    }

    fn note_in_history(&mut self, note: impl FnOnce(&mut History, &Document)) {
        self.gather_document();
        // When two styles are compared, undo applies to the one whose settings are shown.
        let of_a = self.document.style();
        self.document.set_style(self.style);
        note(&mut self.history, &self.document);
        self.document.set_style(of_a);
    }

    /// Takes back the last change.
    pub(in crate::app) fn undo(&mut self) {
        self.note_step();
        let before = self.history.undo();
        self.take_undone(before);
    }

    /// Makes the change again that was taken back last.
    pub(in crate::app) fn redo(&mut self) {
        self.note_step();
        let after = self.history.redo();
        self.take_undone(after);
    }

    /// Requests an action that only the window can do.
    pub(in crate::app) fn request(&mut self, request: WindowRequest) {
        self.shared.requests.push(request);
    }

    /// Returns the render style of an export: as in the window, but at full resolution.
    pub(in crate::app) fn style_of_export(&self) -> Style {
        self.drawn_style().with(|style| style.drawing.resolution = 1.0)
    }

    /// Draws with the mode `way` from now on.
    pub fn draw_as(&mut self, way: &Settings) {
        self.style = self.style.drawn_as(way);
    }

    pub(in crate::app) fn scale_size(&mut self, factor: f32) {
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

    /// Takes the keys out of egui's input and runs their commands. Call before the panels.
    pub fn handle_keys(&mut self, ctx: &egui::Context) {
        let typing = ctx.text_edit_focused();
        let (events, modifiers, now_secs) = ctx.input(|input| (input.raw.events.clone(), input.modifiers, input.time));
        self.motion.fly.note(&events, typing);
        self.handle_clipboard(ctx);
        for command in dispatch(ctx) {
            // While flying, Ctrl means slow and Q down.
            if command != Command::QUIT || !self.motion.fly.is_flying() {
                self.run(command);
            }
        }
        if self.motion.fly.is_flying() {
            self.motion.fly.step(&mut self.camera, now_secs, modifiers);
            ctx.request_repaint();
        }
    }

    /// Returns the display name of the open sequence, for the title and for file names.
    pub fn sequence_name(&self) -> Option<String> {
        name_of(self.player.as_ref()?.sequence())
    }

    pub(in crate::app) fn picture_stem(&self) -> String {
        let stem = self.sequence_stem();
        let shown = self.player.as_ref().and_then(|player| {
            let frame = player.shown()?;
            Some((frame.index + 1, player.sequence().len()))
        });
        // Numbered as on the timeline: names by {frame} contain the index, which would be mistaken for a different
        // position.
        shown.map_or(format!("pointreel-{stem}"), |(place, count)| {
            let digits = count.to_string().len();
            format!("pointreel-{stem}-{place:0digits$}-of-{count}")
        })
    }

    /// Returns the file stem of the open sequence: its name without extension.
    pub(in crate::app) fn sequence_stem(&self) -> String {
        let name = self.sequence_name().unwrap_or_else(|| "empty".to_owned());
        name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.to_owned())
    }

    /// Switches to the CPU renderer after the GPU device was lost, until a user chooses a renderer.
    pub(in crate::app) fn draw_without_gpu(&mut self) {
        self.main.without_gpu = Some(self.style.drawing.renderer);
        self.forget_picture();
    }
}
