//! The camera path: its keyframes, what happens between them, its file.

use crate::app::State;
use crate::app::camera_path::{Draft, Question};
use crate::app::command::{Command, keys_of};
use crate::app::theme::ODD;
use egui::{
    Align2, Button, Checkbox, ComboBox, DragValue, Response, RichText, ScrollArea, Slider, Ui,
    Window, vec2,
};

/// Times that are offered, seconds.
const TIMES_S: std::ops::RangeInclusive<f64> = 0.0..=1e6;

/// Widths of the columns before the buttons, points.
const COLUMNS: [(&str, f32); 4] = [
    ("Go to", 46.0),
    ("Time", 78.0),
    ("Frame", 62.0),
    ("Then", 112.0),
];

/// Keyframes that are shown at once; others are scrolled to.
const ROWS: f32 = 9.0;

/// How the sequence can go on after a keyframe, in what it usually plays.
const PACES: [(&str, f64, &str); 6] = [
    (
        "Plays",
        1.0,
        "The sequence plays to the next keyframe at its frame rate",
    ),
    ("Slow, × 0.5", 0.5, "Slow motion: half of its frame rate"),
    ("Slow, × 0.1", 0.1, "Slow motion: a tenth of its frame rate"),
    (
        "Holds",
        0.0,
        "The next keyframe has the same frame: only the camera moves",
    ),
    ("Backward", -1.0, "The sequence plays backward"),
    (
        "Backward, × 0.5",
        -0.5,
        "It plays backward at half of its frame rate",
    ),
];

/// What is asked of one keyframe.
#[derive(Clone, Copy)]
enum Asked {
    Go,
    Time(f64),
    Frame(f64),
    Rate(f64),
    Replace,
    Delete,
}

/// The window while it is open.
pub fn camera_path_ui(ui: &mut Ui, state: &mut State) {
    question_ui(ui, state);
    let mut open = state.panels.path;
    let corner = state.viewport.rect.left_top() + vec2(12.0, 12.0);
    Window::new("Camera path")
        .open(&mut open)
        .resizable(false)
        .pivot(Align2::LEFT_TOP)
        .default_pos(corner)
        .show(ui, |ui| {
            time_ui(ui, state);
            ui.separator();
            keyframes_ui(ui, state);
            ui.separator();
            file_ui(ui, state);
        });
    state.panels.path = open;
}

/// Gives a control a name of its own for screen readers.
fn named(response: &Response, name: impl Into<String>) {
    let name = name.into();
    response
        .ctx
        .accesskit_node_builder(response.id, |node| node.set_label(name));
}

fn time_ui(ui: &mut Ui, state: &mut State) {
    let mut time_s = state.path.time_s;
    ui.horizontal(|ui| {
        let label = ui.label("Time");
        let tooltip =
            "Where in the video the next keyframe is set; within the path its view is shown";
        ui.add(seconds(&mut time_s).range(TIMES_S))
            .labelled_by(label.id)
            .on_hover_text(tooltip);
        let label = ui.label("Step");
        let tooltip = "How far the time moves on after a keyframe at the end";
        ui.add(seconds(&mut state.path.step_s).range(0.001..=1e5))
            .labelled_by(label.id)
            .on_hover_text(tooltip);
    });
    if let Some(times_s) = state.path.draft.times_s()
        && times_s.start() < times_s.end()
    {
        ui.spacing_mut().slider_width = ui.available_width();
        // The time may be after the path, where the next keyframe comes.
        let mut along_s = time_s.clamp(*times_s.start(), *times_s.end());
        let slider = Slider::new(&mut along_s, times_s).show_value(false);
        let slider = ui.add(slider).on_hover_text("Shows the path at any time");
        named(&slider, "Along the path");
        if slider.changed() {
            time_s = along_s;
        }
    }
    if time_s != state.path.time_s {
        state.set_path_time(time_s);
    }
    ui.horizontal(|ui| {
        for (text, tooltip, command) in [
            (
                "Add keyframe",
                "What is shown becomes the view of the path at this time",
                Command::AddKeyframe,
            ),
            if state.path.is_playing() {
                ("Stop", "Stops where it is (Esc)", Command::TogglePreview)
            } else {
                (
                    "Preview",
                    "Plays the path in the window at its speed; Esc stops it",
                    Command::TogglePreview,
                )
            },
        ] {
            let button = Button::new(text).shortcut_text(keys_of(command));
            let response = ui.add(button).on_hover_text(tooltip);
            named(&response, text);
            if response.clicked() {
                state.run(command);
            }
        }
    });
}

