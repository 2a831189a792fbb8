//! An image with marks painted at positions of the cloud.

use crate::scene::Camera;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};
use glam::{DVec2, DVec3};

/// Radius of a ring around a place, points.
pub(in crate::app) const RING: f32 = 6.0;

/// The image, to be painted over at positions in the coordinates of the file.
pub(in crate::app) struct PictureOverlay<'a> {
    painter: &'a Painter,
    rect: Rect,
    size_px: [u32; 2],
    camera: &'a Camera,
}

impl<'a> PictureOverlay<'a> {
    /// An image of `size_px` over `rect`, as `camera` sees it.
    pub(in crate::app) fn new(painter: &'a Painter, rect: Rect, size_px: [u32; 2], camera: &'a Camera) -> Self {
        Self {
            painter,
            rect,
            size_px,
            camera,
        }
    }

    /// The direction that is up, in the coordinates of the file.
    pub(in crate::app) fn up(&self) -> DVec3 {
        self.camera.up.direction()
    }

    /// From pixels of the image to points of the window.
    fn to_window(&self, px: DVec2) -> Pos2 {
        let [width, height] = self.size_px.map(|edge| f64::from(edge.max(1)));
        let part = px / DVec2::new(width, height);
        // Far outside the window is far enough, and keeps f32 precise enough for additions.
        let part = part.clamp(DVec2::splat(-100.0), DVec2::splat(100.0));
        let size = self.rect.size();
        self.rect.min + vec2(part.x as f32 * size.x, part.y as f32 * size.y)
    }

    /// Projects a position in space to the window, if it is in front of the eye.
    pub(in crate::app) fn place(&self, place: DVec3) -> Option<Pos2> {
        let px = self.camera.to_px(place, self.size_px)?;
        Some(self.to_window(px))
    }

    /// [`Camera::along_line`] for a place of the window.
    pub(in crate::app) fn along_line(&self, place: DVec3, direction: DVec3, pointer: Pos2) -> Option<f64> {
        let [width, height] = self.size_px.map(|edge| f64::from(edge.max(1)));
        let part = (pointer - self.rect.min) / self.rect.size().max(vec2(1.0, 1.0));
        let px = DVec2::new(f64::from(part.x) * width, f64::from(part.y) * height);
        self.camera.along_line(place, direction, px, self.size_px)
    }

    /// Returns true if the image extends at least `height` points above a window position.
    pub(in crate::app) fn has_space_above(&self, place: Pos2, height: f32) -> bool {
        place.y - height > self.rect.top()
    }

    /// Draws a drag handle at a window position.
    pub(in crate::app) fn knob(&self, center: Pos2, radius: f32, fill: Color32) {
        let stroke = Stroke::new(1.5, Color32::from_black_alpha(200));
        self.painter.circle(center, radius, fill, stroke);
    }

    /// A ring around a place.
    pub(in crate::app) fn ring(&self, place: DVec3, color: Color32) {
        if let Some(center) = self.place(place) {
            let painter = self.painter;
            painter.circle_stroke(center, RING, Stroke::new(3.5, Color32::from_black_alpha(160)));
            painter.circle_stroke(center, RING, Stroke::new(1.5, color));
            painter.circle_filled(center, 1.5, color);
        }
    }

    /// A small dot.
    pub(in crate::app) fn dot(&self, place: DVec3, color: Color32) {
        if let Some(center) = self.place(place) {
            self.painter.circle_filled(center, 2.0, color);
        }
    }

    /// Lines from place to place, as far as they are in front of the eye.
    pub(in crate::app) fn polyline(&self, places: &[DVec3], stroke: Stroke) {
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

    /// A line with a shadow.
    pub(in crate::app) fn line(&self, ends: [DVec3; 2], stroke: Stroke) {
        if let Some(px) = self.camera.line_to_px(ends, self.size_px) {
            let ends = px.map(|px| self.to_window(px));
            let shadow = Stroke::new(stroke.width + 2.0, Color32::from_black_alpha(130));
            self.painter.line_segment(ends, shadow);
            self.painter.line_segment(ends, stroke);
        }
    }

    /// Draws a dot at a position with a text next to it, as in exported images; draws nothing at an opacity of 0.
    pub(in crate::app) fn note(&self, place: DVec3, text: &str, opacity: f32) {
        let Some(center) = self.place(place) else { return };
        let painter = self.painter;
        painter.circle_filled(center, 4.7, Color32::from_black_alpha(204).gamma_multiply(opacity));
        let tint = Color32::from_rgb(255, 190, 60).gamma_multiply(opacity);
        painter.circle_filled(center, 3.5, tint);
        if text.is_empty() {
            return;
        }
        let color = Color32::WHITE.gamma_multiply(opacity);
        let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(14.0), color);
        let padding = vec2(5.0, 2.0);
        let corner = center + vec2(7.0, -7.0);
        let ground = Rect::from_min_max(
            pos2(corner.x, corner.y - galley.size().y - 2.0 * padding.y),
            pos2(corner.x + galley.size().x + 2.0 * padding.x, corner.y),
        );
        let dark = Color32::from_black_alpha(184).gamma_multiply(opacity);
        painter.rect_filled(ground, 3.0, dark);
        painter.galley(ground.min + padding, galley, color);
    }

    /// A text on a dark ground.
    pub(in crate::app) fn label(&self, midpoint: Pos2, text: &str) {
        let font = FontId::proportional(14.0);
        let galley = self.painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
        let place = Align2::CENTER_CENTER.anchor_size(midpoint, galley.size());
        self.painter
            .rect_filled(place.expand2(vec2(5.0, 2.0)), 4.0, Color32::from_black_alpha(190));
        self.painter
            .galley(pos2(place.min.x, place.min.y), galley, Color32::WHITE);
    }
}
