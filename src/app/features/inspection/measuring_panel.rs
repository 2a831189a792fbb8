//! Measurement panel: the kind of measurement, and the list of those made.

use super::measuring::{Measurement, value_text};
use super::{Inspection, Tool};
use crate::app::widgets::tool_window::tool_window;
use crate::cloud::LengthUnit;
use crate::scene::MeasurementKind;
use egui::{Align2, Button, Grid, Pos2, RichText, ScrollArea, Ui, vec2};
use glam::DVec3;

/// The window while the tool is chosen, at `corner`. Heights are along `up`, lengths in `unit`.
pub(in crate::app) fn measuring_ui(
    ui: &mut Ui,
    inspection: &mut Inspection,
    up: DVec3,
    unit: Option<LengthUnit>,
    corner: Pos2,
) {
    if inspection.tool != Tool::Measure {
        return;
    }
    let mut open = true;
    tool_window(ui.ctx(), "measuring", "Measuring")
        .open(&mut open)
        .resizable(false)
        .pivot(Align2::LEFT_BOTTOM)
        .default_pos(corner + vec2(12.0, -12.0))
        .show(ui, |ui| {
            kinds(ui, inspection);
            if !inspection.measurements.is_empty() {
                list(ui, &mut inspection.measurements, up, unit);
            }
        });
    if !open {
        inspection.toggle(Tool::Measure);
    }
}

fn kinds(ui: &mut Ui, inspection: &mut Inspection) {
    ui.horizontal(|ui| {
        for (kind, name, tooltip) in MeasurementKind::ALL {
            let button = Button::selectable(inspection.kind == kind, name);
            if ui.add(button).on_hover_text(tooltip).clicked() {
                inspection.measure(kind);
            }
        }
    });
    let begun = inspection.begun.len();
    let count = inspection.kind.point_count();
    ui.weak(format!("Click on point {} of {count}. Esc ends.", begun + 1));
}

fn list(ui: &mut Ui, measurements: &mut Vec<Measurement>, up: DVec3, unit: Option<LengthUnit>) {
    let mut deleted = None;
    let height = 0.4 * ui.ctx().content_rect().height();
    ScrollArea::vertical().max_height(height).show(ui, |ui| {
        Grid::new("measurements").num_columns(3).striped(true).show(ui, |ui| {
            for (index, measurement) in measurements.iter().enumerate() {
                let value = value_text(measurement.kind, measurement.value(up), unit);
                ui.label(measurement.kind.name());
                ui.label(RichText::new(value).monospace()).on_hover_text(
                    "Lengths in the units of the file, angles in degrees; points are followed through frames with \
                        the same number of points",
                );
                let delete = ui
                    .add(Button::new("Delete").small())
                    .on_hover_text("Delete this measurement");
                delete.widget_info(|| {
                    let name = format!("Delete measurement {}", index + 1);
                    egui::WidgetInfo::labeled(egui::Role::Button, true, name)
                });
                if delete.clicked() {
                    deleted = Some(index);
                }
                ui.end_row();
            }
        });
    });
    ui.horizontal(|ui| {
        let copy = ui.button("Copy as text");
        let tooltip = "Every measurement as a line: its value and its points, with all digits";
        if copy.on_hover_text(tooltip).clicked() {
            let lines = measurements.iter().map(|measurement| measurement.line(up) + "\n");
            ui.copy_text(lines.collect());
        }
        let clear = ui.button("Delete all");
        if clear.on_hover_text("Delete every measurement").clicked() {
            measurements.clear();
        }
    });
    if let Some(index) = deleted.filter(|&index| index < measurements.len()) {
        measurements.remove(index);
    }
}
