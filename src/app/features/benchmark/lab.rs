//! Render modes by time and error: a plot that grows while they are measured. A click on a point switches to its render
//! mode.

use super::hit::hit;
use super::pictures::{pictures_ui, side_by_side_or_below};
use crate::app::theme::{ACCENT, GOOD, ODD};
use crate::bench::{LabError, LabPoint};
use crate::scene::{Primitive, RendererChoice};
use egui::{Color32, ScrollArea, Ui};
use egui_plot::{Corner, GridMark, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};
use std::sync::Arc;

const PLOT_HEIGHT: f32 = 300.0;

const LIST_HEIGHT: f32 = 170.0;

/// Primitives that share a colour, and their common name.
const KINDS: [(&str, Color32, &[Primitive]); 3] = [
    (
        "Surfels",
        ACCENT,
        &[Primitive::Surfel, Primitive::Ellipse, Primitive::Sprite],
    ),
    ("Voxels, meshes", GOOD, &[Primitive::Voxel, Primitive::Mesh]),
    ("Points", ODD, &[Primitive::Point]),
];

/// Renderers and their plot markers.
const RENDERERS: [(&str, RendererChoice, MarkerShape); 2] = [
    ("CPU (round)", RendererChoice::Cpu, MarkerShape::Circle),
    ("GPU (square)", RendererChoice::Gpu, MarkerShape::Square),
];

/// The plot, the chosen mode and the Pareto-optimal modes; returns a newly chosen mode.
pub(in crate::app) fn lab_ui(ui: &mut Ui, points: &[Arc<LabPoint>]) -> Option<Arc<LabPoint>> {
    let id = ui.scope_id().with("chosen way");
    let mut chosen: Option<usize> = ui.data(|data| data.get_temp(id));
    let before = chosen;
    let error = error_choice(ui);
    if let Some(clicked) = plot(ui, points, chosen, error) {
        chosen = Some(clicked);
    }
    side_by_side_or_below(ui, |ui| {
        if let Some(point) = chosen.and_then(|index| points.get(index)) {
            let images = [&point.picture, &point.error_map];
            ui.vertical(|ui| pictures_ui(ui, &point.label, point.draw_ms.to_bits(), images));
        }
        ui.vertical(|ui| {
            ui.weak("Nothing beats these in both; a click draws as they do:");
            let mut front: Vec<usize> = (0..points.len())
                .filter(|&index| is_on_front(&points[index], points, error))
                .collect();
            front.sort_by(|&a, &b| points[a].draw_ms.total_cmp(&points[b].draw_ms));
            // Names are longer than the window is wide, and would widen it.
            ScrollArea::both()
                .id_salt("front")
                .auto_shrink([false, true])
                .max_height(LIST_HEIGHT)
                // The window scrolls as well, and would leave less space to the list.
                .min_scrolled_height(LIST_HEIGHT)
                .show(ui, |ui| {
                    for index in front {
                        if ui
                            .selectable_label(chosen == Some(index), words(&points[index], error))
                            .clicked()
                        {
                            chosen = Some(index);
                        }
                    }
                });
        });
    });
    let point = points.get(chosen.filter(|_| chosen != before)?)?;
    ui.data_mut(|data| data.insert_temp(id, chosen.unwrap_or_default()));
    Some(Arc::clone(point))
}

/// During a run, the front is not marked yet.
fn is_on_front(point: &LabPoint, points: &[Arc<LabPoint>], error: LabError) -> bool {
    !points.iter().any(|other| point.is_beaten_by(other, error))
}

/// Chooses the error that is plotted.
fn error_choice(ui: &mut Ui) -> LabError {
    let id = ui.scope_id().with("plotted error");
    let mut error: LabError = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    ui.horizontal(|ui| {
        ui.label("Error");
        for choice in LabError::ALL {
            let (name, hint, _) = texts(choice);
            ui.selectable_value(&mut error, choice, name).on_hover_text(hint);
        }
    });
    ui.data_mut(|data| data.insert_temp(id, error));
    error
}

