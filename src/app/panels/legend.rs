//! Colour legend, over the image: at its upper right.

use crate::app::widgets::ramp::paint_ramp;
use crate::app::{PanelId, State};
use crate::scene::{Legend, LegendBody};
use egui::{Align2, Color32, FontId, Painter, Rect, Stroke, Vec2, pos2, vec2};

const TEXT_SIZE: f32 = 12.0;
const ROW_HEIGHT: f32 = 17.0;
const PADDING: f32 = 9.0;
const RAMP: Vec2 = vec2(15.0, 190.0);

/// Height above and below the rows: margins, the title, and the axes in the corner.
const AROUND: f32 = 144.0;
const MIN_HEIGHT: f32 = 40.0;

/// The legend of the colours, if it is to be shown.
pub(super) fn legend_ui(painter: &Painter, rect: Rect, state: &State) {
    // The change map has its own legend in the same place; colours from images have no legend.
    let is_elsewhere = state.features.temporal.change.is_on || state.drawn_style().draws_photos();
    if !state.panels.has(PanelId::LEGEND) || is_elsewhere {
        return;
    }
    let legend = match state.screen_stats().and_then(|stats| stats.errors) {
        Some(errors) => Some(Legend::of_errors(&errors)),
        None => state.drawn_frame().and_then(|frame| Legend::of(frame)),
    };
    let Some(legend) = legend else {
        return;
    };
    let text =
        |text: &str, size: f32| painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), Color32::WHITE);
    let title = text(&legend.title, TEXT_SIZE + 1.0);
    let rows: Vec<_> = match &legend.body {
        LegendBody::Ramp { ticks, .. } => ticks.iter().map(|(_, tick)| text(tick, TEXT_SIZE)).collect(),
        LegendBody::Classes(classes) => classes.iter().map(|(_, name)| text(name, TEXT_SIZE)).collect(),
    };
    let space = (rect.height() - AROUND).max(MIN_HEIGHT);
    let (height, step) = match &legend.body {
        LegendBody::Ramp { .. } => (RAMP.y.min(space), 0.0),
        LegendBody::Classes(classes) => {
            let step = ROW_HEIGHT.min(space / classes.len().max(1) as f32);
            (step * classes.len() as f32, step)
        }
    };
    let widest = rows.iter().map(|row| row.size().x).fold(0.0, f32::max);
    let width = title.size().x.max(RAMP.x + 9.0 + widest);
    let head = title.size().y + 8.0;
    let size = vec2(width, head + height) + Vec2::splat(2.0 * PADDING);
    let place = Align2::RIGHT_TOP.align_size_within_rect(size, rect.shrink(12.0));
    painter.rect_filled(place, 6.0, Color32::from_black_alpha(165));
    let inner = place.shrink(PADDING);
    painter.galley(inner.min, title, Color32::WHITE);
    let bar = Rect::from_min_size(inner.min + vec2(0.0, head), vec2(RAMP.x, height));
    let line = Stroke::new(1.0, Color32::WHITE);
    match &legend.body {
        LegendBody::Ramp { map, ticks } => {
            paint_ramp(painter, bar, *map, true);
            let mut below = f32::INFINITY;
            for ((share, _), row) in ticks.iter().zip(rows) {
                let y = bar.bottom() - bar.height() * share;
                // A short ramp has no space for all labels.
                if below - y < 0.8 * row.size().y {
                    continue;
                }
                below = y;
                painter.line_segment([pos2(bar.right(), y), pos2(bar.right() + 4.0, y)], line);
                let half = 0.5 * row.size().y;
                let y = (y - half).clamp(bar.top() - half, bar.bottom() - half);
                painter.galley(pos2(bar.right() + 9.0, y), row, Color32::WHITE);
            }
        }
        LegendBody::Classes(classes) => {
            for (number, ((color, _), row)) in classes.iter().zip(rows).enumerate() {
                let center = bar.top() + step * (number as f32 + 0.5);
                let [red, green, blue, alpha] = *color;
                let patch = Rect::from_center_size(pos2(bar.center().x, center), Vec2::splat((step - 4.0).min(RAMP.x)));
                let color = Color32::from_rgba_unmultiplied(red, green, blue, alpha);
                painter.rect_filled(patch, 2.0, color);
                let half = 0.5 * row.size().y;
                painter.galley(pos2(bar.right() + 9.0, center - half), row, Color32::WHITE);
            }
        }
    }
}
