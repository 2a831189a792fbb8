//! Measurements between clicked points, and their values.

use super::anchor::Anchor;
use crate::app::side::Side;
use crate::app::widgets::numbers::with_unit;
use crate::cloud::LengthUnit;
use crate::document::Measured;
use crate::scene::MeasurementKind;
use glam::DVec3;
use std::fmt::Write as _;

/// A value of `kind` as display text, lengths in `unit`.
pub(super) fn value_text(kind: MeasurementKind, value: Option<f64>, unit: Option<LengthUnit>) -> String {
    match (kind, value) {
        (_, None) => "none".to_owned(),
        (MeasurementKind::Angle, Some(value)) => format!("{value:.3}°"),
        (_, Some(value)) => with_unit(value, unit),
    }
}

/// A finished measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Kind of measurement.
    pub kind: MeasurementKind,
    /// Its points, the number that the tool takes.
    pub points: Vec<Anchor>,
}

impl Measurement {
    /// The measurement of the open sequence that a document has.
    pub(in crate::app) fn of(measured: &Measured) -> Self {
        Self {
            kind: measured.kind,
            points: measured.points.iter().map(Anchor::of).collect(),
        }
    }

    /// The measurement as a document has it; `None` if it is not of the open sequence alone.
    pub(in crate::app) fn measured(&self) -> Option<Measured> {
        Some(Measured {
            kind: self.kind,
            points: self.points.iter().map(Anchor::measured).collect::<Option<_>>()?,
        })
    }

    /// Returns the current value of the measurement.
    pub fn value(&self, up: DVec3) -> Option<f64> {
        let places: Vec<DVec3> = self.points.iter().map(|point| point.place).collect();
        self.kind.value(&places, up)
    }

    /// One line with all digits: the value, and each point with its frame (from 1), its index in the file (from 0) and
    /// where it is.
    pub fn line(&self, up: DVec3) -> String {
        let mut line = self.kind.name().to_lowercase();
        match self.value(up) {
            Some(value) => _ = write!(line, "\t{value}"),
            None => line.push_str("\tnone"),
        }
        for point in &self.points {
            let DVec3 { x, y, z } = point.place;
            let (frame, index) = (point.frame + 1, point.index_in_file);
            let of = match point.side {
                Side::A => "",
                Side::B => " of B",
            };
            _ = write!(line, "\tframe {frame}{of} point {index} at {x} {y} {z}");
        }
        line
    }
}
