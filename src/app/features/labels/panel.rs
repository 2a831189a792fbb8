//! The list of labels: text, frames and position of each.

use super::Labels;
use crate::app::open_panels::PanelId;
use crate::app::widgets::names::named;
use crate::app::widgets::tool_window::tool_window;
use crate::scene::{Label, MAX_LABEL_CHARS};
use crate::timeline::PlayRange;
use egui::{Align2, Button, Checkbox, DragValue, Grid, Pos2, ScrollArea, TextEdit, Ui, vec2};

/// The name of the window among panels.
pub(in crate::app) const PANEL: PanelId = PanelId::new("labels");

/// Width of a text field, points.
const TEXT_WIDTH: f32 = 170.0;

/// Around the list in a window that is as wide as the program's, points.
const MARGINS: f32 = 40.0;

/// Request of the label list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum LabelsRequest {
    /// To begin or end putting labels by clicks.
    ToggleTool,
    /// To show this one.
    GoTo(usize),
}

/// Action requested on one label.
enum Asked {
    Go,
    Text(String),
    Frames(PlayRange),
    Delete,
}

/// The window while it is open, at `corner`. The sequence has `frame_count` frames; `is_placing`: clicks put labels.
pub(in crate::app) fn labels_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    labels: &mut Labels,
    frame_count: usize,
    is_placing: bool,
    corner: Pos2,
) -> Option<LabelsRequest> {
    let mut request = None;
    tool_window(ui.ctx(), PANEL.name(), "Labels")
        .open(is_open)
        .resizable(false)
        .pivot(Align2::RIGHT_TOP)
        .default_pos(corner + vec2(-12.0, 12.0))
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                let button = ui.add(Button::selectable(is_placing, "Put labels"));
                let tooltip = "A click on a point puts a label there (N)";
                if button.on_hover_text(tooltip).clicked() {
                    request = Some(LabelsRequest::ToggleTool);
                }
                let tooltip = "In the window, in exported images and in videos";
                ui.add(Checkbox::new(&mut labels.is_shown, "Show labels"))
                    .on_hover_text(tooltip);
            });
            if labels.list.is_empty() {
                ui.weak("Click on a point. Labels follow it through frames with the same number of points.");
            } else {
                request = list_ui(ui, labels, frame_count).or(request);
            }
        });
    request
}

fn list_ui(ui: &mut Ui, labels: &mut Labels, frame_count: usize) -> Option<LabelsRequest> {
    let mut asked = None;
    let written = labels.written.take();
    // As wide as the rows; in a small window it scrolls horizontally.
    let space = ui.ctx().content_rect().size();
    let area = ScrollArea::both()
        .max_width(space.x - MARGINS)
        .min_scrolled_width(space.x - MARGINS)
        .max_height(0.4 * space.y);
    area.show(ui, |ui| {
        Grid::new("labels").num_columns(5).striped(true).show(ui, |ui| {
            for text in ["", "Text", "From", "To", ""] {
                ui.weak(text);
            }
            ui.end_row();
            for (index, label) in labels.list.iter().enumerate() {
                let is_written = written == Some(index);
                if let Some(what) = row_ui(ui, index + 1, label, frame_count, is_written) {
                    asked = Some((index, what));
                }
                ui.end_row();
            }
        });
    });
    let (index, what) = asked?;
    match what {
        Asked::Go => return Some(LabelsRequest::GoTo(index)),
        Asked::Text(text) => labels.edit(|list| list[index].text = text),
        Asked::Frames(frames) => labels.edit(|list| list[index].frames = frames),
        Asked::Delete => labels.edit(|list| _ = list.remove(index)),
    }
    None
}

fn row_ui(ui: &mut Ui, number: usize, label: &Label, frame_count: usize, is_written: bool) -> Option<Asked> {
    let mut asked = None;
    let go = ui.button(number.to_string()).on_hover_text("Shows this label");
    named(&go, format!("Go to label {number}"));
    if go.clicked() {
        asked = Some(Asked::Go);
    }

    let mut text = label.text.clone();
    let field = TextEdit::singleline(&mut text)
        .char_limit(MAX_LABEL_CHARS)
        .desired_width(TEXT_WIDTH);
    // A grid cell is no wider than its previous content, which is narrower than the field needs.
    let size = vec2(TEXT_WIDTH, ui.spacing().interact_size.y);
    let field = ui.add_sized(size, field);
    named(&field, format!("Text of label {number}"));
    if is_written {
        field.request_focus();
    }
    if text != label.text {
        asked = Some(Asked::Text(text));
    }

    // Counted from 1, as on the timeline.
    let last = frame_count.max(1);
    let range = label.frames;
    let [mut from, mut to] = [
        range.first().unwrap_or(0) + 1,
        range.last().map_or(last, |frame| frame + 1),
    ];
    let drag = ui.add(DragValue::new(&mut from).range(1..=last).speed(0.1));
    named(&drag, format!("First frame of label {number}"));
    if drag.on_hover_text("The first frame that shows it").changed() {
        asked = Some(Asked::Frames(frames_of(from, to.max(from), last)));
    }
    let drag = ui.add(DragValue::new(&mut to).range(1..=last).speed(0.1));
    named(&drag, format!("Last frame of label {number}"));
    if drag.on_hover_text("The last frame that shows it").changed() {
        asked = Some(Asked::Frames(frames_of(from.min(to), to, last)));
    }

    let delete = ui.small_button("Delete").on_hover_text("Deletes this label");
    named(&delete, format!("Delete label {number}"));
    if delete.clicked() {
        asked = Some(Asked::Delete);
    }
    asked
}

/// From and to frames that are counted from 1; the ends of the sequence are open, so that it may grow.
fn frames_of(from: usize, to: usize, last: usize) -> PlayRange {
    let mut frames = PlayRange::default();
    if from > 1 {
        frames = frames.beginning_at(from - 1);
    }
    if to < last {
        frames = frames.ending_at(to - 1);
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn label_times_are_open_at_the_ends_of_the_sequence() {
        assert_eq!(frames_of(1, 24, 24), PlayRange::default());
        assert_eq!(frames_of(3, 24, 24), PlayRange::default().beginning_at(2));
        assert_eq!(frames_of(1, 5, 24), PlayRange::default().ending_at(4));
        assert_eq!(frames_of(24, 24, 24), PlayRange::default().beginning_at(23));
    }
}
