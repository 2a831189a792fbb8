//! The values of a point that was clicked on, each of which can be copied.

use super::{Anchor, Inspected, Inspection, Tool};
use crate::app::side::Side;
use crate::app::widgets::numbers::{significant, with_unit};
use crate::app::widgets::tool_window::tool_window;
use crate::cloud::LengthUnit;
use crate::composition::TrailMeasure;
use crate::messages::grouped;
use crate::scene::{Camera, Pick, PickedNormal, Projection};
use egui::{Button, Grid, Pos2, RichText, ScrollArea, Ui, vec2};
use glam::DVec3;

/// Context of a point's values, in addition to the point.
#[derive(Debug)]
pub(in crate::app) struct PointContext<'a> {
    pub(in crate::app) camera: &'a Camera,
    /// Names of both sequences, where there are two.
    pub(in crate::app) names: Option<[String; 2]>,
    /// Length and speeds of its trail, where that is shown.
    pub(in crate::app) trail: Option<TrailMeasure>,
    /// Frames of the sequence.
    pub(in crate::app) frame_count: usize,
    /// Unit of lengths, where the file states it.
    pub(in crate::app) unit: Option<LengthUnit>,
}

/// The window while the tool is chosen or a point is shown, at `corner`, with the content of another feature `below`.
pub(in crate::app) fn point_ui(
    ui: &mut Ui,
    inspection: &mut Inspection,
    context: &PointContext<'_>,
    corner: Pos2,
    below: impl FnOnce(&mut Ui, Anchor),
) {
    if inspection.tool != Tool::Point && inspection.point.is_none() {
        return;
    }
    let mut open = true;
    tool_window(ui.ctx(), "point", "Point")
        .open(&mut open)
        .resizable(false)
        .default_pos(corner + vec2(12.0, 12.0))
        .show(ui, |ui| {
            let Some(point) = &inspection.point else {
                ui.label("Click on a point. Esc ends.");
                return;
            };
            let height = 0.7 * ui.ctx().content_rect().height();
            ScrollArea::vertical()
                .max_height(height)
                .show(ui, |ui| values_ui(ui, point, context));
            below(ui, point.anchor);
        });
    if !open {
        inspection.point = None;
        if inspection.tool == Tool::Point {
            inspection.toggle(Tool::Point);
        }
    }
}

fn values_ui(ui: &mut Ui, point: &Inspected, context: &PointContext<'_>) {
    let rows = value_rows(point, context);
    Grid::new("values").num_columns(3).striped(true).show(ui, |ui| {
        for row in &rows {
            row.show(ui);
        }
    });
    if ui
        .button("Copy all")
        .on_hover_text("All values as lines of text")
        .clicked()
    {
        let lines: Vec<String> = rows.iter().map(ValueRow::line).collect();
        ui.copy_text(lines.concat());
    }
}

fn value_rows(point: &Inspected, context: &PointContext<'_>) -> Vec<ValueRow> {
    let values = &point.values;
    let mut rows = Vec::new();
    if let Some([a, b]) = &context.names {
        let name = match point.anchor.side {
            Side::A => format!("A {a}"),
            Side::B => format!("B {b}"),
        };
        rows.push(ValueRow::new(
            "Sequence",
            name,
            "Which of the two sequences the point is of",
        ));
    }
    rows.extend([
        ValueRow {
            shown: format!("{} of {}", grouped(values.frame + 1), grouped(context.frame_count)),
            ..ValueRow::new("Frame", (values.frame + 1).to_string(), "The frame, counted from 1")
        },
        ValueRow {
            shown: grouped(u64::from(values.index_in_file)),
            ..ValueRow::new(
                "Index",
                values.index_in_file.to_string(),
                "Which point of the file it is, counted from 0",
            )
        },
    ]);
    rows.extend(place_rows(values));
    rows.extend(color_rows(values));
    rows.extend(values.normal.map(normal_row));
    for (name, value) in &values.scalars {
        rows.push(ValueRow {
            shown: significant(*value),
            ..ValueRow::new(name, value.to_string(), "A scalar field of the file")
        });
    }
    if context.camera.projection == Projection::Perspective {
        let distance = context.camera.eye_in_world().distance(values.position);
        rows.push(ValueRow {
            shown: with_unit(distance, context.unit),
            ..ValueRow::new(
                "Distance to camera",
                distance.to_string(),
                "Distance from the eye of the camera, scene units",
            )
        });
    }
    let trail = context.trail.iter();
    rows.extend(trail.flat_map(|measure| trail_rows(measure, context.unit)));
    rows
}

