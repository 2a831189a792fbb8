//! From records of points to a cloud: where each field lies in which format.

use super::extra::ExtraField;
use super::header::{LasHeader, take};
use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::io::columns::arrays;
use crate::io::columns::column::{Column, Scalar, Values};
use rayon::prelude::*;
use std::collections::HashSet;

/// Byte offsets of the fields whose position depends on the point format.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Formats 6 to 10 have wider counts of returns and classes.
    is_wide: bool,
    gps_time: Option<usize>,
    colors: Option<usize>,
    near_infrared: Option<usize>,
}

impl Layout {
    pub(super) fn of(format: u8) -> Self {
        let (gps_time, colors, near_infrared) = match format {
            1 | 4 => (Some(20), None, None),
            2 => (None, Some(20), None),
            3 | 5 => (Some(20), Some(28), None),
            6 | 9 => (Some(22), None, None),
            7 => (Some(22), Some(30), None),
            8 | 10 => (Some(22), Some(30), Some(36)),
            _ => (None, None, None),
        };
        Self {
            is_wide: format >= 6,
            gps_time,
            colors,
            near_infrared,
        }
    }

    /// Returns the bytes that a point takes in the cloud, and in addition to it while it is read.
    pub(super) fn cloud_bytes(self, extra: &[ExtraField]) -> usize {
        let scalars = STANDARD.len() + usize::from(self.gps_time.is_some()) + extra.len();
        // One column at a time is held in double precision as well. Most files use only a few of the fields.
        size_of::<[f64; 3]>() + size_of::<[u8; 4]>() + scalars * size_of::<f32>() + size_of::<f64>()
    }
}

/// The cloud of the points in `rows`. Precondition: their length is a multiple of the bytes of a point.
pub(super) fn cloud(header: &LasHeader, extra: &[ExtraField], rows: &[u8]) -> RawCloud {
    let (step, count) = (header.point_bytes, rows.len() / header.point_bytes);
    let layout = Layout::of(header.format);
    let column = |name: &str, scalar: Scalar, start: usize| Column {
        name: name.to_owned(),
        scalar,
        values: Values::Packed {
            bytes: rows,
            start,
            step,
            big_endian: false,
        },
    };
    let (scale, offset) = (header.scale, header.offset);
    let positions = rows.par_chunks_exact(step).map(|row| {
        std::array::from_fn(|axis| f64::from(i32::from_le_bytes(take(row, 4 * axis))) * scale[axis] + offset[axis])
    });
    let mut cloud = RawCloud::from_positions(Positions::F64(positions.collect()));
    let limit = |axis: usize| [i32::MIN, i32::MAX].map(|integer| f64::from(integer) * scale[axis] + offset[axis]);
    cloud.integer_limits = Some(std::array::from_fn(limit));
    if let Some(start) = layout.colors {
        let channels = [0, 2, 4].map(|channel| column("color", Scalar::U16, start + channel));
        arrays::set_colors(&mut cloud, channels.each_ref(), None, count);
    }
    let used = used_bits(rows, step);
    let scalars = &mut cloud.attributes.scalars;
    for field in standard_fields(layout) {
        // Points have these fields whether anyone filled them or not. Intensity stays: other readers return it in any
        // case.
        if field.name == INTENSITY || field.is_in(&used) {
            scalars.push(field.decode(rows, step));
        }
        // After the fields that are better to colour by.
        if field.name == "classification" {
            let times = layout
                .gps_time
                .map(|start| column("gps_time", Scalar::F64, start).to_f64(count));
            let times = times.map(|times| ScalarField::from_f64("gps_time", &times));
            scalars.extend(times.filter(|field| field.offset != 0.0 || field.values.iter().any(|&time| time != 0.0)));
        }
    }
    let mut names: HashSet<String> = scalars.iter().map(|field| field.name.to_ascii_lowercase()).collect();
    for field in extra {
        let is_free = !field.name.is_empty() && names.insert(field.name.to_ascii_lowercase());
        let name = if is_free {
            field.name.clone()
        } else {
            format!("{} extra {}", field.name, field.number).trim().to_owned()
        };
        let column = column(&name, field.scalar, field.start);
        scalars.push(if field.is_plain() && !field.scalar.is_wide() {
            ScalarField::new(name, column.to_f32(count))
        } else {
            let mut values = column.to_f64(count);
            field.apply(&mut values);
            ScalarField::from_f64(name, &values)
        });
    }
    cloud
}

/// The fields that every point has a place for, by their names in the order in which they are offered, and their
/// factors.
const STANDARD: [&str; 14] = [
    INTENSITY,
    "classification",
    "return_number",
    "number_of_returns",
    "near_ir",
    "scan_angle",
    "user_data",
    "point_source_id",
    "scanner_channel",
    "scan_direction_flag",
    "edge_of_flight_line",
    "synthetic",
    "key_point",
    "withheld",
];
const OVERLAP: &str = "overlap";
const INTENSITY: &str = "intensity";

