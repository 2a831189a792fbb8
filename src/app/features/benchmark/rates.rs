//! Compression settings for a frame by rate and distortion: a plot that grows while they are measured. A click on a
//! point shows the frame as it is then, next to the original.

use super::hit::hit;
use super::pictures::{pictures_ui, side_by_side_or_below};
use crate::app::theme::{ACCENT, GOOD, ODD};
use crate::bench::{RatePoint, Sweep};
use egui::{Color32, ScrollArea, Ui};
use egui_plot::{Corner, Legend, Line, Plot, PlotPoints, Points};
use std::sync::Arc;

const PLOT_HEIGHT: f32 = 300.0;

const LIST_HEIGHT: f32 = 170.0;

/// Kind of loss.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Loss {
    #[default]
    D1,
    D2,
    Colors,
    Flip,
}

impl Loss {
    const ALL: [Self; 4] = [Self::D1, Self::D2, Self::Colors, Self::Flip];

    fn name(self) -> &'static str {
        match self {
            Self::D1 => "D1",
            Self::D2 => "D2",
            Self::Colors => "Colours",
            Self::Flip => "FLIP",
        }
    }

    fn tooltip(self) -> &'static str {
        match self {
            Self::D1 => "PSNR of distances from point to point: higher is better",
            Self::D2 => "PSNR of distances along normals: higher is better",
            Self::Colors => "PSNR of the colours of points: higher is better",
            Self::Flip => "FLIP against the image of the original, over the object: lower is better",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::D1 => "D1 PSNR, dB",
            Self::D2 => "D2 PSNR, dB",
            Self::Colors => "PSNR of colours, dB",
            Self::Flip => "Visible error 0–1 (FLIP)",
        }
    }

    /// Corner of the plot that its curves do not reach.
    fn free_corner(self) -> Corner {
        match self {
            Self::D1 | Self::D2 | Self::Colors => Corner::RightBottom,
            Self::Flip => Corner::RightTop,
        }
    }

    /// Returns the loss of a compression setting for the frame; `None` where there is no loss of this kind, and
    /// decibels would be infinite.
    fn of(self, point: &RatePoint) -> Option<f64> {
        let loss = match self {
            Self::D1 => point.error.d1_psnr_db(),
            Self::D2 => point.error.d2_psnr_db(),
            Self::Colors => point.error.color_psnr_db(),
            Self::Flip => Some(point.flip),
        };
        loss.filter(|loss| loss.is_finite())
    }
}

/// The plot, the chosen encoding and the list of all; returns a newly chosen one.
pub(super) fn rates_ui(ui: &mut Ui, points: &[Arc<RatePoint>]) -> Option<Arc<RatePoint>> {
    let [loss_id, chosen_id] = ["loss", "chosen rate"].map(|what| ui.scope_id().with(what));
    let mut loss: Loss = ui.data(|data| data.get_temp(loss_id)).unwrap_or_default();
    let mut chosen: Option<usize> = ui.data(|data| data.get_temp(chosen_id));
    ui.horizontal(|ui| {
        for choice in Loss::ALL {
            ui.selectable_value(&mut loss, choice, choice.name())
                .on_hover_text(choice.tooltip());
        }
        ui.weak("over the bits per point of the original");
    });
    let mut clicked = plot(ui, points, loss, chosen);
    side_by_side_or_below(ui, |ui| {
        if let Some(point) = chosen.and_then(|index| points.get(index)) {
            let images = [&point.picture, &point.error_map];
            let key = point.bits_per_point.to_bits();
            ui.vertical(|ui| pictures_ui(ui, &point.label, key, images));
        }
        ui.vertical(|ui| {
            ui.weak("A click shows the frame at that rate next to the original:");
            let list = ScrollArea::both().id_salt("rates").auto_shrink([false, true]);
            let list = list.max_height(LIST_HEIGHT);
            // The window scrolls as well, and would leave less space to the list.
            let list = list.min_scrolled_height(LIST_HEIGHT);
            list.show(ui, |ui| {
                for index in by_rate(points) {
                    let label = ui.selectable_label(chosen == Some(index), words(&points[index]));
                    if label.clicked() {
                        clicked = Some(index);
                    }
                }
            });
        });
    });
    chosen = clicked.or(chosen);
    ui.data_mut(|data| {
        data.insert_temp(loss_id, loss);
        if let Some(chosen) = chosen {
            data.insert_temp(chosen_id, chosen);
        }
    });
    clicked.and_then(|index| points.get(index)).cloned()
}

fn by_rate(points: &[Arc<RatePoint>]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].bits_per_point.total_cmp(&points[b].bits_per_point));
    order
}

/// An encoding in one line.
fn words(point: &RatePoint) -> String {
    let decibels = |psnr_db: Option<f64>, what: &str| match psnr_db {
        Some(psnr_db) if psnr_db.is_finite() => format!(", {what} {psnr_db:.1} dB"),
        Some(_) => format!(", {what} exact"),
        None => String::new(),
    };
    format!(
        "{:.2} bits{}{}{}, FLIP {:.4}: {}",
        point.bits_per_point,
        decibels(point.error.d1_psnr_db(), "D1"),
        decibels(point.error.d2_psnr_db(), "D2"),
        decibels(point.error.color_psnr_db(), "colours"),
        point.flip,
        point.label
    )
}

fn color(sweep: Sweep) -> Color32 {
    match sweep {
        Sweep::Positions => ACCENT,
        Sweep::Normals => GOOD,
        Sweep::Colors => ODD,
    }
}

/// Draws all lossy encodings; returns the clicked one.
fn plot(ui: &mut Ui, points: &[Arc<RatePoint>], loss: Loss, chosen: Option<usize>) -> Option<usize> {
    let place = |index: usize| Some([points[index].bits_per_point, loss.of(&points[index])?]);
    let drawn: Vec<(usize, [f64; 2])> = by_rate(points)
        .into_iter()
        .filter_map(|index| Some((index, place(index)?)))
        .collect();
    let plot = Plot::new(("rate and distortion", loss.name()))
        .height(PLOT_HEIGHT)
        .allow_scroll(false)
        .include_x(0.0)
        .legend(Legend::default().position(loss.free_corner()))
        .x_axis_label("bits per point")
        .y_axis_label(loss.axis())
        .label_formatter(|_| None);
    let response = plot.show(ui, |plot| {
        for sweep in Sweep::ALL {
            let of_sweep = drawn.iter().filter(|(index, _)| points[*index].sweep == sweep);
            let places: Vec<[f64; 2]> = of_sweep.map(|(_, place)| *place).collect();
            if places.is_empty() {
                continue;
            }
            let line = PlotPoints::from(places.clone());
            let marks = PlotPoints::from(places);
            plot.line(Line::new(sweep.name(), line).color(color(sweep)).width(1.0));
            plot.points(Points::new(sweep.name(), marks).radius(4.5).color(color(sweep)));
        }
        if let Some(place) = chosen.filter(|&index| index < points.len()).and_then(place) {
            let ring = Points::new("", PlotPoints::from(vec![place]));
            plot.points(ring.radius(8.0).filled(false).color(Color32::WHITE));
        }
    });
    let places: Vec<[f64; 2]> = drawn.iter().map(|(_, place)| *place).collect();
    let (hovered, clicked) = hit(&response, &places);
    let of_drawn = |place: usize| drawn[place].0;
    if let Some(index) = hovered.map(of_drawn) {
        response.response.on_hover_text_at_pointer(words(&points[index]));
    }
    clicked.map(of_drawn)
}
