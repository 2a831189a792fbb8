//! The report of the error lab as one page: a plot of time against error, the images and the errors behind each point,
//! and the table. The file is self-contained: no network access.

use super::{Cell, Report};
use crate::bench::{LabError, LabPoint};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use image::{ImageFormat, RgbaImage};
use serde_json::{Value, json};
use std::io::Cursor;

/// The page; `DATA` and `TITLE` are filled in.
const PAGE: &str = include_str!("lab.html");

impl Report {
    /// The page of a report with points.
    pub fn to_html(&self) -> String {
        let points: Vec<Value> = self
            .points
            .iter()
            .zip(&self.rows)
            .map(|(point, row)| {
                let numbers = self
                    .all_columns()
                    .iter()
                    .filter(|column| column.is_shown && !column.is_text());
                let details: Vec<Value> = numbers
                    .filter_map(|column| {
                        let cell = self.value(row, column.key)?;
                        (*cell != Cell::Missing).then(|| json!([column.title, column.show(cell)]))
                    })
                    .collect();
                let truth = self.value(row, "truth");
                point_data(point, truth, &details)
            })
            .collect();
        let data = json!({
            "header": self.header(),
            "points": points,
        });
        let title = format!("pointreel {}: time and error", self.environment.version);
        // Within a script element only its end tag has a meaning.
        let data = data.to_string().replace("</", "<\\/");
        PAGE.replace("TITLE", &escaped(&title)).replace("DATA", &data)
    }
}

fn point_data(point: &LabPoint, truth: Option<&Cell>, details: &[Value]) -> Value {
    json!({
        "sequence": point.sequence,
        "label": point.label,
        "renderer": point.style.drawing.renderer.name(),
        "primitive": point.style.primitive.name(),
        "truth": truth,
        "ms": point.draw_ms,
        "flip": point.flip,
        "flip_over_time": point.flip_over_time,
        "front": point.is_on_front(LabError::Image),
        "front_over_time": point.is_on_front(LabError::OverTime),
        "details": details,
        "picture": data_url(&point.picture),
        "error": data_url(&point.error_map),
    })
}

/// An image as a data URL; empty if it cannot be encoded, which happens only without pixels.
fn data_url(image: &RgbaImage) -> String {
    let mut png = Cursor::new(Vec::new());
    match image.write_to(&mut png, ImageFormat::Png) {
        Ok(()) => format!("data:image/png;base64,{}", BASE64.encode(png.get_ref())),
        Err(_) => String::new(),
    }
}

/// Text of an HTML element.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
