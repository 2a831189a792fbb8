//! Panel of the temporal comparison with other frames: the settings, and the numbers of the change with its legend.

use super::{ChangeMap, OnionSkin, Temporal};
use crate::analysis::ColorMap;
use crate::app::widgets::frames::{frames_drag, frames_slider};
use crate::app::widgets::numbers::significant;
use crate::app::widgets::ramp::paint_ramp;
use crate::app::widgets::rows::{row, rows};
use crate::app::widgets::tool_window::tool_window;
use crate::measure::Change;
use crate::sequence::PreparedFrame;
use egui::{Align2, Checkbox, DragValue, Grid, Pos2, RichText, Sense, Slider, Ui, vec2};
use std::fmt::Write as _;
use std::sync::Arc;

/// Range of the offset of the other frame, frames.
const STEPS: std::ops::RangeInclusive<i64> = -1000..=1000;

/// The rows of the settings.
pub(in crate::app) fn poses_ui(ui: &mut Ui, temporal: &mut Temporal) {
    let OnionSkin {
        is_on,
        before,
        after,
        step,
        strength,
    } = &mut temporal.onion;
    rows(ui, "time", |ui| {
        row(
            ui,
            "Change map",
            "Colours each point by its distance to the nearest point of another frame, and shows the numbers. Without \
             light the colours are those of the legend",
            Checkbox::new(&mut temporal.change.is_on, "Shown"),
        );
        row(
            ui,
            "Onion skin",
            "Ghosts of the neighbouring frames in memory: some of their points, earlier ones warm, later ones cool",
            Checkbox::new(is_on, "Shown"),
        );
        if !*is_on {
            return;
        }
        let poses = 0..=OnionSkin::MAX_GHOSTS;
        row(
            ui,
            "Frames before",
            "Number of earlier frames that are shown",
            Slider::new(before, poses.clone()),
        );
        row(
            ui,
            "Frames after",
            "Number of later frames that are shown",
            Slider::new(after, poses),
        );
        row(
            ui,
            "Frame step",
            "Frames from one ghost to the next",
            frames_slider(Slider::new(step, 1..=50).logarithmic(true)),
        );
        let percent = |share: f64, _: std::ops::RangeInclusive<usize>| format!("{:.0} %", share * 100.0);
        row(
            ui,
            "Ghost strength",
            "Percentage of the points of the nearest ghosts; it falls off to the farthest",
            Slider::new(strength, 0.05..=1.0).custom_formatter(percent),
        );
    });
}

/// The window while changes are shown, at `corner`: of the `shown` frame of a sequence with this many frames, in the
/// colours of `colors`.
pub(in crate::app) fn change_ui(
    ui: &mut Ui,
    temporal: &mut Temporal,
    shown: Option<(&Arc<PreparedFrame>, usize)>,
    colors: ColorMap,
    corner: Pos2,
) {
    if !temporal.change.is_on {
        return;
    }
    let mut open = true;
    tool_window(ui.ctx(), "change", "Change")
        .open(&mut open)
        .resizable(false)
        .pivot(Align2::RIGHT_TOP)
        .default_pos(corner + vec2(-12.0, 12.0))
        .show(ui, |ui| match shown {
            Some((pose, frame_count)) => content(ui, temporal, pose, frame_count, colors),
            None => _ = ui.weak("Nothing is shown yet"),
        });
    temporal.change.is_on &= open;
}

fn content(ui: &mut Ui, temporal: &mut Temporal, pose: &Arc<PreparedFrame>, frame_count: usize, colors: ColorMap) {
    let mut map = temporal.change;
    let measured = temporal.measured(pose);
    let range = measured.map_or(0.0, |(_, range)| range);
    rows(ui, "change", |ui| choices(ui, &mut map, range));
    match (temporal.other_frame(pose.index, frame_count), measured) {
        (None, _) => {
            ui.weak("The sequence has no such frame");
        }
        (Some(_), None) => {
            ui.weak(temporal.problem().unwrap_or("Being measured…"));
        }
        (Some(other), Some((change, range))) => {
            legend(ui, range, colors);
            numbers(ui, change, [pose.index, other], map.threshold);
        }
    }
    temporal.change = map;
}

