//! Resolution of the user's choice to the paint of a frame.
//!
//! How it works: open choices (the source, the range, which way is up) are decided by the sample of the sequence's
//! first frame ([`ValueSample`]), so that they are the same for all frames, requested in any order. Only a source that
//! a frame lacks is replaced for that frame.

use super::{ColorRange, ColorSource, Coloring, DistanceFrom, FieldName, HeightAxis, plain_field_name};
use crate::analysis::{ColorMap, ColorScale, quantile_range};
use crate::cloud::{Frame, MAX_SAMPLE, ScalarField, ValueKind, ValueSample, even_places};
use glam::Vec3;
use std::sync::Arc;

/// Names of fields for the intensity of returned light, the best first.
const INTENSITIES: [&str; 3] = ["intensity", "reflectance", "reflectivity"];

/// Names of fields that classify points.
const CLASSES: [&str; 3] = ["classification", "class", "label"];

/// Names of fields for the time of measurement of a point.
const TIMES: [&str; 5] = ["gps_time", "gpstime", "time", "timestamp", "t"];

/// Colour hints: knowledge of a sequence beyond its first frame, or wishes; guessed from that frame where it is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ColorHints {
    /// The unit vector that points up in the image.
    pub up: Option<Vec3>,
    /// True if a cloud without colours is better shown by its height than by its normals: terrain, streets.
    pub prefers_height: Option<bool>,
}

/// Resolved colouring of the points of a frame: nothing is left open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint {
    /// The colours of the file.
    File,
    /// The direction of the normal.
    Normal,
    /// Red, green and blue of all points.
    Uniform([u8; 3]),
    /// The usual colours of the classes in this field.
    Classes(FieldName),
    /// Numbers through a map.
    Scale {
        /// Values to colour by.
        values: PaintValues,
        /// The map.
        map: ColorMap,
        /// Colour scale: the position in the map of the numbers of the file.
        scale: ColorScale,
    },
}

/// Numbers of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PaintValues {
    /// A scalar field.
    Field(FieldName),
    /// Signed distance of points along this unit vector from the origin of the file's coordinates.
    Height(Vec3),
    /// The distance from here, relative to the origin of the sequence.
    Distance(Vec3),
    /// The distance to the nearest point of another frame. The measuring code has given the colours.
    Change,
}

impl ColorHints {
    /// Everything is guessed.
    pub const NONE: Self = Self {
        up: None,
        prefers_height: None,
    };
}

impl ColorSource {
    /// Returns true if `frame` itself has the data that this colour source requires.
    pub fn is_of(self, frame: &Frame) -> bool {
        match self {
            Self::File => frame.colors().is_some(),
            _ => self.is_of_fields(frame.scalar_fields()),
        }
    }

    /// Returns true if `fields` have the data that this colour source requires; always for one that requires no field.
    pub fn is_of_fields(self, fields: &[ScalarField]) -> bool {
        match self {
            Self::Scalar(Some(name)) => fields.iter().any(|field| name.names(&field.name)),
            Self::Scalar(None) => !fields.is_empty(),
            Self::Time => named(fields, &TIMES).is_some(),
            Self::Class => named(fields, &CLASSES).is_some(),
            Self::Auto | Self::File | Self::Normal | Self::Height(_) | Self::Distance(_) | Self::Uniform => true,
        }
    }
}

impl Paint {
    /// Distances to another frame from 0 to `range`.
    pub fn change(range: f64, map: ColorMap) -> Self {
        Self::Scale {
            values: PaintValues::Change,
            map,
            scale: ColorScale::new(0.0, range.max(0.0), false),
        }
    }

    /// Returns the colour source it shows, in the terms of a user's choice; never [`ColorSource::Auto`] or
    /// [`ColorSource::Time`].
    pub fn source(&self) -> ColorSource {
        match self {
            Self::File => ColorSource::File,
            Self::Normal => ColorSource::Normal,
            Self::Uniform(_) => ColorSource::Uniform,
            Self::Classes(_) => ColorSource::Class,
            Self::Scale { values, .. } => match values {
                PaintValues::Field(name) => ColorSource::Scalar(Some(*name)),
                PaintValues::Height(_) => ColorSource::Height(HeightAxis::Auto),
                PaintValues::Distance(_) | PaintValues::Change => ColorSource::Distance(DistanceFrom::Sensor),
            },
        }
    }
}

