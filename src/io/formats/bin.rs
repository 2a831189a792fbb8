//! Bare little-endian f32 records: KITTI's `.bin` (x y z intensity), nuScenes' `.pcd.bin` (x y z intensity ring),
//! radars of seven floats and more.
//!
//! Files of doubles are read as well, where single precision makes no sense and double precision does.
//!
//! Nothing in such a file identifies the format, so its contents must be plausible to be accepted, and the number of
//! values per point is estimated:
//!
//! 1. The name decides where it can: `.pcd.bin` is five numbers, as only nuScenes names its files so. A user may
//!    specify it    as well, with the columns that are coordinates (`--columns`).
//! 2. A width is possible if the size of the file is a multiple of it and all coordinates are plausible: finite, no
//!    more than a million away from the origin (sensors see some hundred metres, map projections some million), and not
//!    tiny but for zero: other data read as floats is full of numbers like 1e-38.
//! 3. Read at the right width a column holds numbers of one kind, which change little from one point to the next; at a
//!    wrong one it holds coordinates and intensities by turns. So the width is taken whose columns change least
//!    ([`roughness`]). Where that does not decide, it is the most common one. Multiples of the right width are as
//!    smooth, so the smallest of equals is taken, and rare widths have to be clearly smoother.

use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{AxisConvention, LengthUnit, RawCloud};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::column_map::{ColumnMap, ColumnName, FRAME_ROLE};
use crate::io::columns::growing;
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Traits};
use crate::io::options::ReadOptions;
use std::path::Path;

/// Bare f32 records of KITTI and nuScenes, in metres.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "KITTI",
    extensions: &["bin"],
    convention: Some(AxisConvention::UsuallyZUp),
    unit: Some(LengthUnit::Metre),
    has_time_sidecar: true,
    ..Traits::PLAIN
});

const FLOAT_BYTES: usize = 4;
/// Widths, the most common first.
const WIDTHS: [usize; 14] = [4, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16];
/// Widths that need no better evidence than others.
const COMMON_WIDTHS: usize = 4;
const NUSCENES_WIDTH: usize = 5;
const INTENSITY: usize = 3;
const RING: usize = 4;
const MAX_DISTANCE: f32 = 1e6;
/// A thousandth of a micrometre, if the unit is the metre.
const MIN_DISTANCE: f32 = 1e-9;
/// Velodyne's intensities are 0 to 255, others have up to 16 bits.
const MAX_INTENSITY: f32 = 65_535.0;
const MAX_RING: f32 = 255.0;
/// Minimum decrease of the logarithm of the roughness at which another width is chosen instead of a more common one.
const CLEARLY_SMOOTHER: f64 = 0.15;
/// A rare one.
const MUCH_SMOOTHER: f64 = 0.3;
/// Points that statistics are of, at most.
const MAX_SAMPLED: usize = 1 << 16;

/// `name` tells the width where it is nuScenes', `map` where a user does.
pub(in crate::io) fn decode(name: &Path, bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let map = options.columns;
    let is_nuscenes = name
        .file_name()
        .is_some_and(|name| name.to_string_lossy().to_ascii_lowercase().ends_with(".pcd.bin"));
    let given = map.and_then(ColumnMap::width);
    let (widths, why, evidence) = match given {
        Some(width) => (vec![width], "the first three are coordinates", Evidence::Convention),
        None if is_nuscenes => (vec![NUSCENES_WIDTH], "files named .pcd.bin are", Evidence::Convention),
        None => (
            WIDTHS.to_vec(),
            "with this number of values per point each column varies smoothly",
            Evidence::Statistics,
        ),
    };
    let roles = map.map_or(&[][..], ColumnMap::roles);
    let positions = positions(roles)?;
    let named = roles.iter().filter_map(|(_, column)| index_of(column).ok());
    let min = positions.into_iter().chain(named).max().unwrap_or(0) + 1;
    if let Some(width) = given.filter(|&width| width < min) {
        return Err(Fault::header(format!(
            "--columns names column {}, and says that there are {width}, counted from 0",
            min - 1
        )));
    }
    let estimated = estimate(bytes, &widths, positions, min);
    let singles = if matches!(estimated, Ok(Some(_))) {
        None
    } else {
        // Single-precision values, and the list that they are collected from.
        options.claim("the values of the file", bytes.len() as u64)?;
        singles_of_doubles(bytes)
    };
    let of_doubles = singles.as_ref().and_then(|singles| {
        let estimate = estimate(singles, &widths, positions, min).ok().flatten();
        // In noise, some width always seems possible.
        estimate.filter(|estimate| estimate.is_clear || given.is_some())
    });
    let (estimate, is_double) = match of_doubles {
        Some(estimate) => (estimate, true),
        None => match estimated? {
            Some(estimate) => (estimate, false),
            None => return Err(wrong_size(bytes.len(), given.is_some(), &widths)),
        },
    };
    if bytes.iter().all(|&byte| byte == 0) {
        return Err(Fault::header(
            "all bytes are zero: it contains no points, it was probably never written",
        ));
    }
    let (scalar, number_bytes) = if is_double {
        (Scalar::F64, 2 * FLOAT_BYTES)
    } else {
        (Scalar::F32, FLOAT_BYTES)
    };
    let width = estimate.width;
    let (why, evidence) = if estimate.is_clear || evidence != Evidence::Statistics {
        (why, evidence)
    } else {
        ("it is the most common width of those that fit", Evidence::Fallback)
    };
    let step = width * number_bytes;
    let names = names(singles.as_deref().filter(|_| is_double).unwrap_or(bytes), width, roles)?;
    let columns: Vec<Column<'_>> = names
        .iter()
        .enumerate()
        .map(|(index, name)| Column {
            name: name.clone(),
            scalar,
            values: Values::Packed {
                bytes,
                start: index * number_bytes,
                step,
                big_endian: false,
            },
        })
        .collect();
    let mut cloud = growing::cloud(&columns, bytes.len() / step, options)?;
    let kind = if is_double { "doubles" } else { "values" };
    let value = format!("{width} {kind} per point: {}", names.join(" "));
    let is_given = given.is_some() && roles.iter().any(|(role, _)| role == "x");
    if is_double {
        let why = "singles make no sense of it, doubles do";
        cloud
            .assumptions
            .push(Assumption::new(Subject::Columns, value, why, Evidence::Statistics));
    } else if !is_given {
        cloud
            .assumptions
            .push(Assumption::new(Subject::Columns, value, why, evidence));
    }
    Ok(cloud)
}

