//! Writing LAS 1.4 with point format 6, or 7 with colours, compressed (LAZ) or not. Scalar fields without a place in
//! the format, or whose numbers do not fit it, are extra bytes under their own names.
//!
//! Coordinates are integers in the file. Each axis gets the coarsest decimal scale, a thousandth or finer, at which no
//! coordinate loses a digit that it has: files that came from integers go back to the same ones and compress well, and
//! single precision is retained to its last bit. Where no scale does that, it is the finest at which the extent fits 32
//! bits.

use super::write_fields::{self, ExtraBytes, StandardFields};
use crate::cloud::{Positions, RawCloud};
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
    /// Minimum number of decimal digits: a thousandth.
    const MIN_DIGITS: i32 = 3;
    /// More than coordinates of double precision have.
    const MAX_DIGITS: i32 = 15;

    /// The scale for `coordinates` from `min` to `max`, each with the relative error `precision`.
    fn new(min: f64, max: f64, precision: f64, coordinates: &(impl Iterator<Item = f64> + Clone)) -> Self {
        let mut digits = Self::MIN_DIGITS;
        while Self::fitting(digits, min, max).is_none() && digits > -300 {
            digits -= 1;
        }
        let mut axis = Self::fitting(digits, min, max).unwrap_or(Self {
            digits,
            offset: min / 2.0 + max / 2.0,
        });
        while axis.digits < Self::MAX_DIGITS
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

    /// The axis with this many digits if the extent fits it: without an offset if possible, else with one between the
    /// two.
    fn fitting(digits: i32, min: f64, max: f64) -> Option<Self> {
        let center = (min / 2.0 + max / 2.0).round();
        [0.0, center]
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

/// Fields beyond those that can be described, values that do not fit their field, and coordinates that do not fit 32
/// bits.
fn lost(cloud: &RawCloud) -> Vec<(Loss, f64)> {
    let mut lost = write_fields::lost(&cloud.attributes.scalars);
    let error = LasPoints::new(cloud).largest_error();
    if error > 0.0 {
        lost.push((Loss::Precision, error));
    }
    lost
}

/// Writes the finite points of `cloud`, with colours and all scalar fields.
pub(super) fn write(out: &mut dyn WriteSeek, cloud: &RawCloud, compressed: bool) -> Result<()> {
    let points = LasPoints::new(cloud);
    let compression = compressed
        .then(|| LazVlrBuilder::default().with_point_format(points.format(), points.extra.point_bytes()))
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
    fields: StandardFields<'a>,
    extra: ExtraBytes<'a>,
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
            Axis::new(min[axis], max[axis], precision, &coordinates)
        });
        let fields = StandardFields::of(&cloud.attributes.scalars);
        Self {
            cloud,
            bounds: std::array::from_fn(|axis: usize| [min, max].map(|corner| Axis::raw(axes[axis], corner[axis]))),
            axes,
            count: count as u64,
            extra: ExtraBytes::of(&cloud.attributes.scalars, &fields),
            fields,
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
        let standard = if self.cloud.attributes.colors.is_some() { 36 } else { 30 };
        standard + self.extra.point_bytes()
    }

    /// The header, and behind it the record of the compression if it is not empty.
    fn header(&self, record: &[u8]) -> Vec<u8> {
        /// The points have no map projection in the older form.
        const WELL_KNOWN_TEXT: u16 = 1 << 4;
        const COMPRESSED: u8 = 1 << 7;
        let is_compressed = !record.is_empty();
        let mut records = Vec::new();
        if is_compressed {
            put_record(&mut records, laz::LazVlr::USER_ID, laz::LazVlr::RECORD_ID, record);
        }
        let descriptions = self.extra.descriptions();
        if !descriptions.is_empty() {
            put_record(&mut records, "LASF_Spec", EXTRA_BYTES_RECORD, &descriptions);
        }
        let mut header = vec![0; HEADER_BYTES];
        let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
        let record_count = u32::from(is_compressed) + u32::from(!descriptions.is_empty());
        let points_start = HEADER_BYTES + records.len();
        put(0, b"LASF");
        put(6, &WELL_KNOWN_TEXT.to_le_bytes());
        put(24, &[1, 4]);
        put(26, b"OTHER");
        put(58, b"pointreel");
        put(94, &(HEADER_BYTES as u16).to_le_bytes());
        put(96, &(points_start as u32).to_le_bytes());
        put(100, &record_count.to_le_bytes());
        put(104, &[self.format() | if is_compressed { COMPRESSED } else { 0 }]);
        put(105, &self.point_bytes().to_le_bytes());
        for (axis, (scaled, [min, max])) in self.axes.iter().zip(self.bounds).enumerate() {
            put(131 + 8 * axis, &scaled.scale().to_le_bytes());
            put(155 + 8 * axis, &scaled.offset.to_le_bytes());
            put(179 + 16 * axis, &scaled.value(max).to_le_bytes());
            put(187 + 16 * axis, &scaled.value(min).to_le_bytes());
        }
        put(247, &self.count.to_le_bytes());
        for (place, count) in self.fields.return_counts(self.total(), self.count).iter().enumerate() {
            put(255 + 8 * place, &count.to_le_bytes());
        }
        header.extend(records);
        header
    }

    /// The points from `start` on that are finite, up to a block of them.
    fn rows(&self, start: usize, rows: &mut Vec<u8>) {
        rows.clear();
        for index in start..self.total().min(start + BLOCK_POINTS) {
            let position = self.cloud.positions.get(index);
            if !position.is_finite() {
                continue;
            }
            for (axis, scaled) in self.axes.iter().enumerate() {
                rows.extend(scaled.raw(position[axis]).to_le_bytes());
            }
            self.fields.put(index, rows);
            if let Some(colors) = &self.cloud.attributes.colors {
                /// From 8 bits to 16, both full.
                const WIDER: u16 = 257;
                for channel in &colors[index][..3] {
                    rows.extend((u16::from(*channel) * WIDER).to_le_bytes());
                }
            }
            self.extra.put(index, rows);
        }
    }
}

/// Number of the standard record that describes extra bytes.
const EXTRA_BYTES_RECORD: u16 = 4;

/// Appends a record with its header. Precondition: its data are at most 65,535 bytes.
fn put_record(records: &mut Vec<u8>, user: &str, id: u16, data: &[u8]) {
    let mut head = [0; RECORD_HEADER_BYTES];
    head[2..2 + user.len()].copy_from_slice(user.as_bytes());
    head[18..20].copy_from_slice(&id.to_le_bytes());
    head[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
    records.extend(head);
    records.extend(data);
}
