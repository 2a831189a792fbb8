//! Marks of clicked points, over the image: rings, lines and values.

use super::measuring::value_text;
use super::{Anchor, Inspection};
use crate::app::theme::{ACCENT, ODD};
use crate::app::widgets::overlay::{PictureOverlay, RING};
use crate::cloud::LengthUnit;
use crate::scene::MeasurementKind;
use egui::{Color32, Stroke, vec2};

/// Paints measurements with lengths in `unit`, including an unfinished one, and the point whose values are shown.
pub(in crate::app) fn paint_inspection(canvas: &PictureOverlay<'_>, inspection: &Inspection, unit: Option<LengthUnit>) {
    for measurement in &inspection.measurements {
        let text = value_text(measurement.kind, measurement.value(canvas.up()), unit);
        paint_measurement(canvas, measurement.kind, &measurement.points, &text);
    }
    paint_measurement(canvas, inspection.kind, &inspection.begun, "");
    if let Some(point) = &inspection.point {
        canvas.ring(point.anchor.place, ACCENT);
    }
}

fn paint_measurement(canvas: &PictureOverlay<'_>, kind: MeasurementKind, points: &[Anchor], text: &str) {
    for pair in points.windows(2) {
        let [from, to] = [pair[0].place, pair[1].place];
        canvas.line([from, to], Stroke::new(1.5, ODD));
        if kind == MeasurementKind::Height {
            // The vertical segment from the first point upwards, and a horizontal one from there.
            let up = canvas.up();
            let corner = from + up * (to - from).dot(up);
            canvas.line([from, corner], Stroke::new(1.5, Color32::WHITE));
            canvas.line([corner, to], Stroke::new(1.0, Color32::GRAY));
        }
    }
    for point in points {
        canvas.ring(point.place, ODD);
    }
    let label = match (kind, points) {
        (MeasurementKind::Angle, &[_, corner, ..]) => corner.place,
        (_, &[from, to, ..]) => from.place.midpoint(to.place),
        _ => return,
    };
    if let Some(place) = canvas.place(label).filter(|_| !text.is_empty()) {
        canvas.label(place + vec2(0.0, -RING - 8.0), text);
    }
}