fn place_rows(values: &Pick) -> Vec<ValueRow> {
    let DVec3 { x, y, z } = values.position;
    let tooltip = format!(
        "Coordinate of the file, scene units; at most {:.1e} off, as frames hold f32 from the sequence's origin",
        values.precision
    );
    // Enough decimals to distinguish neighbours in the frame.
    let decimals = (-values.precision.max(f64::MIN_POSITIVE).log10())
        .ceil()
        .clamp(0.0, 12.0);
    let row = |(name, value): (&str, f64)| ValueRow {
        shown: format!("{value:.0$}", decimals as usize),
        ..ValueRow::new(name, value.to_string(), &tooltip)
    };
    [("x", x), ("y", y), ("z", z)].map(row).into()
}

fn color_rows(values: &Pick) -> Vec<ValueRow> {
    let mut rows = Vec::new();
    if let Some(color) = values.color {
        let text = color.map(|part| part.to_string()).join(" ");
        rows.push(ValueRow::new(
            "Colour",
            text,
            "Red, green, blue and alpha of the file, 0 to 255",
        ));
    }
    let drawn = values.drawn_color.map(|part| part.to_string()).join(" ");
    rows.push(ValueRow::new(
        "Drawn as",
        drawn,
        "Red, green and blue without lighting, 0 to 255",
    ));
    rows
}

fn normal_row(normal: PickedNormal) -> ValueRow {
    let (normal, tooltip) = match normal {
        PickedNormal::File(normal) => (normal, "Unit normal of the file"),
        PickedNormal::Estimated(normal) => (normal, "Unit normal, estimated from neighbours"),
    };
    let parts = normal.to_array();
    ValueRow {
        shown: parts.map(|part| format!("{part:.4}")).join(" "),
        ..ValueRow::new("Normal", parts.map(|part| part.to_string()).join(" "), tooltip)
    }
}

/// Returns the rows of the distance and speed of the point, where its trail is shown.
fn trail_rows(measure: &TrailMeasure, unit: Option<LengthUnit>) -> Vec<ValueRow> {
    let values = [
        (
            "Travelled",
            measure.length,
            "Length of the trail from in to out point, scene units, without its breaks",
        ),
        (
            "Mean speed",
            measure.mean_speed,
            "Mean speed along the trail, scene units per second: by timestamps, else at the frame rate of the \
                timeline",
        ),
        (
            "Largest speed",
            measure.max_speed,
            "Maximum speed from one frame to the next, scene units per second",
        ),
    ];
    let row = |(name, value, tooltip): (&str, f64, &str)| {
        // Lengths per second, except for the first.
        let pace = match (name, unit) {
            ("Travelled", _) => "",
            (_, Some(_)) => "/s",
            (_, None) => " /s",
        };
        ValueRow {
            shown: with_unit(value, unit) + pace,
            ..ValueRow::new(name, value.to_string(), tooltip)
        }
    };
    values.into_iter().map(row).collect()
}

struct ValueRow {
    name: String,
    shown: String,
    /// With all digits.
    copied: String,
    tooltip: String,
}

impl ValueRow {
    fn new(name: &str, value: String, tooltip: &str) -> Self {
        Self {
            name: name.to_owned(),
            shown: value.clone(),
            copied: value,
            tooltip: tooltip.to_owned(),
        }
    }

    fn line(&self) -> String {
        format!("{}\t{}\n", self.name, self.copied)
    }

    fn show(&self, ui: &mut Ui) {
        ui.label(&self.name).on_hover_text(&self.tooltip);
        ui.label(RichText::new(&self.shown).monospace())
            .on_hover_text(&self.tooltip);
        let copy = ui
            .add(Button::new("Copy").small())
            .on_hover_text("Copy this value with all its digits");
        copy.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Copy {}", self.name)));
        if copy.clicked() {
            ui.copy_text(self.copied.clone());
        }
        ui.end_row();
    }
}
