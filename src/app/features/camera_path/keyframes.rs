//! The list of keyframes: the time of each, its frame, and the playback until the next one.

use super::request::PathRequest;
use super::{Draft, PathEditor};
use crate::app::widgets::names::named;
use egui::{Button, ComboBox, DragValue, Label, RichText, ScrollArea, Ui, vec2};
use std::sync::Arc;

/// Widths of the columns before the buttons, points.
const COLUMNS: [(&str, f32); 4] = [("Go to", 46.0), ("Time", 78.0), ("Frame", 62.0), ("Then", 112.0)];

/// Keyframes that are shown at once; others are scrolled to.
const ROWS: f32 = 9.0;

/// Playback rates of the sequence after a keyframe, relative to its default.
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
    ("Backward, × 0.5", -0.5, "It plays backward at half of its frame rate"),
];

/// Action requested on one keyframe.
#[derive(Clone, Copy)]
enum Asked {
    Go,
    Time(f64),
    Frame(f64),
    Rate(f64),
    Replace,
    Delete,
}

/// A time in the video that can be dragged.
pub(super) fn seconds(value: &mut f64) -> DragValue<'_> {
    DragValue::new(value).speed(0.02).fixed_decimals(3).suffix(" s")
}

pub(in crate::app) fn keyframes_ui(ui: &mut Ui, path: &mut PathEditor, fps: f64) -> Option<PathRequest> {
    let draft = Arc::clone(&path.draft);
    let count = draft.keyframes().len();
    if count == 0 {
        ui.weak("Move the camera, then add a keyframe; repeat.");
        return None;
    }
    ui.horizontal(|ui| {
        for (text, width) in COLUMNS {
            let size = [width, ui.spacing().interact_size.y];
            ui.add_sized(size, Label::new(RichText::new(text).weak()));
        }
    });
    let present = draft.key_at(path.time_s);
    let mut asked = None;
    let row_height = ui.spacing().interact_size.y;
    ScrollArea::vertical()
        .max_height(ROWS * (row_height + ui.spacing().item_spacing.y))
        .show_rows(ui, row_height, count, |ui, rows| {
            for index in rows {
                let is_present = present == Some(index);
                if let Some(what) = row(ui, &draft, index, is_present, fps) {
                    asked = Some((index, what));
                }
            }
        });
    let (index, what) = asked?;
    change(path, index, what)
}

fn row(ui: &mut Ui, draft: &Draft, index: usize, is_present: bool, fps: f64) -> Option<Asked> {
    let key = &draft.keyframes()[index];
    let number = index + 1;
    let mut asked = None;
    let [go, time, frame, then] = COLUMNS.map(|(_, width)| vec2(width, ui.spacing().interact_size.y));
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
            .range(1.0..=1e9 + 1.0)
            .max_decimals(2);
        let response = ui.add_sized(frame, drag);
        named(&response, format!("Frame of keyframe {number}"));
        response.on_hover_text("The frame at this time; past the last one the sequence starts over");
        if shown != key.frame + 1.0 {
            asked = Some(Asked::Frame(shown - 1.0));
        }

        match draft.rate_after(index) {
            Some(rate) => {
                let chosen = pace_choice(ui, number, then.x, rate / fps);
                asked = chosen.map(|pace| Asked::Rate(pace * fps)).or(asked.take());
            }
            None => {
                ui.add_sized(then, Label::new(RichText::new("End").weak()));
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

/// Playback rate of the sequence after a keyframe, as a fraction of its frame rate.
fn pace_choice(ui: &mut Ui, number: usize, width: f32, pace: f64) -> Option<f64> {
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
    response.on_hover_text("Playback of the sequence until the next keyframe");
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

/// Changes the path itself; its display is changed by the window.
fn change(path: &mut PathEditor, index: usize, what: Asked) -> Option<PathRequest> {
    match what {
        Asked::Go => return Some(PathRequest::GoTo(path.draft.keyframes()[index].time_s)),
        Asked::Replace => return Some(PathRequest::Replace(index)),
        Asked::Time(time_s) => {
            // If the path is at this keyframe, its current time moves with the keyframe.
            let is_present = path.draft.key_at(path.time_s) == Some(index);
            path.edit(|draft| draft.set_time(index, time_s));
            if is_present {
                path.time_s = path.draft.keyframes()[index].time_s;
            }
        }
        Asked::Frame(frame) => path.edit(|draft| draft.set_frame(index, frame)),
        Asked::Rate(rate) => path.edit(|draft| draft.set_rate_after(index, rate)),
        Asked::Delete => path.edit(|draft| draft.remove(index)),
    }
    None
}
