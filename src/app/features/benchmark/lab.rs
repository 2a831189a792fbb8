//! Ways to draw by time and error: a plot that grows while they are measured. A click on a point draws as it does.

use crate::app::theme::{ACCENT, GOOD, ODD};
use crate::bench::LabPoint;
use crate::scene::{Primitive, RendererChoice};
use egui::{Color32, ColorImage, Pos2, RichText, ScrollArea, TextureHandle, TextureOptions, Ui};
use egui_plot::{GridMark, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, Points};
use std::sync::Arc;

/// How near to a point a click must be, points of the screen.
const REACH: f32 = 14.0;

const PLOT_HEIGHT: f32 = 300.0;

/// The plot, the chosen way and the ways that no other beats; returns a way that was chosen now.
pub(in crate::app) fn lab_ui(ui: &mut Ui, points: &[Arc<LabPoint>]) -> Option<Arc<LabPoint>> {
    let id = ui.scope_id().with("chosen way");
    let mut chosen: Option<usize> = ui.data(|data| data.get_temp(id));
    let before = chosen;
    if let Some(clicked) = plot(ui, points, chosen) {
        chosen = Some(clicked);
    }
    ui.horizontal_top(|ui| {
        if let Some(point) = chosen.and_then(|index| points.get(index)) {
            ui.vertical(|ui| pictures(ui, point));
        }
        ui.vertical(|ui| {
            ui.weak("Nothing beats these in both; a click draws as they do:");
            let mut front: Vec<usize> = (0..points.len())
                .filter(|&index| is_on_front(&points[index], points))
                .collect();
            front.sort_by(|&a, &b| points[a].draw_ms.total_cmp(&points[b].draw_ms));
            ScrollArea::vertical()
                .id_salt("front")
                .max_height(170.0)
                .show(ui, |ui| {
                    for index in front {
                        if ui
                            .selectable_label(chosen == Some(index), words(&points[index]))
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

/// While a run goes on, nobody has marked the front yet.
fn is_on_front(point: &LabPoint, points: &[Arc<LabPoint>]) -> bool {
    !points.iter().any(|other| point.is_beaten_by(other))
}

/// A way in a line.
fn words(point: &LabPoint) -> String {
    format!("{:.2} ms, FLIP {:.4}: {}", point.draw_ms, point.flip, point.label)
}

fn color(primitive: Primitive) -> Color32 {
    match primitive {
        Primitive::Auto | Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite => ACCENT,
        Primitive::Voxel | Primitive::Mesh => GOOD,
        Primitive::Point => ODD,
    }
}

/// Where a way is in the plot: powers of ten of milliseconds, and the error.
fn place(point: &LabPoint) -> [f64; 2] {
    [point.draw_ms.max(1e-3).log10(), point.flip]
}

/// Draws all points; the one that was clicked.
fn plot(ui: &mut Ui, points: &[Arc<LabPoint>], chosen: Option<usize>) -> Option<usize> {
    let mut front: Vec<[f64; 2]> = points
        .iter()
        .filter(|point| is_on_front(point, points))
        .map(|point| place(point))
        .collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let plot = Plot::new("time and error")
        .height(PLOT_HEIGHT)
        .allow_scroll(false)
        .include_y(0.0)
        .x_axis_label("milliseconds a picture")
        .y_axis_label("FLIP of the object")
        .x_grid_spacer(|input| decades(input.bounds))
        .x_axis_formatter(|mark, _| milliseconds(mark.value))
        .label_formatter(|_| None);
    let response = plot.show(ui, |plot| {
        plot.line(
            Line::new("front", PlotPoints::from(front))
                .color(Color32::GRAY)
                .style(LineStyle::dashed_dense()),
        );
        for primitive in Primitive::ALL {
            for (renderer, shape) in [
                (RendererChoice::Cpu, MarkerShape::Circle),
                (RendererChoice::Gpu, MarkerShape::Square),
            ] {
                let of_kind = points
                    .iter()
                    .filter(|point| point.style.primitive == *primitive && point.style.drawing.renderer == renderer);
                let places: Vec<[f64; 2]> = of_kind.map(|point| place(point)).collect();
                let name = format!("{primitive} {renderer}");
                plot.points(
                    Points::new(name, PlotPoints::from(places))
                        .shape(shape)
                        .radius(4.5)
                        .color(color(*primitive)),
                );
            }
        }
        if let Some(point) = chosen.and_then(|index| points.get(index)) {
            let ring = Points::new("chosen", PlotPoints::from(vec![place(point)]));
            plot.points(ring.radius(8.0).filled(false).color(Color32::WHITE));
        }
    });
    let on_screen = |point: &LabPoint| {
        let [x, y] = place(point);
        response.transform.position_from_point(&PlotPoint::new(x, y))
    };
    let nearest = |pointer: Pos2| {
        let distances = points.iter().map(|point| on_screen(point).distance(pointer));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest
            .filter(|(_, distance)| *distance <= REACH)
            .map(|(index, _)| index)
    };
    let hovered = response.response.hover_pos().and_then(nearest);
    let clicked = response.response.clicked().then_some(hovered).flatten();
    if let Some(index) = hovered {
        response.response.on_hover_text_at_pointer(words(&points[index]));
    }
    clicked
}

/// Grid lines at 1, 2 and 5 of each power of ten.
fn decades(bounds: (f64, f64)) -> Vec<GridMark> {
    let powers = bounds.0.floor() as i32..=bounds.1.ceil() as i32;
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

/// The picture of a way and its errors.
fn pictures(ui: &mut Ui, point: &Arc<LabPoint>) {
    ui.label(RichText::new(&point.label).strong());
    ui.horizontal(|ui| {
        for (what, image) in [("picture", &point.picture), ("error map", &point.error_map)] {
            let texture = texture(ui, point, what, image);
            let size = texture.size_vec2();
            ui.add(egui::Image::new((texture.id(), size)).alt_text(what))
                .on_hover_text(match what {
                    "picture" => "The first view as it was drawn",
                    _ => "Its FLIP error: black where there is none, pale where it is largest",
                });
        }
    });
}

/// The texture of a picture, made when it is first shown.
fn texture(ui: &Ui, point: &Arc<LabPoint>, what: &str, image: &image::RgbaImage) -> TextureHandle {
    let id = egui::Id::unique((&point.label, point.draw_ms.to_bits(), what));
    if let Some(texture) = ui.data(|data| data.get_temp::<TextureHandle>(id)) {
        return texture;
    }
    let size = [image.width() as usize, image.height() as usize];
    let pixels = ColorImage::from_rgba_unmultiplied(size, image);
    let texture = ui.ctx().load_texture(what, pixels, TextureOptions::LINEAR);
    ui.data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_labelled_in_milliseconds() {
        let labels = [-2.0, -0.3, 0.0, 1.7, 3.0].map(milliseconds);
        assert_eq!(labels, ["0.01", "0.5", "1", "50", "1000"]);
        let marks: Vec<f64> = decades((0.2, 0.9))
            .into_iter()
            .map(|mark| 10f64.powf(mark.value).round())
            .collect();
        assert_eq!(marks, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    }
}
