//! From records of points to a cloud: where each field lies in which format.

use super::extra::ExtraField;
use super::header::{LasHeader, take};
use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::io::arrays;
use crate::io::column::{Column, Scalar, Values};
use rayon::prelude::*;

/// Where the fields lie that not every format has at the same place.
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

    /// Bytes that a point takes in the cloud, and beside it while it is read.
    pub(super) fn cloud_bytes(self, extra: &[ExtraField]) -> usize {
        const SCALARS: usize = 4;
        let scalars =
            SCALARS + usize::from(self.gps_time.is_some()) + usize::from(self.near_infrared.is_some()) + extra.len();
        // One column at a time is also there with all its digits.
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
    let plain =
        |name: &str, scalar: Scalar, start: usize| ScalarField::new(name, column(name, scalar, start).to_f32(count));
    let bits = |name: &str, start: usize, shift: u8, mask: u8| {
        let values = rows
            .par_chunks_exact(step)
            .map(|row| f32::from(row[start] >> shift & mask));
        ScalarField::new(name, values.collect())
    };

    let (scale, offset) = (header.scale, header.offset);
    let positions = rows.par_chunks_exact(step).map(|row| {
        std::array::from_fn(|axis| f64::from(i32::from_le_bytes(take(row, 4 * axis))) * scale[axis] + offset[axis])
    });
    let mut cloud = RawCloud::from_positions(Positions::F64(positions.collect()));
    if let Some(start) = layout.colors {
        let channels = [0, 2, 4].map(|channel| column("color", Scalar::U16, start + channel));
        arrays::set_colors(&mut cloud, channels.each_ref(), None, count);
    }
    let scalars = &mut cloud.attributes.scalars;
    scalars.push(plain("intensity", Scalar::U16, 12));
    scalars.push(if layout.is_wide {
        plain("classification", Scalar::U8, 16)
    } else {
        bits("classification", 15, 0, 0x1f)
    });
    scalars.extend(layout.gps_time.map(|start| {
        let times = column("gps_time", Scalar::F64, start).to_f64(count);
        ScalarField::from_f64("gps_time", &times)
    }));
    let (width, mask) = if layout.is_wide { (4, 0xf) } else { (3, 0x7) };
    scalars.push(bits("return_number", 14, 0, mask));
    scalars.push(bits("number_of_returns", 14, width, mask));
    scalars.extend(layout.near_infrared.map(|start| plain("near_ir", Scalar::U16, start)));
    // Points have a place for these whether anybody filled it or not. Intensity stays: other readers give it in any
    // case.
    scalars.retain(|field| {
        field.name == "intensity" || field.offset != 0.0 || field.values.iter().any(|&value| value != 0.0)
    });
    for field in extra {
        let mut values = column(&field.name, field.scalar, field.start).to_f64(count);
        field.apply(&mut values);
        scalars.push(ScalarField::from_f64(&field.name, &values));
    }
    cloud
}
