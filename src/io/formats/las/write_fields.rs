//! Mapping of scalar fields to a LAS point: to the standard field that the format has for them, or to extra bytes.
//!
//! A field goes to its standard field if that represents all of its numbers exactly. Intensity, class and time go there
//! in any case, as other programs look for them nowhere else: intensities are rounded to 16 bits.

use super::points::ANGLE_STEP;
use crate::cloud::ScalarField;
use crate::io::write::Loss;

/// Bytes that describe a field of extra bytes.
const DESCRIPTION_BYTES: usize = 192;

/// Bytes of its name.
const NAME_BYTES: usize = 32;

/// Descriptions that fit into a record.
const MAX_EXTRA_FIELDS: usize = u16::MAX as usize / DESCRIPTION_BYTES;

/// The fields that have a place in points of formats 6 and 7.
#[derive(Debug, Clone, Copy)]
pub(super) struct StandardFields<'a> {
    intensity: Option<(&'a ScalarField, f64)>,
    classification: Option<&'a ScalarField>,
    gps_time: Option<&'a ScalarField>,
    return_number: Option<&'a ScalarField>,
    number_of_returns: Option<&'a ScalarField>,
    scan_angle: Option<&'a ScalarField>,
    user_data: Option<&'a ScalarField>,
    point_source_id: Option<&'a ScalarField>,
    scanner_channel: Option<&'a ScalarField>,
    /// By the bit of the byte of flags that each is.
    flags: [Option<&'a ScalarField>; 8],
}

/// Names of the bits of the byte of flags.
const FLAGS: [(usize, &str); 6] = [
    (0, "synthetic"),
    (1, "key_point"),
    (2, "withheld"),
    (3, "overlap"),
    (6, "scan_direction_flag"),
    (7, "edge_of_flight_line"),
];

impl<'a> StandardFields<'a> {
    pub(super) fn of(scalars: &'a [ScalarField]) -> Self {
        let field = |name: &str| scalars.iter().find(|field| field.name.eq_ignore_ascii_case(name));
        let up_to = |name: &str, max: f64| {
            let fits = |value: f64| (0.0..=max).contains(&value) && value.fract() == 0.0;
            field(name).filter(|field| numbers(field).all(fits))
        };
        let mut flags = [None; 8];
        for (bit, name) in FLAGS {
            flags[bit] = up_to(name, 1.0);
        }
        let is_angle = |value: f64| {
            let raw = (value / f64::from(ANGLE_STEP)).round();
            raw.abs() <= f64::from(i16::MAX) && (raw as f32 * ANGLE_STEP) == value as f32
        };
        Self {
            intensity: field("intensity").map(|field| (field, intensity_scale(field))),
            classification: field("classification"),
            gps_time: field("gps_time"),
            return_number: up_to("return_number", 15.0),
            number_of_returns: up_to("number_of_returns", 15.0),
            scan_angle: field("scan_angle").filter(|field| numbers(field).all(is_angle)),
            user_data: up_to("user_data", 255.0),
            point_source_id: up_to("point_source_id", 65_535.0),
            scanner_channel: up_to("scanner_channel", 3.0),
            flags,
        }
    }

    fn has(&self, field: &ScalarField) -> bool {
        let of_own = [
            self.intensity.map(|(field, _)| field),
            self.classification,
            self.gps_time,
            self.return_number,
            self.number_of_returns,
            self.scan_angle,
            self.user_data,
            self.point_source_id,
            self.scanner_channel,
        ];
        let mut all = of_own.into_iter().chain(self.flags).flatten();
        all.any(|known| std::ptr::eq(known, field))
    }

    /// Adds the bytes of point `index` behind its coordinates and before its colour.
    pub(super) fn put(&self, index: usize, rows: &mut Vec<u8>) {
        let of = |field: Option<&ScalarField>, otherwise: f64| field.map_or(otherwise, |field| number(field, index));
        let intensity = self
            .intensity
            .map_or(0.0, |(field, scale)| number(field, index) * scale);
        // Casts saturate, and turn NaN into zero.
        rows.extend((intensity.round() as u16).to_le_bytes());
        let returns = of(self.return_number, 1.0) as u8 | (of(self.number_of_returns, 1.0) as u8) << 4;
        let mut flags = (of(self.scanner_channel, 0.0) as u8) << 4;
        for (bit, field) in self.flags.iter().enumerate() {
            flags |= (of(*field, 0.0) as u8) << bit;
        }
        let class = of(self.classification, 0.0).round() as u8;
        rows.extend([returns, flags, class, of(self.user_data, 0.0) as u8]);
        let angle = (of(self.scan_angle, 0.0) / f64::from(ANGLE_STEP)).round() as i16;
        rows.extend(angle.to_le_bytes());
        rows.extend((of(self.point_source_id, 0.0) as u16).to_le_bytes());
        let time = of(self.gps_time, 0.0);
        rows.extend(if time.is_finite() { time } else { 0.0 }.to_le_bytes());
    }

    /// Returns the number of points per return number; `finite` of `total` points are written. Without returns all are
    /// first ones.
    pub(super) fn return_counts(&self, total: usize, finite: u64) -> [u64; 15] {
        let mut counts = [0; 15];
        match self.return_number {
            Some(field) if total as u64 == finite => {
                for &value in &field.values {
                    if let Some(count) = counts.get_mut((value as usize).wrapping_sub(1)) {
                        *count += 1;
                    }
                }
            }
            _ => counts[0] = finite,
        }
        counts
    }
}

/// The fields without their own place in the format.
#[derive(Debug)]
pub(super) struct ExtraBytes<'a> {
    fields: Vec<&'a ScalarField>,
}