impl Coloring {
    /// Returns the paint that the points of `frame` are coloured with.
    pub fn paint(&self, hints: &ColorHints, frame: &Frame) -> Paint {
        let sample = frame.value_sample();
        let chosen = match self.source {
            ColorSource::Auto => None,
            ColorSource::File => frame.colors().map(|_| Paint::File),
            ColorSource::Normal => Some(Paint::Normal),
            ColorSource::Uniform => Some(Paint::Uniform(self.one_color)),
            ColorSource::Scalar(name) => self.scalar(name, frame),
            ColorSource::Time => {
                let time = named(frame.scalar_fields(), &TIMES);
                self.scalar(time.map(name_of), frame)
            }
            ColorSource::Class => {
                let field = named(frame.scalar_fields(), &CLASSES);
                field.map(|field| Paint::Classes(name_of(field)))
            }
            ColorSource::Height(axis) => Some(self.height(axis, hints, frame)),
            ColorSource::Distance(from) => {
                // If the sensor moves, the range is the one of the first frame from its own sensor position.
                let [from, of_range] = match from {
                    DistanceFrom::Sensor => [frame.sensor(), sample.sensor],
                    DistanceFrom::Place(place) => [Some((place - sample.origin).as_vec3()); 2],
                }
                .map(|from| PaintValues::Distance(from.unwrap_or((-sample.origin).as_vec3())));
                Some(self.scaled_as(from, &of_range, frame))
            }
        };
        chosen.unwrap_or_else(|| self.automatic(hints, frame))
    }

    /// The order of [`ColorSource::Auto`].
    fn automatic(&self, hints: &ColorHints, frame: &Frame) -> Paint {
        let sample = frame.value_sample();
        let varying = |names: &[&str], varies: fn(&ValueSample, &str) -> bool| {
            let field = named(frame.scalar_fields(), names)?;
            varies(sample, &field.name).then(|| name_of(field))
        };
        let colors = frame.colors().filter(|_| sample.has_telling_colors());
        let prefers_height = || {
            let known = hints.prefers_height;
            known.unwrap_or_else(|| is_survey(sample)) && !frame.is_empty()
        };
        if colors.is_some() {
            Paint::File
        } else if let Some(name) = varying(&INTENSITIES, is_spread) {
            let is_logarithmic = self.is_logarithmic || is_skewed(sample, name.as_str());
            let scaled = Self {
                is_logarithmic,
                ..*self
            };
            scaled.scaled(PaintValues::Field(name), frame)
        } else if let Some(name) = varying(&CLASSES, varies) {
            Paint::Classes(name)
        } else if prefers_height() {
            self.height(HeightAxis::Auto, hints, frame)
        } else {
            Paint::Normal
        }
    }

    fn scalar(&self, name: Option<FieldName>, frame: &Frame) -> Option<Paint> {
        let mut fields = frame.scalar_fields().iter();
        let field = match name {
            Some(name) => fields.find(|field| name.names(&field.name)),
            None => fields.next(),
        };
        field.map(|field| self.scaled(PaintValues::Field(name_of(field)), frame))
    }

    fn height(&self, axis: HeightAxis, hints: &ColorHints, frame: &Frame) -> Paint {
        let up = match axis {
            HeightAxis::Auto => hints.up.unwrap_or_else(|| likely_up(frame.value_sample())),
            HeightAxis::Axis(axis, is_down) => {
                let axis = Vec3::AXES[usize::from(axis).min(2)];
                if is_down { -axis } else { axis }
            }
        };
        self.scaled(PaintValues::Height(up), frame)
    }

    fn scaled(&self, values: PaintValues, frame: &Frame) -> Paint {
        self.scaled_as(values, &values, frame)
    }

    /// Numbers in the range of others.
    fn scaled_as(&self, values: PaintValues, of_range: &PaintValues, frame: &Frame) -> Paint {
        let [low, high] = match self.range {
            ColorRange::Fixed { low, high } => [low, high],
            ColorRange::Percentiles { low, high } => {
                let shares = low / 100.0..high / 100.0;
                let of = |sorted: &[f32], offset: f64| quantile_range(self.with_colors(sorted, offset), offset, shares);
                let sample = frame.value_sample();
                let range = if let Some((kind, offset)) = value_kind(of_range, sample) {
                    of(&sample.sorted(kind), offset)
                } else {
                    // The first frame does not have the field.
                    own_values(of_range, frame).and_then(|(sorted, offset)| of(&sorted, offset))
                };
                range.unwrap_or([0.0, 1.0])
            }
        };
        Paint::Scale {
            values,
            map: self.map,
            scale: ColorScale::new(low, high, self.is_logarithmic),
        }
    }

    /// Returns the ascending values whose positions determine the range: all, or those that have a logarithm if there
    /// are any.
    fn with_colors<'a>(&self, sorted: &'a [f32], offset: f64) -> &'a [f32] {
        let begin = sorted.partition_point(|&value| f64::from(value) + offset <= 0.0);
        match sorted.get(begin..) {
            Some(positive) if self.is_logarithmic && !positive.is_empty() => positive,
            _ => sorted,
        }
    }
}