/// The numbers of a file of doubles as singles; `None` where some are none that a point has.
fn singles_of_doubles(bytes: &[u8]) -> Option<Vec<u8>> {
    const MAX_VALUE: f64 = 1e12;
    const MIN_VALUE: f64 = 1e-12;
    let (doubles, rest) = bytes.as_chunks();
    let single = |raw: &[u8; 2 * FLOAT_BYTES]| {
        let value = f64::from_le_bytes(*raw);
        let is_plausible = value == 0.0 || (MIN_VALUE..MAX_VALUE).contains(&value.abs());
        is_plausible.then(|| (value as f32).to_le_bytes())
    };
    if !rest.is_empty() {
        return None;
    }
    let singles: Vec<[u8; FLOAT_BYTES]> = doubles.iter().map(single).collect::<Option<_>>()?;
    Some(singles.concat())
}

/// The columns of the coordinates.
fn positions(roles: &[(String, ColumnName)]) -> Result<[usize; 3], Fault> {
    let mut positions = [0, 1, 2];
    let given = |axis: &str| roles.iter().find(|(role, _)| role == axis);
    let axes = ["x", "y", "z"];
    let is_given = axes.iter().any(|axis| given(axis).is_some());
    for (axis, position) in axes.into_iter().zip(&mut positions) {
        match given(axis) {
            Some((_, column)) => *position = index_of(column)?,
            None if is_given => {
                return Err(Fault::header(format!("--columns does not say which column is {axis}")));
            }
            None => {}
        }
    }
    Ok(positions)
}

fn index_of(column: &ColumnName) -> Result<usize, Fault> {
    match column {
        ColumnName::Index(index) => Ok(*index),
        ColumnName::Name(name) => Err(Fault::header(format!(
            "column `{name}` does not exist: the columns of a .bin file have no names, and are counted from 0"
        ))),
    }
}

/// The width of records, and whether their values speak for it.
struct Estimate {
    width: usize,
    is_clear: bool,
}

/// The width among `widths` that fits best; `None` where no width fits the size of the file, an error where its values
/// are implausible at all widths.
fn estimate(bytes: &[u8], widths: &[usize], positions: [usize; 3], min: usize) -> Result<Option<Estimate>, Fault> {
    let mut problem = None;
    let mut smooth: Vec<(usize, f64)> = Vec::new();
    for &width in widths.iter().filter(|&&width| width >= min) {
        if bytes.is_empty() || !bytes.len().is_multiple_of(width * FLOAT_BYTES) {
            continue;
        }
        match implausible(bytes, width, positions) {
            Some(found) => problem = problem.or(Some(found)),
            None => smooth.push((width, roughness(bytes, width))),
        }
    }
    let mut best: Option<(usize, f64)> = None;
    let mut is_clear = false;
    for (width, roughness) in smooth {
        let is_rare = WIDTHS
            .iter()
            .position(|known| *known == width)
            .is_some_and(|place| place >= COMMON_WIDTHS);
        let margin = if is_rare { MUCH_SMOOTHER } else { CLEARLY_SMOOTHER };
        match best {
            Some((_, min)) if roughness < min - margin => {
                best = Some((width, roughness));
                is_clear = true;
            }
            // A multiple of a width is just as smooth.
            Some((known, min)) => is_clear |= roughness > min + CLEARLY_SMOOTHER && width % known != 0,
            None => best = Some((width, roughness)),
        }
    }
    match (best, problem) {
        (Some((width, _)), _) => Ok(Some(Estimate { width, is_clear })),
        (None, Some(problem)) => Err(problem),
        (None, None) => Ok(None),
    }
}