/// Degrees of a step of the scan angle from point format 6 on.
pub(super) const ANGLE_STEP: f32 = 0.006;

/// Bit layout of a standard field.
#[derive(Debug, Clone, Copy)]
enum FieldBits {
    U8(usize),
    I8(usize),
    U16(usize),
    I16(usize),
    /// A range of bits of a byte.
    Bits {
        byte: usize,
        shift: u8,
        bits: u8,
    },
}

/// A field that every point of a format has.
#[derive(Debug, Clone, Copy)]
struct StandardField {
    name: &'static str,
    place: FieldBits,
    factor: f32,
}

/// The standard fields of points of this layout, but for times and colours.
fn standard_fields(layout: Layout) -> Vec<StandardField> {
    let bits = |byte, shift, bits| Some(FieldBits::Bits { byte, shift, bits });
    let wide = |in_wide: Option<FieldBits>, in_narrow| if layout.is_wide { in_wide } else { in_narrow };
    let place = |name: &str| match name {
        INTENSITY => Some(FieldBits::U16(12)),
        "classification" => wide(Some(FieldBits::U8(16)), bits(15, 0, 5)),
        "return_number" => wide(bits(14, 0, 4), bits(14, 0, 3)),
        "number_of_returns" => wide(bits(14, 4, 4), bits(14, 3, 3)),
        "near_ir" => layout.near_infrared.map(FieldBits::U16),
        "scan_angle" => wide(Some(FieldBits::I16(18)), Some(FieldBits::I8(16))),
        "user_data" => Some(FieldBits::U8(17)),
        "point_source_id" => wide(Some(FieldBits::U16(20)), Some(FieldBits::U16(18))),
        "scanner_channel" => wide(bits(15, 4, 2), None),
        "scan_direction_flag" => wide(bits(15, 6, 1), bits(14, 6, 1)),
        "edge_of_flight_line" => wide(bits(15, 7, 1), bits(14, 7, 1)),
        "synthetic" => wide(bits(15, 0, 1), bits(15, 5, 1)),
        "key_point" => wide(bits(15, 1, 1), bits(15, 6, 1)),
        "withheld" => wide(bits(15, 2, 1), bits(15, 7, 1)),
        OVERLAP => wide(bits(15, 3, 1), None),
        _ => None,
    };
    let field = |name: &'static str| {
        let factor = if name == "scan_angle" && layout.is_wide {
            ANGLE_STEP
        } else {
            1.0
        };
        let place = place(name)?;
        Some(StandardField { name, place, factor })
    };
    STANDARD.into_iter().chain([OVERLAP]).filter_map(field).collect()
}

/// Bytes of a point with standard fields, in every format.
const STANDARD_BYTES: usize = 38;

/// The bits that are set in any of the points, as far as standard fields go.
fn used_bits(rows: &[u8], step: usize) -> [u8; STANDARD_BYTES] {
    let unite = |mut all: [u8; STANDARD_BYTES], row: &[u8]| {
        for (all, byte) in all.iter_mut().zip(row) {
            *all |= byte;
        }
        all
    };
    let points = rows.par_chunks_exact(step).with_min_len(POINTS_PER_TASK);
    points
        .fold(|| [0; STANDARD_BYTES], unite)
        .reduce(|| [0; STANDARD_BYTES], |all, others| unite(all, &others))
}

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 14;

impl StandardField {
    /// Returns true if a point with these bits has a non-zero value in the field.
    fn is_in(self, used: &[u8; STANDARD_BYTES]) -> bool {
        match self.place {
            FieldBits::U8(at) | FieldBits::I8(at) => used[at] != 0,
            FieldBits::U16(at) | FieldBits::I16(at) => used[at] != 0 || used[at + 1] != 0,
            FieldBits::Bits { byte, shift, bits } => used[byte] >> shift & ((1 << bits) - 1) != 0,
        }
    }

    fn decode(self, rows: &[u8], step: usize) -> ScalarField {
        let points = rows.par_chunks_exact(step).with_min_len(POINTS_PER_TASK);
        let factor = self.factor;
        let values = match self.place {
            FieldBits::U8(at) => points.map(|row| f32::from(row[at])).collect(),
            FieldBits::I8(at) => points.map(|row| f32::from(row[at] as i8)).collect(),
            FieldBits::U16(at) => points.map(|row| f32::from(u16::from_le_bytes(take(row, at)))).collect(),
            FieldBits::I16(at) => {
                let angle = |row: &[u8]| f32::from(i16::from_le_bytes(take(row, at))) * factor;
                points.map(angle).collect()
            }
            FieldBits::Bits { byte, shift, bits } => {
                let mask = (1u8 << bits) - 1;
                points.map(|row| f32::from(row[byte] >> shift & mask)).collect()
            }
        };
        ScalarField::new(self.name, values)
    }
}
