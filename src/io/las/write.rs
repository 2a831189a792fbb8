//! Writing LAS 1.4 with point format 6, or 7 with colours, compressed (LAZ) or not.
//!
//! Coordinates are integers in the file. Each axis gets the coarsest decimal scale, a thousandth or finer, at which no
//! coordinate loses a digit that it has: files that came from integers go back to the same ones and compress well, and
//! single precision is kept to its last bit. Where no scale does that, it is the finest at which the extent fits 32
//! bits.

use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::io::write::{Encoder, Held, Loss, WriteSeek};
use laz::{LazVlrBuilder, ParLasZipCompressor};
use std::io::{Error, Result};

const HEADER_BYTES: usize = 375;
const RECORD_HEADER_BYTES: usize = 54;

/// Points that are in memory as the file has them, at a time: some chunks for each thread.
const BLOCK_POINTS: usize = 1 << 20;

/// Integers on one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    /// Decimal digits behind the point; negative where the extent is larger than 32 bits.
    digits: i32,
    offset: f64,
}

impl Axis {
    /// Of a thousandth.
    const LEAST_DIGITS: i32 = 3;
    /// More than coordinates of double precision have.
    const MOST_DIGITS: i32 = 15;

    /// The scale for `coordinates` from `min` to `max`, each of which is known to `precision` times itself.
    fn new((min, max): (f64, f64), precision: f64, coordinates: &(impl Iterator<Item = f64> + Clone)) -> Self {
        let mut digits = Self::LEAST_DIGITS;
        while Self::fitting(digits, min, max).is_none() && digits > -300 {
            digits -= 1;
        }
        let mut axis = Self::fitting(digits, min, max).unwrap_or(Self {
            digits,
            offset: min / 2.0 + max / 2.0,
        });
        while axis.digits < Self::MOST_DIGITS
            && !coordinates
                .clone()
                .all(|value| (axis.value(axis.raw(value)) - value).abs() <= precision * value.abs())
        {
            let Some(finer) = Self::fitting(axis.digits + 1, min, max) else {
                break;
            };
            axis = finer;
        }
        axis
    }

    /// The axis with so many digits if the extent fits it: without an offset if that does, else with one between the
    /// two.
    fn fitting(digits: i32, min: f64, max: f64) -> Option<Self> {
        let middle = (min / 2.0 + max / 2.0).round();
        [0.0, middle]
            .map(|offset| Self { digits, offset })
            .into_iter()
            .find(|axis| {
                [min, max]
                    .iter()
                    .all(|&value| ((value - axis.offset) / axis.scale()).abs() < f64::from(i32::MAX) - 1.0)
            })
    }

    /// As decimal, so that it is the number that others write for it, too.
    fn scale(self) -> f64 {
        if self.digits >= 0 {
            1.0 / 10f64.powi(self.digits)
        } else {
            10f64.powi(-self.digits)
        }
    }

    fn raw(self, value: f64) -> i32 {
        ((value - self.offset) / self.scale()).round() as i32
    }

    fn value(self, raw: i32) -> f64 {
        f64::from(raw) * self.scale() + self.offset
    }
}

/// LAS.
pub(in crate::io) const LAS: &Encoder = &Encoder {
    name: "las",
    extension: "las",
    holds: &[Held::Scalars],
    lost,
    write: |out, cloud| write(out, cloud, false),
};

/// LAS, compressed.
pub(in crate::io) const LAZ: &Encoder = &Encoder {
    name: "laz",
    extension: "laz",
    holds: &[Held::Scalars],
    lost,
    write: |out, cloud| write(out, cloud, true),
};