/// Name, hint and axis title of an error.
fn texts(error: LabError) -> (&'static str, &'static str, &'static str) {
    match error {
        LabError::Image => (
            "Of an image",
            "Error of an image against the ground truth",
            "Visible error 0–1 (FLIP)",
        ),
        LabError::OverTime => (
            "Over time",
            "Error of the change from image to image while the camera turns: flicker, crawling, popping",
            "Visible error over time 0–1 (FLIP)",
        ),
    }
}

/// A mode in one line.
fn words(point: &LabPoint, error: LabError) -> String {
    format!("{:.2} ms, FLIP {:.4}: {}", point.draw_ms, error.of(point), point.label)
}

/// Plot position of a render mode: powers of ten of milliseconds, and the error.
fn place(point: &LabPoint, error: LabError) -> [f64; 2] {
    [point.draw_ms.max(1e-3).log10(), error.of(point)]
}

/// Draws all points; the one that was clicked.
fn plot(ui: &mut Ui, points: &[Arc<LabPoint>], chosen: Option<usize>, error: LabError) -> Option<usize> {
    let mut front: Vec<[f64; 2]> = points
        .iter()
        .filter(|point| is_on_front(point, points, error))
        .map(|point| place(point, error))
        .collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let plot = Plot::new("time and error")
        .height(PLOT_HEIGHT)
        .allow_scroll(false)
        .legend(Legend::default().position(Corner::RightTop))
        .include_y(0.0)
        .x_axis_label("milliseconds per frame")
        .y_axis_label(texts(error).2)
        .x_grid_spacer(|input| decades(input.bounds.0, input.bounds.1))
        .x_axis_formatter(|mark, _| milliseconds(mark.value))
        .label_formatter(|_| None);
    let response = plot.show(ui, |plot| {
        plot.line(
            Line::new("Nothing is better", PlotPoints::from(front))
                .color(Color32::GRAY)
                .style(LineStyle::dashed_dense()),
        );
        for (kind, color, primitives) in KINDS {
            for (who, renderer, shape) in RENDERERS {
                let is_of_it = |point: &&Arc<LabPoint>| {
                    let style = &point.style;
                    let is_of_kind = primitives.iter().any(|&primitive| style.primitive == primitive);
                    is_of_kind && style.drawing.renderer == renderer
                };
                let places: Vec<[f64; 2]> = points
                    .iter()
                    .filter(is_of_it)
                    .map(|point| place(point, error))
                    .collect();
                // Kinds without points are omitted from the legend.
                if !places.is_empty() {
                    let marks = Points::new(format!("{kind}, {who}"), PlotPoints::from(places));
                    plot.points(marks.shape(shape).radius(4.5).color(color));
                }
            }
        }
        if let Some(point) = chosen.and_then(|index| points.get(index)) {
            let ring = Points::new("", PlotPoints::from(vec![place(point, error)]));
            plot.points(ring.radius(8.0).filled(false).color(Color32::WHITE));
        }
    });
    let places: Vec<[f64; 2]> = points.iter().map(|point| place(point, error)).collect();
    let (hovered, clicked) = hit(&response, &places);
    if let Some(index) = hovered {
        response.response.on_hover_text_at_pointer(words(&points[index], error));
    }
    clicked
}

/// Grid lines at 1, 2 and 5 of each power of ten.
fn decades(min: f64, max: f64) -> Vec<GridMark> {
    let powers = min.floor() as i32..=max.ceil() as i32;
    let marks = powers.flat_map(|power| {
        [(1.0, 1.0), (2.0, 0.3), (5.0, 0.3)].map(|(step, step_size): (f64, f64)| GridMark {
            value: f64::from(power) + step.log10(),
            step_size,
        })
    });
    marks.collect()
}

/// A power of ten of milliseconds as people write it.
fn milliseconds(power: f64) -> String {
    let value = 10f64.powf(power);
    let decimals = (-power.floor()).clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_labelled_in_milliseconds() {
        let labels = [-2.0, -0.3, 0.0, 1.7, 3.0].map(milliseconds);
        assert_eq!(labels, ["0.01", "0.5", "1", "50", "1000"]);
        let marks: Vec<f64> = decades(0.2, 0.9)
            .into_iter()
            .map(|mark| 10f64.powf(mark.value).round())
            .collect();
        assert_eq!(marks, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    }
}