fn choices(ui: &mut Ui, map: &mut ChangeMap, range: f64) {
    row(
        ui,
        "Compared with",
        "Offset of the other frame; negative for earlier ones",
        frames_drag(DragValue::new(&mut map.step).range(STEPS).speed(0.1)),
    );
    let mut is_automatic = map.range.is_none();
    row(
        ui,
        "Range",
        "Distance of the last colour: the 99th percentile, or a fixed one to compare frames with",
        Checkbox::new(&mut is_automatic, "Automatic"),
    );
    if is_automatic {
        map.range = None;
    } else {
        let speed = (range / 100.0).max(f64::from(f32::MIN_POSITIVE));
        let fixed = map.range.get_or_insert(range);
        row(
            ui,
            "Largest",
            "The distance in the last colour, scene units",
            DragValue::new(fixed).range(0.0..=f64::MAX).speed(speed).max_decimals(6),
        );
    }
    let speed = (range / 100.0).max(f64::from(f32::MIN_POSITIVE));
    row(
        ui,
        "Threshold",
        "Points that are farther away than this are counted, scene units",
        DragValue::new(&mut map.threshold)
            .range(0.0..=f64::MAX)
            .speed(speed)
            .max_decimals(6),
    );
}

/// The colours of `map` from 0 to `range`, scene units.
fn legend(ui: &mut Ui, range: f64, map: ColorMap) {
    let size = vec2(ui.available_width().max(220.0), 12.0);
    let (bar, response) = ui.allocate_exact_size(size, Sense::hover());
    response.on_hover_text("Distances to the nearest point of the other frame, scene units");
    paint_ramp(ui.painter(), bar, map, false);
    ui.horizontal(|ui| {
        ui.monospace("0");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.monospace(format!("≥ {}", rounded(range)));
        });
    });
}

fn numbers(ui: &mut Ui, change: &Change, [from, to]: [usize; 2], threshold: f64) {
    let rows = [
        (
            "Mean",
            change.mean,
            "The mean distance to the nearest point of the other frame, scene units",
        ),
        (
            "95 %",
            f64::from(change.quantile(0.95)),
            "The distance that 95 % of the points do not exceed, scene units",
        ),
        (
            "Maximum",
            f64::from(change.largest()),
            "The largest distance (one-sided Hausdorff distance), scene units",
        ),
    ];
    let share = change.share_above(threshold);
    Grid::new("change numbers").num_columns(2).striped(true).show(ui, |ui| {
        ui.label("Frames");
        ui.label(RichText::new(format!("{} → {}", from + 1, to + 1)).monospace());
        ui.end_row();
        for (name, value, tooltip) in rows {
            ui.label(name).on_hover_text(tooltip);
            ui.label(RichText::new(rounded(value)).monospace())
                .on_hover_text(tooltip);
            ui.end_row();
        }
        let tooltip = "Percentage of the points beyond the threshold";
        ui.label("Above threshold").on_hover_text(tooltip);
        ui.label(RichText::new(format!("{:.2} %", 100.0 * share)).monospace())
            .on_hover_text(tooltip);
        ui.end_row();
    });
    let copy = ui.button("Copy numbers");
    let tooltip = "All numbers with all digits, one per line";
    if copy.on_hover_text(tooltip).clicked() {
        let mut text = format!("frames\t{from}\t{to}\npoints\t{}\n", change.distances.len());
        for (name, value, _) in rows {
            _ = writeln!(text, "{}\t{value}", name.to_lowercase());
        }
        _ = writeln!(text, "share above {threshold}\t{share}");
        ui.copy_text(text);
    }
}

/// Four digits are more than a change means.
fn rounded(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let step = 10f64.powf(value.abs().log10().floor() - 3.0);
    significant((value / step).round() * step)
}