fn wrong_size(byte_count: usize, is_given: bool, widths: &[usize]) -> Fault {
    let expected: Vec<String> = widths.iter().map(|width| (width * FLOAT_BYTES).to_string()).collect();
    let list = match expected.as_slice() {
        [first, .., last] => format!("{first} to {last}"),
        _ => expected.join(" or "),
    };
    let advice = if is_given {
        "--columns says another number than the file has"
    } else {
        "say how many values a point has with --columns N, if it is a list of points"
    };
    Fault::new(
        Place::Byte(byte_count),
        format!(
            "the file has {byte_count} bytes, which is not a multiple of a record of {list} bytes: it is truncated, \
             or {advice}"
        ),
    )
}

/// The numbers of each record, as bytes.
fn records(bytes: &[u8], width: usize) -> impl Iterator<Item = &[[u8; FLOAT_BYTES]]> {
    let (numbers, _) = bytes.as_chunks();
    numbers.chunks_exact(width)
}

/// The first record that speaks against the width: a coordinate or value that no sensor writes. Numbers of another kind
/// that are read as floats are tiny; a few tiny coordinates are rounding (0.1 % of the points, at least one).
fn implausible(bytes: &[u8], width: usize, positions: [usize; 3]) -> Option<Fault> {
    let mut tiny_left = (bytes.len() / (width * FLOAT_BYTES) / 1000).max(1);
    for (index, record) in records(bytes, width).enumerate() {
        let mut is_tiny = false;
        for (column, raw) in record.iter().enumerate() {
            let value = f32::from_le_bytes(*raw);
            let axis = positions.iter().position(|position| *position == column);
            // NaN is outside every range.
            let is_possible = value.is_finite() && (axis.is_none() || value.abs() < MAX_DISTANCE);
            is_tiny |= axis.is_some() && value != 0.0 && value.abs() < MIN_DISTANCE;
            if !is_possible || (is_tiny && tiny_left == 0) {
                let place = axis.map_or("value of a point", |axis| ["x", "y", "z"][axis]);
                return Some(Fault::entry(
                    "point",
                    index,
                    format!(
                        "{value:e} is not {place}: this is not a file of {width} floats per point (--columns N or \
                         --columns N:x=0,y=1,z=2 says another layout)"
                    ),
                ));
            }
        }
        tiny_left -= usize::from(is_tiny);
    }
    None
}

/// Returns the roughness of the columns from one point to the next: the mean over them of the logarithm of the mean
/// step. Numbers of another kind in between make steps as large as the cloud. Infinite where there is no next point,
/// which is no evidence for a width.
fn roughness(bytes: &[u8], width: usize) -> f64 {
    let mut steps = vec![0.0f64; width];
    let (mut sizes, mut count) = (0.0, 0.0);
    let sampled = || records(bytes, width).take(MAX_SAMPLED);
    for (before, now) in sampled().zip(sampled().skip(1)) {
        for (step, (before, now)) in steps.iter_mut().zip(before.iter().zip(now)) {
            let [before, now] = [*before, *now].map(|raw| f64::from(f32::from_le_bytes(raw)));
            *step += (now - before).abs();
            sizes += now.abs() / width as f64;
        }
        count += 1.0;
    }
    if count == 0.0 {
        return f64::INFINITY;
    }
    // A constant column counts as smooth as one that changes by a ten thousandth.
    let min = 1e-4 * sizes + f64::MIN_POSITIVE;
    let logarithms = steps.iter().map(|step| step.max(min).ln());
    logarithms.sum::<f64>() / width as f64 - f64::ln(count)
}

/// Names by the user, and by all that is known: intensities are never negative, and rings are whole numbers.
fn names(bytes: &[u8], width: usize, roles: &[(String, ColumnName)]) -> Result<Vec<String>, Fault> {
    let mut names: Vec<String> = (1..=width).map(|column| format!("value_{column}")).collect();
    let roles: Vec<&(String, ColumnName)> = roles.iter().filter(|(role, _)| role != FRAME_ROLE).collect();
    if roles.iter().any(|(role, _)| role == "x") {
        for (role, column) in roles {
            names[index_of(column)?].clone_from(role);
        }
        return Ok(names);
    }
    for (name, axis) in names.iter_mut().zip(["x", "y", "z"]) {
        axis.clone_into(name);
    }
    let all = |column: usize, is_one: fn(f32) -> bool| {
        width > column && records(bytes, width).all(|record| is_one(f32::from_le_bytes(record[column])))
    };
    if all(INTENSITY, |value| (0.0..=MAX_INTENSITY).contains(&value)) {
        "intensity".clone_into(&mut names[INTENSITY]);
        if all(RING, |value| value.fract() == 0.0 && (0.0..=MAX_RING).contains(&value)) {
            "ring".clone_into(&mut names[RING]);
        }
    }
    for (role, column) in roles {
        let column = index_of(column)?;
        if let Some(name) = names.get_mut(column) {
            name.clone_from(role);
        }
    }
    Ok(names)
}
