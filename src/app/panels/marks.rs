//! What is painted over the picture where points were clicked on: rings, lines and values.

use super::trails::paint_trails;
use crate::app::theme::{ACCENT, ODD};
use crate::app::{Anchor, Gauge, State};
use crate::scene::{Camera, CameraPath};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Ui, pos2, vec2};
use glam::{DVec2, DVec3};

/// A camera path is painted in so many pieces.
const PATH_PIECES: usize = 256;

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
    if let Some(path) = state.path.draft.path()
        && state.panels.path
        && !state.path.is_playing()
    {
        canvas.camera_path(path);
    }
    paint_trails(&canvas, state);
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

/// The picture, to be painted over at places in the coordinates of the file.
pub(super) struct Canvas<'a> {
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

    pub(super) fn ring(&self, place: DVec3, color: Color32) {
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

    pub(super) fn dot(&self, place: DVec3, color: Color32) {
        if let Some(center) = self.place(place) {
            self.painter.circle_filled(center, 2.0, color);
        }
    }

    /// Lines from place to place, as far as they are in front of the eye.
    pub(super) fn polyline(&self, places: &[DVec3], stroke: Stroke) {
        let mut run: Vec<Pos2> = Vec::with_capacity(places.len());
        for ends in places.windows(2) {
            let px = self.camera.line_to_px([ends[0], ends[1]], self.size_px);
            let Some([from, to]) = px.map(|px| px.map(|px| self.to_window(px))) else {
                continue;
            };
            if run.last() != Some(&from) {
                self.painter.line(std::mem::take(&mut run), stroke);
                run.push(from);
            }
            run.push(to);
        }
        self.painter.line(run, stroke);
    }

    fn line(&self, ends: [DVec3; 2], stroke: Stroke) {
        if let Some(px) = self.camera.line_to_px(ends, self.size_px) {
            let ends = px.map(|px| self.to_window(px));
            let shadow = Stroke::new(stroke.width + 2.0, Color32::from_black_alpha(130));
            self.painter.line_segment(ends, shadow);
            self.painter.line_segment(ends, stroke);
        }
    }

    /// The way of the eye, with a ring at each keyframe.
    fn camera_path(&self, path: &CameraPath) {
        let eye = |piece: usize| {
            let share = piece as f64 / PATH_PIECES as f64;
            path.at(share * path.duration_s()).0.eye_in_world()
        };
        let eyes: Vec<DVec3> = (0..=PATH_PIECES).map(eye).collect();
        for ends in eyes.windows(2).filter(|ends| ends[0] != ends[1]) {
            self.line([ends[0], ends[1]], Stroke::new(1.5, ACCENT));
        }
        for key in path.keyframes().iter().take(PATH_PIECES) {
            self.ring(key.camera.eye_in_world(), ACCENT);
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
