//! The scale bar over the image.

use crate::app::State;
use crate::scene::ScaleBar;
use egui::{Align2, Color32, FontId, Painter, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Distance from the lower left corner of the image, points.
const MARGIN: f32 = 16.0;

/// Height of its text above the line, points.
const HEIGHT: f32 = 22.0;

/// Half the height of its ends.
const END: f32 = 4.0;

/// Paints it at the lower left of the image in `rect`.
pub(super) fn scale_bar_ui(ui: &mut Ui, rect: Rect, state: &State) {
    let shown = state.player.as_ref().and_then(|player| player.shown());
    let Some(frame) = shown.filter(|_| state.appearance.shows_scale_bar) else {
        return;
    };
    let unit = frame.frame.unit();
    let height = f64::from(rect.height());
    let Some(bar) = ScaleBar::of(&state.camera, height, 1.0, unit) else {
        return;
    };
    let length = bar.length_px as f32;
    let text = bar.text();
    let left = rect.left() + MARGIN;
    let line = rect.bottom() - MARGIN;
    if left + length + MARGIN > rect.right() || line - HEIGHT < rect.top() {
        return;
    }
    let painter = ui.painter_at(rect);
    for (stroke, shift) in [
        (Stroke::new(1.5, Color32::from_black_alpha(190)), vec2(1.0, 1.0)),
        (Stroke::new(1.5, Color32::from_gray(240)), vec2(0.0, 0.0)),
    ] {
        let at = |x: f32, y: f32| pos2(x, y) + shift;
        for ends in [
            [at(left, line), at(left + length, line)],
            [at(left, line - END), at(left, line + END)],
            [at(left + length, line - END), at(left + length, line + END)],
        ] {
            painter.line_segment(ends, stroke);
        }
        write(&painter, at(left + 0.5 * length, line - 5.0), &text, stroke.color);
    }
    let area = Rect::from_min_max(pos2(left, line - HEIGHT), pos2(left + length, line + END));
    let response = ui.interact(area, ui.scope_id().with("scale bar"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Scale bar: {text}")));
    response.on_hover_text(
        "Length at the distance of the orbit's centre. In perspective, nearer things look longer and farther \
            things shorter",
    );
}

fn write(painter: &Painter, place: egui::Pos2, text: &str, color: Color32) {
    painter.text(place, Align2::CENTER_BOTTOM, text, FontId::proportional(13.0), color);
}
