//! The camera path: its time, its keyframes, its file.

use super::PathEditor;
use super::keyframes::{keyframes_ui, seconds};
use super::request::PathRequest;
use crate::app::command::Command;
use crate::app::commands::keys_of;
use crate::app::open_panels::PanelId;
use crate::app::widgets::names::named;
use crate::app::widgets::settle::settle;
use crate::app::widgets::tool_window::tool_window;
use egui::{Align2, Button, Checkbox, Pos2, RichText, Slider, Ui, vec2};

/// Times that are offered, seconds.
const TIMES_S: std::ops::RangeInclusive<f64> = 0.0..=1e6;

/// Shows the window while it is open, at `corner`. The sequence plays at `fps` frames per second.
pub(in crate::app) fn camera_path_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    path: &mut PathEditor,
    fps: f64,
    corner: Pos2,
) -> Option<PathRequest> {
    let mut request = None;
    let shown = tool_window(ui.ctx(), PanelId::CAMERA_PATH.name(), "Camera path")
        .open(is_open)
        .resizable(false)
        .pivot(Align2::LEFT_TOP)
        .default_pos(corner + vec2(12.0, 12.0))
        .show(ui, |ui| {
            request = time_ui(ui, path);
            ui.separator();
            request = keyframes_ui(ui, path, fps).or(request);
            ui.separator();
            request = file_ui(ui, path).map(PathRequest::Run).or(request);
        });
    settle(ui, "Camera path", shown);
    request
}

fn time_ui(ui: &mut Ui, path: &mut PathEditor) -> Option<PathRequest> {
    let mut request = None;
    let mut time_s = path.time_s;
    ui.horizontal(|ui| {
        let label = ui.label("Time");
        let tooltip = "Where in the video the next keyframe is set; within the path its view is shown";
        ui.add(seconds(&mut time_s).range(TIMES_S))
            .labelled_by(label.id)
            .on_hover_text(tooltip);
        let label = ui.label("Step");
        let tooltip = "How far the time moves on after a keyframe at the end";
        ui.add(seconds(&mut path.step_s).range(0.001..=1e5))
            .labelled_by(label.id)
            .on_hover_text(tooltip);
    });
    if let Some(times_s) = path.draft.times_s()
        && times_s.start() < times_s.end()
    {
        ui.spacing_mut().slider_width = ui.available_width();
        // The time may be past the end of the path, where the next keyframe will be added.
        let mut along_s = time_s.clamp(*times_s.start(), *times_s.end());
        let slider = Slider::new(&mut along_s, times_s).show_value(false);
        let slider = ui.add(slider).on_hover_text("Shows the path at any time");
        named(&slider, "Along the path");
        if slider.changed() {
            time_s = along_s;
        }
    }
    if time_s != path.time_s {
        request = Some(PathRequest::GoTo(time_s));
    }
    ui.horizontal(|ui| {
        for (text, tooltip, command) in [
            (
                "Add keyframe",
                "Sets the view of the path at this time to the current one",
                Command::ADD_KEYFRAME,
            ),
            if path.is_playing() {
                ("Stop", "Stops where it is (Esc)", Command::TOGGLE_PREVIEW)
            } else {
                (
                    "Preview",
                    "Plays the path in the window at its speed; Esc stops it",
                    Command::TOGGLE_PREVIEW,
                )
            },
        ] {
            let button = Button::new(text).shortcut_text(keys_of(command));
            let response = ui.add(button).on_hover_text(tooltip);
            named(&response, text);
            if response.clicked() {
                request = Some(PathRequest::Run(command));
            }
        }
    });
    request
}

fn file_ui(ui: &mut Ui, path: &mut PathEditor) -> Option<Command> {
    let mut asked = None;
    let draft = &path.draft;
    let mut eases = draft.eases();
    let ease = ui.add(Checkbox::new(&mut eases, "Ease in and out"));
    if ease.on_hover_text("The camera starts and ends at rest").changed() {
        path.edit(|draft| draft.set_eases(eases));
    }
    let draft = &path.draft;
    let count = draft.keyframes().len();
    let duration_s = draft.times_s().map_or(0.0, |times| times.end() - times.start());
    let name = path.file().and_then(|file| file.file_name());
    let name = name.map_or("no file yet".into(), |name| name.to_string_lossy());
    ui.horizontal(|ui| {
        ui.weak(format!("{count} keyframes, {duration_s:.2} s, {name}"));
        if path.is_unsaved() {
            ui.label(RichText::new("not saved").color(ui.visuals().warn_fg_color));
        }
    });
    let has_path = draft.path().is_some();
    ui.horizontal(|ui| {
        for (text, name, is_offered, tooltip, command) in [
            (
                "New",
                "New camera path",
                true,
                "Begins an empty path",
                Command::NEW_PATH,
            ),
            (
                "Open…",
                "Open a camera path",
                true,
                "A JSON file, as `render --path` reads it",
                Command::OPEN_PATH,
            ),
            (
                "Save",
                "Save the camera path",
                has_path,
                "To its file; the first time asks for one",
                Command::SAVE_PATH,
            ),
            (
                "Save as…",
                "Save the camera path as",
                has_path,
                "To another file",
                Command::SAVE_PATH_AS,
            ),
            (
                "Export…",
                "Export the camera path",
                has_path,
                "Writes a video of the path",
                Command::EXPORT_PATH,
            ),
        ] {
            let button = ui.add_enabled(is_offered, Button::new(text));
            let button = button.on_hover_text(tooltip);
            let button = button.on_disabled_hover_text("No keyframes yet");
            named(&button, name);
            if button.clicked() {
                asked = Some(command);
            }
        }
    });
    asked
}