fn seconds(value: &mut f64) -> DragValue<'_> {
    DragValue::new(value)
        .speed(0.02)
        .fixed_decimals(3)
        .suffix(" s")
}

fn keyframes_ui(ui: &mut Ui, state: &mut State) {
    let draft = std::sync::Arc::clone(&state.path.draft);
    let count = draft.keyframes().len();
    if count == 0 {
        ui.weak("Move the camera, then add a keyframe; repeat.");
        return;
    }
    ui.horizontal(|ui| {
        for (text, width) in COLUMNS {
            let size = [width, ui.spacing().interact_size.y];
            ui.add_sized(size, egui::Label::new(RichText::new(text).weak()));
        }
    });
    let fps = state
        .player
        .as_ref()
        .map_or(crate::sequence::DEFAULT_FPS, |player| player.clock().fps());
    let present = draft.key_at(state.path.time_s);
    let mut asked = None;
    let row_height = ui.spacing().interact_size.y;
    ScrollArea::vertical()
        .max_height(ROWS * (row_height + ui.spacing().item_spacing.y))
        .show_rows(ui, row_height, count, |ui, rows| {
            for index in rows {
                let is_present = present == Some(index);
                if let Some(what) = row(ui, &draft, (index, is_present), fps) {
                    asked = Some((index, what));
                }
            }
        });
    if let Some((index, what)) = asked {
        change(state, index, what);
    }
}

fn row(ui: &mut Ui, draft: &Draft, (index, is_present): (usize, bool), fps: f64) -> Option<Asked> {
    let key = &draft.keyframes()[index];
    let number = index + 1;
    let mut asked = None;
    let [go, time, frame, then] =
        COLUMNS.map(|(_, width)| vec2(width, ui.spacing().interact_size.y));
    ui.horizontal(|ui| {
        let button = Button::selectable(is_present, number.to_string()).min_size(go);
        let response = ui.add(button).on_hover_text("Shows this keyframe");
        named(&response, format!("Go to keyframe {number}"));
        if response.clicked() {
            asked = Some(Asked::Go);
        }

        let mut time_s = key.time_s;
        let range = draft.time_range_s(index);
        let response = ui.add_sized(time, seconds(&mut time_s).range(range));
        named(&response, format!("Time of keyframe {number}"));
        response.on_hover_text("When it is reached, between its neighbours");
        if time_s != key.time_s {
            asked = Some(Asked::Time(time_s));
        }

        // Counted from 1, as on the timeline.
        let mut shown = key.frame + 1.0;
        let drag = DragValue::new(&mut shown)
            .speed(0.1)
            .range(1.0..=1e9)
            .max_decimals(2);
        let response = ui.add_sized(frame, drag);
        named(&response, format!("Frame of keyframe {number}"));
        response.on_hover_text(
            "The frame that is shown then; beyond the last one the sequence begins anew",
        );
        if shown != key.frame + 1.0 {
            asked = Some(Asked::Frame(shown - 1.0));
        }

        match draft.rate_after(index) {
            Some(rate) => {
                let chosen = pace_choice(ui, (number, then.x), rate / fps);
                asked = chosen.map(|pace| Asked::Rate(pace * fps)).or(asked.take());
            }
            None => {
                ui.add_sized(then, egui::Label::new(RichText::new("End").weak()));
            }
        }
        for (text, tooltip, what) in [
            (
                "Replace",
                "Gives it the view and the frame that are shown now",
                Asked::Replace,
            ),
            ("Delete", "Takes it out of the path", Asked::Delete),
        ] {
            let response = ui.small_button(text).on_hover_text(tooltip);
            named(&response, format!("{text} keyframe {number}"));
            if response.clicked() {
                asked = Some(what);
            }
        }
    });
    asked
}

/// What the sequence does after a keyframe, as a share of its frame rate.
fn pace_choice(ui: &mut Ui, (number, width): (usize, f32), pace: f64) -> Option<f64> {
    let is_pace = |other: f64| (pace - other).abs() < 5e-4;
    let known = PACES.iter().find(|(_, other, _)| is_pace(*other));
    let text = known.map_or_else(|| pace_text(pace), |(text, _, _)| (*text).to_owned());
    let mut chosen = None;
    let response = ComboBox::from_id_salt(("pace", number))
        .width(width)
        .selected_text(text)
        .show_ui(ui, |ui| {
            for (text, other, tooltip) in PACES {
                let button = ui.selectable_label(is_pace(other), text);
                if button.on_hover_text(tooltip).clicked() {
                    chosen = Some(other);
                }
            }
        })
        .response;
    named(&response, format!("After keyframe {number}"));
    response.on_hover_text("What the sequence does until the next keyframe");
    chosen
}