/// Returns the value kind by which these numbers are queried from a sample, and the offset to be added to the results;
/// `None` if it does not have the field.
pub fn value_kind(values: &PaintValues, sample: &ValueSample) -> Option<(ValueKind, f64)> {
    match values {
        PaintValues::Field(name) => {
            let mut fields = sample.scalars.iter();
            let place = fields.position(|field| name.names(&field.name))?;
            Some((ValueKind::Field(place), sample.scalars[place].offset))
        }
        PaintValues::Height(up) => {
            let offset = sample.origin.dot(up.as_dvec3());
            Some((ValueKind::Along(*up), offset))
        }
        PaintValues::Distance(from) => Some((ValueKind::From(*from), 0.0)),
        PaintValues::Change => None,
    }
}

/// The finite values of a frame's own field, ascending, and its offset.
fn own_values(values: &PaintValues, frame: &Frame) -> Option<(Vec<f32>, f64)> {
    let PaintValues::Field(name) = values else {
        return None;
    };
    let mut fields = frame.scalar_fields().iter();
    let field = fields.find(|field| name.names(&field.name))?;
    let places = even_places(field.values.len(), MAX_SAMPLE);
    let values = places.into_iter().map(|place| field.values[place]);
    let mut values: Vec<f32> = values.filter(|value| value.is_finite()).collect();
    values.sort_unstable_by(f32::total_cmp);
    Some((values, field.offset))
}

fn name_of(field: &ScalarField) -> FieldName {
    FieldName::new(&field.name)
}

/// The field with the first of `names` that there is.
fn named<'a>(fields: &'a [ScalarField], names: &[&str]) -> Option<&'a ScalarField> {
    names.iter().find_map(|name| {
        let mut fields = fields.iter();
        fields.find(|field| plain_field_name(&field.name).eq_ignore_ascii_case(name))
    })
}

/// The values of the field of this name, ascending.
fn sorted_field(sample: &ValueSample, name: &str) -> Option<Arc<[f32]>> {
    let mut fields = sample.scalars.iter();
    let place = fields.position(|field| field.name == name)?;
    Some(sample.sorted(ValueKind::Field(place)))
}

/// Returns true if the field of this name has different values.
fn varies(sample: &ValueSample, name: &str) -> bool {
    sorted_field(sample, name).is_some_and(|sorted| sorted.first() != sorted.last())
}

/// Returns true if the field of this name shows the scanned scene: its values are spread. If nearly all are one number,
/// as the confidence of a range scan is, the others are specks.
fn is_spread(sample: &ValueSample, name: &str) -> bool {
    const MIN_SPREAD: f32 = 0.02;
    let Some(sorted) = sorted_field(sample, name).filter(|sorted| !sorted.is_empty()) else {
        return false;
    };
    let at = |share: f32| sorted[(share * (sorted.len() - 1) as f32) as usize];
    at(0.75) - at(0.25) > MIN_SPREAD * (at(0.99) - at(0.01))
}

/// Returns true if most of the values are so near to the low end of their range that steps of the logarithm separate
/// them better: light that comes back from retroreflectors is a thousand times that from asphalt.
fn is_skewed(sample: &ValueSample, name: &str) -> bool {
    const SKEWED: f32 = 0.2;
    let Some(sorted) = sorted_field(sample, name) else {
        return false;
    };
    let positive = &sorted[sorted.partition_point(|&value| value <= 0.0)..];
    if 2 * positive.len() < sorted.len() || positive.is_empty() {
        return false;
    }
    let at = |share: f32| positive[(share * (positive.len() - 1) as f32) as usize];
    at(0.5) - at(0.01) < SKEWED * (at(0.99) - at(0.01))
}

/// Returns the likely up axis of the points: depth cameras look along +Z with Y down, LiDAR sensors stand within their
/// scene with Z up, surveys are wide and flat along Z, and everything else is taken for a model with Y up.
fn likely_up(sample: &ValueSample) -> Vec3 {
    match sample.sensor {
        Some(_) if is_seen_in_front(sample) => Vec3::NEG_Y,
        Some(_) => Vec3::Z,
        None if sample.bounds().is_flat_along_z() => Vec3::Z,
        None => Vec3::Y,
    }
}

/// Returns true if points are a survey of the ground or a place, not an object: wide and flat, or around a scanner.
fn is_survey(sample: &ValueSample) -> bool {
    match sample.sensor {
        Some(_) => !is_seen_in_front(sample),
        None => sample.bounds().is_flat_along_z(),
    }
}

fn is_seen_in_front(sample: &ValueSample) -> bool {
    let bounds = sample.bounds();
    sample.sensor.is_some_and(|sensor| bounds.min.z >= sensor.z)
}

#[cfg(test)]
#[path = "resolve_tests.rs"]
mod tests;
