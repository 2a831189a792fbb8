//! The curve under the bar.

use super::cells::Cells;
use super::context::TimelineContext;
use crate::app::features::timeline::Quantity;
use crate::app::theme::ACCENT;
use crate::messages::grouped;
use egui::{Align2, FontId, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Height of the curve, points.
const HEIGHT: f32 = 40.0;

/// Between the curve and the edges of its field, points.
const MARGIN: f32 = 3.0;

/// The curve of the chosen quantity, if there is one.
pub(super) fn curve_ui(ui: &mut Ui, context: &mut TimelineContext<'_>) {
    let (Some(player), Some(quantity)) = (&context.player, context.timeline.quantity) else {
        return;
    };
    let size = vec2(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let frames = context.timeline.visible.of(player.sequence().len());
    let width = rect.width().max(1.0) as usize;
    let curve = &mut context.timeline.curve;
    curve.refresh(player.loader(), quantity, &frames, width);
    let name = format!("Curve: {}", quantity.name());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let weak = ui.visuals().weak_text_color();
    let Some((min, max)) = curve.range() else {
        let text = match quantity {
            Quantity::Loss | Quantity::Error => "no octree was built yet",
            Quantity::Points | Quantity::Bounds => "no frame was prepared yet",
        };
        painter.text(
            rect.center(),
            Align2::CENTER_CENTER,
            text,
            FontId::proportional(11.0),
            weak,
        );
        return;
    };
    paint(ui, rect, curve.columns(), min, max);
    for (value, place, align) in [
        (max, rect.left_top() + vec2(4.0, 1.0), Align2::LEFT_TOP),
        (min, rect.left_bottom() + vec2(4.0, -1.0), Align2::LEFT_BOTTOM),
    ] {
        painter.text(place, align, text_of(quantity, value), FontId::proportional(10.0), weak);
    }
    if let Some(pointer) = response.hover_pos() {
        let frame = Cells { rect, frames }.frame_at(pointer.x);
        let value = curve
            .value(frame)
            .map_or_else(|| "not known yet".to_owned(), |value| text_of(quantity, value));
        let text = format!(
            "{}: {value}\nFrame {}\n{}",
            quantity.name(),
            frame + 1,
            quantity.tooltip()
        );
        response.on_hover_text_at_pointer(text);
    }
}

/// A line through all columns that are known.
fn paint(ui: &Ui, rect: Rect, columns: &[Option<(f32, f32)>], min: f32, max: f32) {
    let painter = ui.painter_at(rect);
    let stroke = Stroke::new(1.0, ACCENT);
    let span = max - min;
    let y = |value: f32| {
        // A constant value is drawn at the centre.
        let part = if span > 0.0 { (value - min) / span } else { 0.5 };
        egui::lerp(rect.bottom() - MARGIN..=rect.top() + MARGIN, part)
    };
    // One polyline for each run of known columns: lines as short as a column are rounded away.
    let mut line: Vec<Pos2> = Vec::new();
    for (x, column) in columns.iter().chain([&None]).enumerate() {
        let Some((low, high)) = column.map(|(low, high)| (y(low), y(high))) else {
            painter.line(std::mem::take(&mut line), stroke);
            continue;
        };
        let x = rect.left() + x as f32;
        // The nearer end first, so that the line does not double back.
        let is_upwards = line
            .last()
            .is_none_or(|last| (last.y - low).abs() <= (last.y - high).abs());
        let (from, to) = if is_upwards { (low, high) } else { (high, low) };
        line.extend([pos2(x, from), pos2(x + 1.0, to)]);
    }
}

fn text_of(quantity: Quantity, value: f32) -> String {
    match quantity {
        Quantity::Points => grouped(value as u64),
        Quantity::Loss => format!("{:.2} %", 100.0 * value),
        Quantity::Bounds => format!("{value:.4}"),
        // Errors are small compared with the bounds.
        Quantity::Error => format!("{value:.3e}"),
    }
}
