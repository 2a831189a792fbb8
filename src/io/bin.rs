//! Bare little-endian f32 records: KITTI's `.bin` (x y z intensity) and nuScenes' `.pcd.bin` (x y z intensity ring).
//!
//! Nothing in such a file says what it is, so it must be plausible to be believed, and how many numbers a point has is
//! told by statistics:
//!
//! 1. The name decides where it can: `.pcd.bin` is five numbers, as only nuScenes names its files so. A person may say
//!    it as well.
//! 2. A width is possible if the size of the file is a multiple of it and all coordinates are plausible: finite, no
//!    more than a million away from the origin (sensors see some hundred metres, map projections some million), and not
//!    tiny but for zero: other data read as floats is full of numbers like 1e-38.
//! 3. Read at the right width a column holds numbers of one kind, which change little from a point to the next; at a
//!    wrong one it holds coordinates and intensities by turns. So the width is taken whose columns change least
//!    ([`roughness`]). Where that does not decide, it is the most common one.

use super::column::{Column, Scalar, Values};
use super::error::{Fault, Place};
use super::format::{Format, Traits};
use super::growing;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{AxisConvention, LengthUnit, RawCloud};
use std::path::Path;

/// Bare f32 records of KITTI and nuScenes, in metres.
pub(super) const FORMAT: Format = Format::new(&Traits {
    name: "KITTI",
    extensions: &["bin"],
    convention: Some(AxisConvention::UsuallyZUp),
    unit: Some(LengthUnit::Metre),
    has_times_beside: true,
    ..Traits::PLAIN
});

const FLOAT_BYTES: usize = 4;
/// Widths, the most common first.
const WIDTHS: [usize; 4] = [4, 3, 5, 6];
const NUSCENES_WIDTH: usize = 5;
const COORDINATES: usize = 3;
const INTENSITY: usize = 3;
const RING: usize = 4;
const MOST_DISTANCE: f32 = 1e6;
/// A thousandth of a micrometre, if the unit is the metre.
const LEAST_DISTANCE: f32 = 1e-9;
/// Velodyne's intensities are 0 to 255, those of others up to 16 bits.
const MOST_INTENSITY: f32 = 65_535.0;
const MOST_RING: f32 = 255.0;
/// Another width is believed in place of a more common one if the logarithm of its roughness is so much less.
const CLEARLY_SMOOTHER: f64 = 0.15;
/// Points that statistics are of, at most.
const MOST_SAMPLED: usize = 1 << 16;

/// `name` tells the width where it is nuScenes', `columns` where a person does.
pub(super) fn decode(name: &Path, bytes: &[u8], columns: Option<u8>) -> Result<RawCloud, Fault> {
    let is_nuscenes = name
        .file_name()
        .is_some_and(|name| name.to_string_lossy().to_ascii_lowercase().ends_with(".pcd.bin"));
    let (widths, told_by, evidence) = match columns {
        Some(columns) => (vec![usize::from(columns)], "as given", Evidence::File),
        None if is_nuscenes => (vec![NUSCENES_WIDTH], "files named .pcd.bin are", Evidence::Convention),
        None => (
            WIDTHS.to_vec(),
            "values change least from point to point",
            Evidence::Statistics,
        ),
    };
    let mut problem = None;
    let mut best: Option<(usize, f64)> = None;
    for &width in &widths {
        if width == 0 || !bytes.len().is_multiple_of(width * FLOAT_BYTES) {
            continue;
        }
        if let Some(found) = implausible(bytes, width) {
            problem = problem.or(Some(found));
            continue;
        }
        let roughness = roughness(bytes, width);
        if best.is_none_or(|(_, least)| roughness < least - CLEARLY_SMOOTHER) {
            best = Some((width, roughness));
        }
    }
    let Some((width, _)) = best else {
        return Err(problem.unwrap_or_else(|| wrong_size(bytes.len(), &widths)));
    };
    let step = width * FLOAT_BYTES;
    let names = names(bytes, width);
    let columns: Vec<Column<'_>> = names
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
    let mut cloud = growing::cloud(&columns, bytes.len() / step)?;
    cloud.assumptions.push(Assumption::new(
        Subject::Columns,
        format!("{width} values per point: {}", names.join(" ")),
        told_by,
        evidence,
    ));
    Ok(cloud)
}

fn wrong_size(byte_count: usize, widths: &[usize]) -> Fault {
    let expected: Vec<String> = widths.iter().map(|width| (width * FLOAT_BYTES).to_string()).collect();
    Fault::new(
        Place::Byte(byte_count),
        format!(
            "the file has {byte_count} bytes, which is no multiple of a record of {} bytes: it is truncated, or no \
             list of points",
            expected.join(" or ")
        ),
    )
}

/// The numbers of each record, as bytes.
fn records(bytes: &[u8], width: usize) -> impl Iterator<Item = &[[u8; FLOAT_BYTES]]> {
    let (numbers, _) = bytes.as_chunks();
    numbers.chunks_exact(width)
}

/// The first record whose coordinates are none.
fn implausible(bytes: &[u8], width: usize) -> Option<Fault> {
    for (index, record) in records(bytes, width).enumerate() {
        for (column, raw) in record.iter().enumerate() {
            let value = f32::from_le_bytes(*raw);
            // NaN is within no range.
            let is_plausible = if column < COORDINATES {
                value == 0.0 || (LEAST_DISTANCE..MOST_DISTANCE).contains(&value.abs())
            } else {
                value.is_finite()
            };
            if !is_plausible {
                let place = ["x", "y", "z"].get(column).unwrap_or(&"value of a point");
                return Some(Fault::entry(
                    "point",
                    index,
                    format!("{value:e} is no {place}: this is not a file of {width} floats a point"),
                ));
            }
        }
    }
    None
}

/// How much the columns change from a point to the next: the mean over them of the logarithm of the mean step. Numbers
/// of another kind in between make steps as large as the cloud.
fn roughness(bytes: &[u8], width: usize) -> f64 {
    let mut steps = vec![0.0f64; width];
    let (mut sizes, mut count) = (0.0, 0.0);
    let sampled = || records(bytes, width).take(MOST_SAMPLED);
    for (before, now) in sampled().zip(sampled().skip(1)) {
        for (step, (before, now)) in steps.iter_mut().zip(before.iter().zip(now)) {
            let [before, now] = [*before, *now].map(|raw| f64::from(f32::from_le_bytes(raw)));
            *step += (now - before).abs();
            sizes += now.abs() / width as f64;
        }
        count += 1.0;
    }
    // A column that never changes is as smooth as one that changes by a ten thousandth.
    let least = 1e-4 * sizes + f64::MIN_POSITIVE;
    let logarithms = steps.iter().map(|step| step.max(least).ln());
    logarithms.sum::<f64>() / width as f64 - f64::ln(f64::max(count, 1.0))
}

/// What the columns are by all that is known: intensities are never negative, and rings are whole numbers.
fn names(bytes: &[u8], width: usize) -> Vec<&'static str> {
    let mut names = vec!["x", "y", "z", "value_4", "value_5", "value_6"];
    names.truncate(width);
    let all = |column: usize, is_one: fn(f32) -> bool| {
        width > column && records(bytes, width).all(|record| is_one(f32::from_le_bytes(record[column])))
    };
    if all(INTENSITY, |value| (0.0..=MOST_INTENSITY).contains(&value)) {
        names[INTENSITY] = "intensity";
        if all(RING, |value| value.fract() == 0.0 && (0.0..=MOST_RING).contains(&value)) {
            names[RING] = "ring";
        }
    }
    names
}
