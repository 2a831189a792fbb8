//! Bare little-endian f32 records: KITTI's `.bin` (x y z intensity) and nuScenes' `.pcd.bin` (x y z intensity ring).
//!
//! Nothing in such a file says what it is, so it must be plausible to be believed:
//!
//! 1. The name decides where it can: `.pcd.bin` is five numbers, as only nuScenes names its files so.
//! 2. Else widths are tried in the order of how common they are (4, 5, 3, 6), and the first one is taken of which the size is
//!    a multiple, all coordinates are plausible, and all further numbers are as well (below).
//! 3. A coordinate is plausible if it is finite, no more than a million away from the origin (sensors see some hundred metres,
//!    map projections some million), and is not tiny but for zero: other data read as floats is full of numbers like 1e-38.
//!    A record read at a wrong width puts intensities and rings where coordinates belong, which are plausible as such; but then
//!    it puts coordinates where intensities belong, which are never negative, and where rings belong, which are whole and below 256.

use super::attributes;
use super::column::{Column, Scalar, Values};
use super::error::{Fault, Place};
use crate::cloud::RawCloud;
use std::path::Path;

const FLOAT_BYTES: usize = 4;
/// Widths without a name that says it, the most common first.
const WIDTHS: [usize; 4] = [4, 5, 3, 6];
const NUSCENES_WIDTH: usize = 5;
/// The sixth number is of whoever wrote it (a time, an echo): no name is known for it.
const NAMES: [&str; 6] = ["x", "y", "z", "intensity", "ring", "unknown"];
const RING: usize = 4;
const INTENSITY: usize = 3;
const MOST_DISTANCE: f32 = 1e6;
/// A thousandth of a micrometre, if the unit is the metre.
const LEAST_DISTANCE: f32 = 1e-9;
/// Velodyne's intensities are 0 to 255, those of others up to 16 bits.
const MOST_INTENSITY: f32 = 65_535.0;
const MOST_RING: f32 = 255.0;

/// `name` tells the width where it is nuScenes'.
pub(super) fn decode(name: &Path, bytes: &[u8]) -> Result<RawCloud, Fault> {
    let is_nuscenes = name.file_name().is_some_and(|name| {
        name.to_string_lossy()
            .to_ascii_lowercase()
            .ends_with(".pcd.bin")
    });
    let widths = if is_nuscenes {
        &[NUSCENES_WIDTH][..]
    } else {
        &WIDTHS
    };
    let mut problem = None;
    for &width in widths {
        let step = width * FLOAT_BYTES;
        if !bytes.len().is_multiple_of(step) {
            continue;
        }
        match implausible(bytes, width) {
            None => {
                let columns: Vec<Column<'_>> = NAMES[..width]
                    .iter()
                    .enumerate()
                    .map(|(index, name)| Column {
                        name: (*name).to_owned(),
                        scalar: Scalar::F32,
                        values: Values::Packed {
                            bytes,
                            start: index * FLOAT_BYTES,
                            step,
                            big_endian: false,
                        },
                    })
                    .collect();
                return attributes::cloud(&columns, bytes.len() / step);
            }
            Some(found) => problem = problem.or(Some(found)),
        }
    }
    Err(problem.unwrap_or_else(|| {
        let expected: Vec<String> = widths.iter().map(|width| (width * FLOAT_BYTES).to_string()).collect();
        Fault::new(
            Place::Byte(bytes.len()),
            format!(
                "the file has {} bytes, which is no multiple of a record of {} bytes: it is truncated, or not of KITTI or nuScenes",
                bytes.len(),
                expected.join(" or ")
            ),
        )
    }))
}

/// The first record that is none of `width` numbers.
fn implausible(bytes: &[u8], width: usize) -> Option<Fault> {
    for (index, record) in bytes.chunks_exact(width * FLOAT_BYTES).enumerate() {
        let (numbers, _) = record.as_chunks::<FLOAT_BYTES>();
        for (column, raw) in numbers.iter().enumerate() {
            let value = f32::from_le_bytes(*raw);
            let is_plausible = match column {
                INTENSITY => (0.0..=MOST_INTENSITY).contains(&value),
                RING => value.fract() == 0.0 && (0.0..=MOST_RING).contains(&value),
                // NaN is within no range.
                0..INTENSITY => {
                    value == 0.0 || (LEAST_DISTANCE..MOST_DISTANCE).contains(&value.abs())
                }
                _ => value.is_finite(),
            };
            if !is_plausible {
                return Some(Fault::entry(
                    "point",
                    index,
                    format!(
                        "{value:e} is no {}: this is not a file of {width} floats a point (KITTI has 4, nuScenes 5)",
                        NAMES[column]
                    ),
                ));
            }
        }
    }
    None
}