/// Scalars that have no field, values that do not fit theirs, and coordinates that do not fit 32 bits.
fn lost(cloud: &RawCloud) -> Vec<(Loss, f64)> {
    let points = LasPoints::new(cloud);
    let fields = [
        points.intensity.map(|(field, _)| field),
        points.classification,
        points.gps_time,
    ];
    let is_written = |field: &&ScalarField| fields.into_iter().flatten().any(|known| std::ptr::eq(known, *field));
    let scalars = cloud.attributes.scalars.iter();
    let unwritten = scalars.filter(|field| !is_written(field));
    let mut lost: Vec<(Loss, f64)> = unwritten
        .map(|field| (Loss::Field(format!("`{}`", field.name)), 0.0))
        .collect();
    let mut check = |field: Option<&ScalarField>, scale: f64, largest: f64, what: &str| {
        let fits = |value: f64| value.fract() == 0.0 && (0.0..=largest).contains(&value);
        let number = |field: &ScalarField, value: f32| (f64::from(value) + field.offset) * scale;
        if let Some(field) = field
            // A fraction of 1 in 16 bits is no more precise in other programs.
            && (scale == 1.0 || field.values.iter().any(|value| !value.is_finite()))
            && !field.values.iter().all(|&value| fits(number(field, value)))
        {
            lost.push((Loss::Values(field.name.clone(), what.to_owned()), 0.0));
        }
    };
    let scale = points.intensity.map_or(1.0, |(_, scale)| scale);
    let intensity = points.intensity.map(|(field, _)| field);
    check(intensity, scale, f64::from(u16::MAX), "whole numbers from 0 to 65535");
    check(
        points.classification,
        1.0,
        f64::from(u8::MAX),
        "whole numbers from 0 to 255",
    );
    let error = points.largest_error();
    if error > 0.0 {
        lost.push((Loss::Precision, error));
    }
    lost
}

/// Writes the finite points of `cloud`, with colours, `intensity`, `classification` and `gps_time` if they are there.
pub(super) fn write(out: &mut dyn WriteSeek, cloud: &RawCloud, compressed: bool) -> Result<()> {
    let points = LasPoints::new(cloud);
    let compression = compressed
        .then(|| LazVlrBuilder::default().with_point_format(points.format(), 0))
        .transpose()
        .map_err(Error::other)?
        .map(LazVlrBuilder::build);
    let mut record = Vec::new();
    if let Some(compression) = &compression {
        compression.write_to(&mut record)?;
    }
    out.write_all(&points.header(&record))?;
    let blocks = (0..points.total()).step_by(BLOCK_POINTS);
    let mut rows = Vec::new();
    if let Some(compression) = compression {
        let mut packer = ParLasZipCompressor::new(out, compression).map_err(Error::other)?;
        packer.reserve_offset_to_chunk_table()?;
        for start in blocks {
            points.rows(start, &mut rows);
            packer.compress_many(&rows)?;
        }
        packer.done().map_err(Error::other)
    } else {
        for start in blocks {
            points.rows(start, &mut rows);
            out.write_all(&rows)?;
        }
        out.flush()
    }
}

/// The share of a coordinate that it is known to.
fn precision(positions: &Positions) -> f64 {
    match positions {
        Positions::F32(_) => f64::from(f32::EPSILON) / 2.0,
        Positions::F64(_) => 4.0 * f64::EPSILON,
    }
}

/// A cloud as the file will have it.
struct LasPoints<'a> {
    cloud: &'a RawCloud,
    axes: [Axis; 3],
    /// Corners as integers.
    bounds: [[i32; 2]; 3],
    count: u64,
    intensity: Option<(&'a ScalarField, f64)>,
    classification: Option<&'a ScalarField>,
    gps_time: Option<&'a ScalarField>,
}

impl<'a> LasPoints<'a> {
    fn new(cloud: &'a RawCloud) -> Self {
        let (count, bounds) = cloud.positions.finite_bounds();
        let (min, max) = bounds.unwrap_or_default();
        let precision = precision(&cloud.positions);
        let axes = std::array::from_fn(|axis| {
            let coordinates = (0..cloud.positions.len())
                .map(|index| cloud.positions.get(index))
                .filter(|position| position.is_finite())
                .map(move |position| position[axis]);
            Axis::new((min[axis], max[axis]), precision, &coordinates)
        });
        let field = |name: &str| {
            let is_named = |field: &&ScalarField| field.name.eq_ignore_ascii_case(name);
            cloud.attributes.scalars.iter().find(is_named)
        };
        Self {
            cloud,
            bounds: std::array::from_fn(|axis: usize| [min, max].map(|corner| Axis::raw(axes[axis], corner[axis]))),
            axes,
            count: count as u64,
            intensity: field("intensity").map(|field| (field, intensity_scale(field))),
            classification: field("classification"),
            gps_time: field("gps_time"),
        }
    }

    fn total(&self) -> usize {
        self.cloud.positions.len()
    }

    /// By how much coordinates are off, where that is more than they are known to; else 0.
    fn largest_error(&self) -> f64 {
        let precision = precision(&self.cloud.positions);
        let mut largest = 0.0f64;
        for index in 0..self.total() {
            let position = self.cloud.positions.get(index);
            if !position.is_finite() {
                continue;
            }
            for (axis, scaled) in self.axes.iter().enumerate() {
                let value = position[axis];
                let error = (scaled.value(scaled.raw(value)) - value).abs();
                if error > precision * value.abs() {
                    largest = largest.max(error);
                }
            }
        }
        largest
    }