impl<'a> ExtraBytes<'a> {
    pub(super) fn of(scalars: &'a [ScalarField], standard: &StandardFields<'_>) -> Self {
        let others = scalars.iter().filter(|field| !standard.has(field));
        Self {
            fields: others.take(MAX_EXTRA_FIELDS).collect(),
        }
    }

    /// Bytes of a point.
    pub(super) fn point_bytes(&self) -> u16 {
        self.fields.iter().map(|field| if is_wide(field) { 8 } else { 4 }).sum()
    }

    /// The data of the record that describes them.
    pub(super) fn descriptions(&self) -> Vec<u8> {
        const SINGLE: u8 = 9;
        const DOUBLE: u8 = 10;
        let mut descriptions = Vec::new();
        for field in &self.fields {
            let mut description = [0; DESCRIPTION_BYTES];
            description[2] = if is_wide(field) { DOUBLE } else { SINGLE };
            let name = &field.name.as_bytes()[..field.name.floor_char_boundary(NAME_BYTES)];
            description[4..4 + name.len()].copy_from_slice(name);
            descriptions.extend(description);
        }
        descriptions
    }

    /// Adds the bytes of point `index`.
    pub(super) fn put(&self, index: usize, rows: &mut Vec<u8>) {
        for field in &self.fields {
            if is_wide(field) {
                rows.extend(number(field, index).to_le_bytes());
            } else {
                rows.extend(field.values[index].to_le_bytes());
            }
        }
    }
}

/// Returns the losses of `scalars`: fields beyond those that can be described, and values that their standard field
/// rounds.
pub(super) fn lost(scalars: &[ScalarField]) -> Vec<(Loss, f64)> {
    let standard = StandardFields::of(scalars);
    let extra = scalars.iter().filter(|field| !standard.has(field));
    let beyond = extra.skip(MAX_EXTRA_FIELDS);
    let mut lost: Vec<(Loss, f64)> = beyond
        .map(|field| (Loss::Field(format!("`{}`", field.name)), 0.0))
        .collect();
    let mut check = |field: Option<&ScalarField>, scale: f64, largest: f64, what: &str| {
        let fits = |value: f64| value.fract() == 0.0 && (0.0..=largest).contains(&value);
        if let Some(field) = field
            // Other programs store a fraction of 1 in 16 bits no more precisely.
            && (scale == 1.0 || field.values.iter().any(|value| !value.is_finite()))
            && !numbers(field).all(|value| fits(value * scale))
        {
            lost.push((Loss::Values(field.name.clone(), what.to_owned()), 0.0));
        }
    };
    let (intensity, scale) = standard.intensity.unzip();
    check(
        intensity,
        scale.unwrap_or(1.0),
        f64::from(u16::MAX),
        "whole numbers from 0 to 65535",
    );
    check(
        standard.classification,
        1.0,
        f64::from(u8::MAX),
        "whole numbers from 0 to 255",
    );
    lost
}

/// Returns true if single precision cannot represent the numbers.
fn is_wide(field: &ScalarField) -> bool {
    field.offset != 0.0
}

fn number(field: &ScalarField, index: usize) -> f64 {
    f64::from(field.values[index]) + field.offset
}

fn numbers(field: &ScalarField) -> impl Iterator<Item = f64> {
    field.values.iter().map(|&value| f64::from(value) + field.offset)
}

/// Returns the scale factor from intensities to 16 bits: other programs have intensities from 0 to 1.
fn intensity_scale(field: &ScalarField) -> f64 {
    let is_fraction = numbers(field).any(|value| value.fract() != 0.0)
        && !numbers(field).any(|value| !(0.0..=1.0).contains(&value) && value.is_finite());
    if is_fraction { f64::from(u16::MAX) } else { 1.0 }
}
