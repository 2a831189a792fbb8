//! The values of a point that was clicked on, each of which can be copied.

use crate::app::features::trails::panel::trail_ui;
use crate::app::widgets::numbers::{grouped, significant};
use crate::app::{Inspected, Side, State, Tool};
use crate::scene::{PickedNormal, Projection};
use egui::{Button, Grid, RichText, ScrollArea, Ui, Window, vec2};
use glam::DVec3;

/// The window while the tool is chosen or a point is shown.
pub(in crate::app) fn point_ui(ui: &mut Ui, state: &mut State) {
    if state.inspection.tool != Tool::Point && state.inspection.point.is_none() {
        return;
    }
    let mut open = true;
    let corner = state.viewport.rect.left_top() + vec2(12.0, 12.0);
    Window::new("Point")
        .open(&mut open)
        .resizable(false)
        .default_pos(corner)
        .show(ui, |ui| {
            let Some(point) = &state.inspection.point else {
                ui.label("Click on a point. Esc ends.");
                return;
            };
            let height = 0.7 * ui.ctx().content_rect().height();
            ScrollArea::vertical()
                .max_height(height)
                .show(ui, |ui| values(ui, state, point));
            trail_ui(ui, state);
        });
    if !open {
        state.inspection.point = None;
        if state.inspection.tool == Tool::Point {
            state.inspection.toggle(Tool::Point);
        }
    }
}

fn values(ui: &mut Ui, state: &State, point: &Inspected) {
    let values = &point.values;
    let mut rows = Vec::new();
    if let Some(beside) = &state.beside {
        let name = match point.anchor.side {
            Side::A => format!("A {}", state.sequence_name().unwrap_or_default()),
            Side::B => format!("B {}", beside.name),
        };
        rows.push(Row::new(
            "Sequence",
            name,
            "Which of the two sequences the point is of",
        ));
    }
    rows.extend([
        Row::new(
            "Frame",
            (values.frame + 1).to_string(),
            "The frame, counted from 1",
        ),
        Row {
            shown: grouped(u64::from(values.index_in_file)),
            ..Row::new(
                "Index",
                values.index_in_file.to_string(),
                "Which point of the file it is, counted from 0",
            )
        },
    ]);
    let DVec3 { x, y, z } = values.position;
    let tooltip = format!(
        "Coordinate of the file, scene units; at most {:.1e} off, as frames hold f32 from the sequence's origin",
        values.precision
    );
    // As many decimals as tell neighbours in the frame apart.
    let decimals = (-values.precision.max(f64::MIN_POSITIVE).log10())
        .ceil()
        .clamp(0.0, 12.0);
    for (name, value) in [("x", x), ("y", y), ("z", z)] {
        rows.push(Row {
            shown: format!("{value:.0$}", decimals as usize),
            ..Row::new(name, value.to_string(), &tooltip)
        });
    }
    if let Some(color) = values.color {
        let text = color.map(|part| part.to_string()).join(" ");
        rows.push(Row::new(
            "Colour",
            text,
            "Red, green, blue and alpha of the file, 0 to 255",
        ));
    }
    let drawn = values.drawn_color.map(|part| part.to_string()).join(" ");
    rows.push(Row::new(
        "Drawn as",
        drawn,
        "Red, green and blue of the picture without light, 0 to 255",
    ));
    if let Some(normal) = values.normal {
        let (normal, tooltip) = match normal {
            PickedNormal::File(normal) => (normal, "Unit normal of the file"),
            PickedNormal::Estimated(normal) => (normal, "Unit normal, estimated from neighbours"),
        };
        let parts = normal.to_array();
        rows.push(Row {
            shown: parts.map(|part| format!("{part:.4}")).join(" "),
            ..Row::new(
                "Normal",
                parts.map(|part| part.to_string()).join(" "),
                tooltip,
            )
        });
    }
    for (name, value) in &values.scalars {
        rows.push(Row::new(
            name,
            value.to_string(),
            "A scalar field of the file",
        ));
    }
    if state.camera.projection == Projection::Perspective {
        let distance = state.camera.eye_in_world().distance(values.position);
        rows.push(Row {
            shown: format!("{distance:.6}"),
            ..Row::new(
                "From the eye",
                distance.to_string(),
                "Distance from the eye, scene units",
            )
        });
    }
    rows.extend(trail_rows(state, values.index_in_file));
    Grid::new("values")
        .num_columns(3)
        .striped(true)
        .show(ui, |ui| {
            for row in &rows {
                row.show(ui);
            }
        });
    if ui
        .button("Copy all")
        .on_hover_text("All values as lines of text")
        .clicked()
    {
        let lines: Vec<String> = rows.iter().map(Row::line).collect();
        ui.copy_text(lines.concat());
    }
}

/// How far and how fast the point goes, where its trail is shown.
fn trail_rows(state: &State, index_in_file: u32) -> Vec<Row> {
    let measure = state.player.as_ref().and_then(|player| {
        let time_s = |frame| player.time_s(frame);
        state.trails.measure(index_in_file, time_s)
    });
    let Some(measure) = measure else {
        return Vec::new();
    };
    let values = [
        (
            "Travelled",
            measure.length,
            "The length of the trail from in to out point, scene units; what lies across breaks is left out",
        ),
        (
            "Mean speed",
            measure.mean_speed,
            "The length of the trail by its time, scene units a second: by time stamps, else at the frame rate of the \
             timeline",
        ),
        (
            "Largest speed",
            measure.max_speed,
            "The largest speed from one frame to the next, scene units a second",
        ),
    ];
    let row = |(name, value, tooltip): (&str, f64, &str)| Row {
        shown: significant(value),
        ..Row::new(name, value.to_string(), tooltip)
    };
    values.into_iter().map(row).collect()
}

struct Row {
    name: String,
    shown: String,
    /// With all digits.
    copied: String,
    tooltip: String,
}

impl Row {
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
        copy.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Copy {}", self.name))
        });
        if copy.clicked() {
            ui.copy_text(self.copied.clone());
        }
        ui.end_row();
    }
}