    fn format(&self) -> u8 {
        if self.cloud.attributes.colors.is_some() { 7 } else { 6 }
    }

    fn point_bytes(&self) -> u16 {
        if self.cloud.attributes.colors.is_some() { 36 } else { 30 }
    }

    /// The header, and behind it the record of the compression if it is not empty.
    fn header(&self, record: &[u8]) -> Vec<u8> {
        /// The points have no map projection in the older form.
        const WELL_KNOWN_TEXT: u16 = 1 << 4;
        const COMPRESSED: u8 = 1 << 7;
        let has_record = !record.is_empty();
        let mut header = vec![0; HEADER_BYTES];
        let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
        let points_start = HEADER_BYTES + usize::from(has_record) * (RECORD_HEADER_BYTES + record.len());
        put(0, b"LASF");
        put(6, &WELL_KNOWN_TEXT.to_le_bytes());
        put(24, &[1, 4]);
        put(26, b"OTHER");
        put(58, b"pointreel");
        put(94, &(HEADER_BYTES as u16).to_le_bytes());
        put(96, &(points_start as u32).to_le_bytes());
        put(100, &u32::from(has_record).to_le_bytes());
        put(104, &[self.format() | if has_record { COMPRESSED } else { 0 }]);
        put(105, &self.point_bytes().to_le_bytes());
        for (axis, (scaled, [min, max])) in self.axes.iter().zip(self.bounds).enumerate() {
            put(131 + 8 * axis, &scaled.scale().to_le_bytes());
            put(155 + 8 * axis, &scaled.offset.to_le_bytes());
            put(179 + 16 * axis, &scaled.value(max).to_le_bytes());
            put(187 + 16 * axis, &scaled.value(min).to_le_bytes());
        }
        put(247, &self.count.to_le_bytes());
        // All are first returns.
        put(255, &self.count.to_le_bytes());
        if has_record {
            let mut head = [0; RECORD_HEADER_BYTES];
            let user = laz::LazVlr::USER_ID.as_bytes();
            head[2..2 + user.len()].copy_from_slice(user);
            head[18..20].copy_from_slice(&laz::LazVlr::RECORD_ID.to_le_bytes());
            head[20..22].copy_from_slice(&(record.len() as u16).to_le_bytes());
            header.extend(head);
            header.extend(record);
        }
        header
    }

    /// The points from `start` on that are finite, up to a block of them.
    fn rows(&self, start: usize, rows: &mut Vec<u8>) {
        /// The first of one return.
        const RETURNS: u8 = 1 | 1 << 4;
        rows.clear();
        for index in start..self.total().min(start + BLOCK_POINTS) {
            let position = self.cloud.positions.get(index);
            if !position.is_finite() {
                continue;
            }
            for (axis, scaled) in self.axes.iter().enumerate() {
                rows.extend(scaled.raw(position[axis]).to_le_bytes());
            }
            let number = |field: &ScalarField| f64::from(field.values[index]) + field.offset;
            let intensity = self.intensity.map_or(0.0, |(field, scale)| number(field) * scale);
            // A cast of what is no number or out of range gives the nearest one that is.
            rows.extend((intensity.round() as u16).to_le_bytes());
            let class = self.classification.map_or(0.0, number).round() as u8;
            rows.extend([RETURNS, 0, class, 0, 0, 0, 0, 0]);
            let time = self.gps_time.map_or(0.0, number);
            rows.extend(if time.is_finite() { time } else { 0.0 }.to_le_bytes());
            if let Some(colors) = &self.cloud.attributes.colors {
                /// From 8 bits to 16, both full.
                const WIDER: u16 = 257;
                for channel in &colors[index][..3] {
                    rows.extend((u16::from(*channel) * WIDER).to_le_bytes());
                }
            }
        }
    }
}

/// What makes 16 bits of an intensity: other programs have it from 0 to 1.
fn intensity_scale(field: &ScalarField) -> f64 {
    let numbers = field.values.iter().map(|&value| f64::from(value) + field.offset);
    let is_fraction = numbers.clone().any(|value| value.fract() != 0.0)
        && !numbers
            .clone()
            .any(|value| !(0.0..=1.0).contains(&value) && value.is_finite());
    if is_fraction { f64::from(u16::MAX) } else { 1.0 }
}