fn pace_text(pace: f64) -> String {
    let size = (pace.abs() * 1000.0).round() / 1000.0;
    match pace {
        pace if pace < 0.0 => format!("Backward, × {size}"),
        pace if pace < 1.0 => format!("Slow, × {size}"),
        _ => format!("Fast, × {size}"),
    }
}

fn change(state: &mut State, index: usize, what: Asked) {
    match what {
        Asked::Go => state.set_path_time(state.path.draft.keyframes()[index].time_s),
        Asked::Time(time_s) => {
            // The time of the path stays with the keyframe that it is at.
            let is_present = state.path.draft.key_at(state.path.time_s) == Some(index);
            state.path.edit(|draft| draft.set_time(index, time_s));
            if is_present {
                state.path.time_s = state.path.draft.keyframes()[index].time_s;
            }
        }
        Asked::Frame(frame) => state.path.edit(|draft| draft.set_frame(index, frame)),
        Asked::Rate(rate) => state.path.edit(|draft| draft.set_rate_after(index, rate)),
        Asked::Replace => state.replace_keyframe(index),
        Asked::Delete => state.path.edit(|draft| draft.remove(index)),
    }
}

fn file_ui(ui: &mut Ui, state: &mut State) {
    let draft = &state.path.draft;
    let mut eases = draft.eases();
    let ease = ui.add(Checkbox::new(&mut eases, "Ease in and out"));
    if ease
        .on_hover_text("The camera starts and ends at rest")
        .changed()
    {
        state.path.edit(|draft| draft.set_eases(eases));
    }
    let draft = &state.path.draft;
    let count = draft.keyframes().len();
    let duration_s = draft
        .times_s()
        .map_or(0.0, |times| times.end() - times.start());
    let name = state.path.file().and_then(|file| file.file_name());
    let name = name.map_or("no file yet".into(), |name| name.to_string_lossy());
    ui.horizontal(|ui| {
        ui.weak(format!("{count} keyframes, {duration_s:.2} s, {name}"));
        if state.path.is_unsaved() {
            ui.label(RichText::new("not saved").color(ODD));
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
                Command::NewPath,
            ),
            (
                "Open…",
                "Open a camera path",
                true,
                "A JSON file, as `render --path` reads it",
                Command::OpenPath,
            ),
            (
                "Save",
                "Save the camera path",
                has_path,
                "To its file; the first time asks for one",
                Command::SavePath,
            ),
            (
                "Save as…",
                "Save the camera path as",
                has_path,
                "To another file",
                Command::SavePathAs,
            ),
            (
                "Export…",
                "Export the camera path",
                has_path,
                "Writes a video of the path",
                Command::ExportPath,
            ),
        ] {
            let button = ui.add_enabled(is_offered, Button::new(text));
            let button = button.on_hover_text(tooltip);
            let button = button.on_disabled_hover_text("There are no keyframes yet");
            named(&button, name);
            if button.clicked() {
                state.run(command);
            }
        }
    });
}

/// Asks before something is lost.
fn question_ui(ui: &mut Ui, state: &mut State) {
    let Some(question) = state.path.question else {
        return;
    };
    let (losses, go_on) = match question {
        Question::Open | Question::New => (vec!["The camera path is not saved."], "Discard it"),
        Question::Quit => (state.losses(), "Quit anyway"),
    };
    let can_save = state.path.is_unsaved() && state.path.draft.path().is_some();
    Window::new("Before this is lost")
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .show(ui, |ui| {
            for loss in losses {
                ui.label(loss);
            }
            ui.horizontal(|ui| {
                let save = ui.add_enabled(can_save, Button::new("Save it…"));
                if save
                    .on_hover_text("Saves the path; nothing else is done")
                    .clicked()
                {
                    state.path.question = None;
                    state.run(Command::SavePath);
                }
                if ui.button(go_on).on_hover_text("It is lost").clicked() {
                    state.go_on_with(question);
                }
                if ui
                    .button("Back")
                    .on_hover_text("Nothing is done (Esc)")
                    .clicked()
                {
                    state.path.question = None;
                }
            });
        });
}
