//! What is painted over the picture where points were clicked on: rings, lines and values.

use crate::app::theme::{ACCENT, ODD};
use crate::app::{Anchor, Gauge, State};
use crate::scene::Camera;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Ui, pos2, vec2};
use glam::{DVec2, DVec3};

/// Radius of a ring around a point, points.
const RING: f32 = 6.0;

/// Paints the marks of the clicked points, where they are in the picture that is drawn next, or in both.
pub(super) fn marks_ui(ui: &Ui, state: &State) {
    let viewport = &state.viewport;
    marks(ui, state, viewport.rect, viewport.size_px);
    if viewport.other_rect != viewport.rect {
        marks(ui, state, viewport.other_rect, viewport.other_size_px);
    }
}

fn marks(ui: &Ui, state: &State, rect: Rect, size_px: [u32; 2]) {
    let canvas = Canvas {
        painter: &ui.painter_at(rect),
        rect,
        size_px,
        camera: &state.camera,
    };
    let inspection = &state.inspection;
    let up = state.camera.up.direction();
    for measurement in &inspection.measurements {
        let text = measurement.gauge.text(measurement.value(up));
        canvas.measurement(measurement.gauge, &measurement.points, &text);
    }
    canvas.measurement(inspection.gauge, &inspection.begun, "");
    if let Some(point) = &inspection.point {
        canvas.ring(point.anchor.place, ACCENT);
    }
}

struct Canvas<'a> {
    painter: &'a Painter,
    rect: Rect,
    size_px: [u32; 2],
    camera: &'a Camera,
}

impl Canvas<'_> {
    /// From pixels of the picture to points of the window.
    fn to_window(&self, px: DVec2) -> Pos2 {
        let [width, height] = self.size_px.map(|edge| f64::from(edge.max(1)));
        let part = px / DVec2::new(width, height);
        // Far beyond the window is far enough, and f32 that can be added to.
        let part = part.clamp(DVec2::splat(-100.0), DVec2::splat(100.0));
        let size = self.rect.size();
        self.rect.min + vec2(part.x as f32 * size.x, part.y as f32 * size.y)
    }

    fn place(&self, place: DVec3) -> Option<Pos2> {
        let px = self.camera.to_px(place, self.size_px)?;
        Some(self.to_window(px))
    }

    fn ring(&self, place: DVec3, color: Color32) {
        if let Some(center) = self.place(place) {
            let painter = self.painter;
            painter.circle_stroke(
                center,
                RING,
                Stroke::new(3.5, Color32::from_black_alpha(160)),
            );
            painter.circle_stroke(center, RING, Stroke::new(1.5, color));
            painter.circle_filled(center, 1.5, color);
        }
    }

    fn line(&self, ends: [DVec3; 2], stroke: Stroke) {
        if let Some(px) = self.camera.line_to_px(ends, self.size_px) {
            let ends = px.map(|px| self.to_window(px));
            let shadow = Stroke::new(stroke.width + 2.0, Color32::from_black_alpha(130));
            self.painter.line_segment(ends, shadow);
            self.painter.line_segment(ends, stroke);
        }
    }

    fn measurement(&self, gauge: Gauge, points: &[Anchor], text: &str) {
        for pair in points.windows(2) {
            let [from, to] = [pair[0].place, pair[1].place];
            self.line([from, to], Stroke::new(1.5, ODD));
            if gauge == Gauge::Height {
                // The height itself, from the first point upwards, and level from there.
                let up = self.camera.up.direction();
                let corner = from + up * (to - from).dot(up);
                self.line([from, corner], Stroke::new(1.5, Color32::WHITE));
                self.line([corner, to], Stroke::new(1.0, Color32::GRAY));
            }
        }
        for point in points {
            self.ring(point.place, ODD);
        }
        let label = match (gauge, points) {
            (Gauge::Angle, &[_, corner, ..]) => corner.place,
            (_, &[from, to, ..]) => from.place.midpoint(to.place),
            _ => return,
        };
        if let Some(place) = self.place(label).filter(|_| !text.is_empty()) {
            self.label(place + vec2(0.0, -RING - 8.0), text);
        }
    }

    fn label(&self, middle: Pos2, text: &str) {
        let font = FontId::proportional(14.0);
        let galley = self
            .painter
            .layout_no_wrap(text.to_owned(), font, Color32::WHITE);
        let place = Align2::CENTER_CENTER.anchor_size(middle, galley.size());
        self.painter.rect_filled(
            place.expand2(vec2(5.0, 2.0)),
            4.0,
            Color32::from_black_alpha(190),
        );
        self.painter
            .galley(pos2(place.min.x, place.min.y), galley, Color32::WHITE);
    }
}
