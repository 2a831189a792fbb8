//! The bar of a second sequence: its layout, its shown frames, and its distance from the first.

use super::{FrameDistances, Layout, OneWay, SplitView};
use crate::app::features::comparison::panel::{difference_ui, error_map_ui};
use crate::app::widgets::frames::frames_drag;
use crate::app::widgets::numbers::rounded_to;
use crate::playback::{PairBy, Player};
use egui::{Button, DragValue, RichText, Ui};

/// Offsets that can be dragged to.
const MAX_OFFSET: i64 = 1_000_000;

/// Request of the bar to the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum SplitViewRequest {
    /// Measure the distances of the shown frames.
    Measure,
    /// Back to one sequence.
    Close,
}

/// The bar while two sequences are compared.
pub(in crate::app) fn split_view_ui(
    ui: &mut Ui,
    split_view: &mut SplitView,
    player: &Player,
) -> Option<SplitViewRequest> {
    let mut request = None;
    ui.horizontal_wrapped(|ui| {
        layout_ui(ui, split_view);
        ui.separator();
        pairing_ui(ui, split_view);
        ui.separator();
        let close = ui.button("Close comparison");
        if close.on_hover_text("Back to one sequence").clicked() {
            request = Some(SplitViewRequest::Close);
        }
    });
    ui.horizontal_wrapped(|ui| {
        if split_view.layout == Layout::Wipe {
            error_map_ui(ui, &mut split_view.pictures);
            if split_view.companion.shown().is_some() {
                difference_ui(ui, &split_view.pictures);
            }
            ui.separator();
        }
        let distances = split_view.distances(player);
        if split_view.is_measuring() {
            ui.weak("Measuring distances…");
        } else if distances.is_none() {
            let button = Button::new("Measure distances");
            let is_possible = split_view.whole_frames(player).is_some();
            let button = ui
                .add_enabled(is_possible, button)
                .on_hover_text("From each point to the nearest one of the other frame, in both directions")
                .on_disabled_hover_text("Both frames have to be here with all their points: pause");
            if button.clicked() {
                request = Some(SplitViewRequest::Measure);
            }
        }
        if let Some(distances) = distances {
            distances_ui(ui, distances);
        }
    });
    request
}

fn layout_ui(ui: &mut Ui, split_view: &mut SplitView) {
    let mut layout = split_view.layout;
    for (value, text, tooltip) in [
        (
            Layout::SideBySide,
            "Side by side",
            "A half each, by one camera (Shift+C)",
        ),
        (
            Layout::Wipe,
            "Line",
            "One over the other, with a line between them that can be dragged (Shift+C)",
        ),
    ] {
        ui.selectable_value(&mut layout, value, text).on_hover_text(tooltip);
    }
    if layout != split_view.layout {
        split_view.lay_out(layout);
    }
}

/// Shows the frame pairing controls.
fn pairing_ui(ui: &mut Ui, split_view: &mut SplitView) {
    let companion = &mut split_view.companion;
    ui.label("Frames by");
    let mut by = companion.paired_by();
    ui.selectable_value(&mut by, PairBy::Index, "Index")
        .on_hover_text("Frames at the same place belong together: the first with the first");
    let number = Button::selectable(by == PairBy::Number, "Number");
    let number = ui
        .add_enabled(companion.numbers().is_some(), number)
        .on_hover_text("Frames with the same number in their names belong together; where one is lost there is none")
        .on_disabled_hover_text("Not all names of both have a number, or none is the same");
    if number.clicked() {
        by = PairBy::Number;
    }
    let tooltip = match companion.times() {
        Some(times) if times.counts_from_first() => {
            "The frames taken at the same time belong together, counted from the first frame of each: their clocks \
             never meet"
        }
        _ => "The frames taken at the same time belong together",
    };
    let has_times = companion.times().is_some();
    let time = ui
        .add_enabled(has_times, Button::selectable(by == PairBy::Time, "Time"))
        .on_hover_text(tooltip)
        .on_disabled_hover_text("Not all frames of both have a time stamp");
    if time.clicked() {
        by = PairBy::Time;
    }
    if by != companion.paired_by() {
        companion.pair_by(by);
        // Other frames are shown from the next pass on.
        ui.ctx().request_repaint();
    }
    let mut offset = companion.offset_frames();
    let tooltip = "Offset of the frames of B; negative for earlier";
    let label = ui.label("Offset").on_hover_text(tooltip);
    let drag = frames_drag(DragValue::new(&mut offset).range(-MAX_OFFSET..=MAX_OFFSET).speed(0.1));
    let is_changed = ui.add(drag).labelled_by(label.id).on_hover_text(tooltip).changed();
    if is_changed {
        companion.set_offset_frames(offset);
        ui.ctx().request_repaint();
    }
}

fn distances_ui(ui: &mut Ui, distances: &FrameDistances) {
    let shown = text_of(distances, |value| rounded_to(value, 4));
    ui.label(RichText::new(shown).monospace()).on_hover_text(
        "From each point of one frame to the nearest of the other, scene units. Hausdorff: the larger of both largest",
    );
    let copy = ui.small_button("Copy numbers");
    if copy.on_hover_text("With all digits").clicked() {
        ui.copy_text(text_of(distances, |value| value.to_string()));
    }
}

/// All distances in a line.
fn text_of(distances: &FrameDistances, number: impl Fn(f64) -> String) -> String {
    let way = |way: &OneWay| {
        let [mean, rms, largest] = [way.mean, way.root_mean_squared, way.largest].map(&number);
        format!("mean {mean}  RMS {rms}  largest {largest}")
    };
    let (a, b) = (way(&distances.from_a), way(&distances.from_b));
    let hausdorff = number(distances.hausdorff());
    format!("A→B  {a}   B→A  {b}   Hausdorff {hausdorff}")
}
