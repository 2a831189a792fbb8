//! Clouds of arrays.

use super::super::splats::arrays::{self as splats, SplatArray};
use super::super::xyz;
use super::header::{Array, ArrayLayout, column_of};
use super::layers::{
    MAX_COLUMNS, NamedArray, assume_frames, layer_of, no_layer, numbered_frames, take_layer, unroll_images,
};
use super::looks::{refuse, shape_text, take_point_map};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{ImageGrid, RawCloud, ScalarField};
use crate::io::columns::column::Column;
use crate::io::columns::column_map::{ColumnMap, ColumnName, FRAME_ROLE};
use crate::io::columns::{attributes, growing};
use crate::io::contents::Part;
use crate::io::error::{Fault, Place};
use crate::io::options::ReadOptions;
use std::io::{Cursor, Read as _};

/// Names of arrays with coordinates.
const POSITIONS: [&str; 19] = [
    "xyz",
    "points",
    "point",
    "positions",
    "position",
    "pos",
    "vertices",
    "coords",
    "coordinates",
    "point_cloud",
    // From networks that predict a point per pixel.
    "world_points",
    "pts3d",
    "points3d",
    "pointmap",
    // From splats.
    "means3d",
    "means_3d",
    "mean3d",
    "means",
    "centers",
];
const COLORS: [&str; 7] = ["rgb", "rgba", "color", "colors", "colour", "colours", "rgb_colors"];
const NORMALS: [&str; 2] = ["normals", "normal"];

/// Max numbers of a field of records: more than the longest descriptors have.
const MAX_ENTRIES: usize = 2048;

/// Bytes that deflate makes of one at most.
pub(super) const MAX_DEFLATED: u64 = 1032;

pub(in crate::io) fn decode(bytes: &[u8], part: &Part, options: &ReadOptions) -> Result<RawCloud, Fault> {
    let array = Array::parse(bytes)?;
    refuse(&array, options.columns)?;
    let mut arrays = vec![(String::new(), array)];
    let image = unroll_images(&mut arrays, 0);
    let map = match image {
        Some(_) => None,
        None => take_point_map(&mut arrays, 0, options.columns),
    };
    let assumption = match part {
        Part::Layer(layer) => take_layer(&mut arrays, 0, *layer)?,
        _ => None,
    };
    let array = arrays.swap_remove(0).1.without_single_layers();
    let mut meaning = None;
    let (columns, count) = match &array.kind {
        ArrayLayout::Table(_) => table(&array, "x", options, &mut meaning)?,
        ArrayLayout::Records { .. } => {
            let count = array.shape.iter().product();
            (records(&array, count, options)?, count)
        }
    };
    let mut cloud = growing::cloud(&columns, count, options)?;
    match (image, assumption) {
        (Some([height, width]), Some(_)) => cloud.grid = grid_of(width, height, count),
        (_, assumption) => cloud.assumptions.extend(assumption),
    }
    if let Some(([height, width], assumption)) = map {
        cloud.grid = grid_of(width, height, count);
        cloud.assumptions.extend(assumption);
    }
    cloud.assumptions.extend(meaning);
    Ok(cloud)
}

/// The arrays of an archive that a cloud has a use for.
pub(in crate::io) fn decode_archive(bytes: &[u8], part: &Part, options: &ReadOptions) -> Result<RawCloud, Fault> {
    cloud_of_archive(&unpacked(bytes, options)?, layer_of(part), options)
}

/// The array with coordinates: one with a name used for them, or the only one.
pub(super) fn place_of_positions(arrays: &[NamedArray<'_>]) -> Option<usize> {
    let named = arrays.iter().position(|(name, _)| POSITIONS.contains(&name.as_str()));
    named.or((arrays.len() == 1).then_some(0))
}

/// Parses the arrays of `members`. Arrays of words and the like are skipped, unless they are to be the coordinates.
pub(super) fn parsed(members: &[(String, Vec<u8>)]) -> Result<Vec<NamedArray<'_>>, Fault> {
    let mut arrays = Vec::new();
    let mut first_fault = None;
    for (name, bytes) in members {
        let lower = name.to_ascii_lowercase();
        match Array::parse(bytes) {
            Ok(array) => arrays.push((lower, array)),
            Err(fault) => {
                let is_needed = POSITIONS.contains(&lower.as_str()) || fault.place != Place::Header;
                let fault = Fault::new(fault.place, format!("array `{name}`: {}", fault.problem));
                if is_needed {
                    return Err(fault);
                }
                first_fault.get_or_insert(fault);
            }
        }
    }
    match first_fault {
        Some(fault) if arrays.is_empty() => Err(fault),
        _ => Ok(arrays),
    }
}

pub(super) fn cloud_of_archive(
    members: &[(String, Vec<u8>)],
    layer: usize,
    options: &ReadOptions,
) -> Result<RawCloud, Fault> {
    let columns_given = options.columns;
    let options = &options.holding(members.iter().map(|(_, bytes)| bytes.len()).sum());
    let mut arrays = parsed(members)?;
    let shapes: Vec<String> = arrays
        .iter()
        .map(|(name, array)| format!("`{name}` ({})", shape_text(&array.shape)))
        .collect();
    let mut place = place_of_positions(&arrays);
    let mut assumption = None;
    let mut layer = layer;
    if place.is_none()
        && let Some(places) = numbered_frames(&arrays)
    {
        assumption = Some(assume_frames(&arrays, &places));
        let frame = places.get(layer).copied();
        let frame = frame.ok_or_else(|| no_layer(layer, places.len()))?;
        arrays = vec![arrays.swap_remove(frame)];
        (place, layer) = (Some(0), 0);
    }
    if let Some(place) = place {
        refuse(&arrays[place].1, columns_given)?;
    }
    let image = place.and_then(|place| unroll_images(&mut arrays, place));
    let map = place
        .filter(|_| image.is_none())
        .and_then(|place| take_point_map(&mut arrays, place, columns_given));
    let mut meaning = None;
    let mut arrays: Vec<NamedArray<'_>> = arrays
        .into_iter()
        .map(|(name, array)| (name, array.without_single_layers()))
        .collect();
    if let Some(place) = place {
        assumption = take_layer(&mut arrays, place, layer)?.or(assumption);
    }
    let (mut columns, count) = match place.map(|place| &arrays[place]) {
        Some((_, array)) => match &array.kind {
            ArrayLayout::Table(_) => table(array, "x", options, &mut meaning)?,
            ArrayLayout::Records { .. } => {
                let count = array.shape.iter().product();
                (records(array, count, options)?, count)
            }
        },
        // Separate arrays for x, y and z.
        None => (
            Vec::new(),
            arrays
                .iter()
                .find(|(name, _)| name == "x")
                .map_or(0, |(_, array)| array.shape.iter().product()),
        ),
    };
    let has_coordinates = place.is_some() || arrays.iter().any(|(name, _)| name == "x");
    if has_coordinates {
        options.claim_entries("the arrays", count, parsed_numbers(&arrays) * size_of::<f64>())?;
        add_columns_sidecar(&mut columns, &arrays, count)?;
    }
    if columns.is_empty() {
        return Err(Fault::header(format!(
            "missing coordinates: expected an array `xyz` or `points` (N × 3), found {}",
            if shapes.is_empty() {
                "no array".to_owned()
            } else {
                shapes.join(", ")
            }
        )));
    }
    let positions = place.map(|place| arrays[place].0.as_str());
    add_fields_sidecar(&mut columns, &arrays, positions, count, options);
    let mut cloud = growing::cloud(&columns, count, options)?;
    let splat_arrays = splat_arrays(&arrays, count);
    let used = splats::apply(&splat_arrays, &mut cloud);
    // Candidate splat arrays that are not used become ordinary fields.
    let unused = splat_arrays.iter().filter(|array| !used.contains(&array.name));
    for array in unused.filter(|array| !attributes::is_reserved(array.name)) {
        for column in &array.columns {
            let field = ScalarField::from_f64(column.name.as_str(), &column.to_f64(count));
            cloud.attributes.scalars.push(field);
        }
    }
    match image {
        Some([height, width]) => cloud.grid = grid_of(width, height, count),
        // With four dimensions it is known which of them are the image.
        None => cloud.assumptions.extend(assumption),
    }
    if let Some(([height, width], assumption)) = map {
        cloud.grid = grid_of(width, height, count);
        cloud.assumptions.extend(assumption);
    }
    cloud.assumptions.extend(meaning);
    Ok(cloud)
}

/// Adds columns from the `arrays` other than the coordinates that have values for each of `count` points.
fn add_columns_sidecar<'a>(
    columns: &mut Vec<Column<'a>>,
    arrays: &[NamedArray<'a>],
    count: usize,
) -> Result<(), Fault> {
    let is_one_of = |names: &[&str], name: &str| names.contains(&name);
    for (name, array) in arrays {
        let ArrayLayout::Table(_) = array.kind else { continue };
        let names: &[&str] = if is_one_of(&COLORS, name) {
            &["red", "green", "blue", "alpha"]
        } else if is_one_of(&NORMALS, name) {
            &["nx", "ny", "nz"]
        } else if array.shape.iter().product::<usize>() == count && attributes::is_reserved(name) {
            &[name.as_str()]
        } else {
            continue;
        };
        if array.shape.first() != Some(&count) && array.shape.iter().product::<usize>() != count {
            return Err(Fault::header(format!(
                "array `{name}` has {} entries, but there are {count} points",
                array.shape.first().unwrap_or(&0)
            )));
        }
        // A single row with all points, 1 × N, is one column.
        let width = match array.shape[..] {
            [rows, width] if rows == count => width,
            _ => 1,
        };
        for (column, name) in names.iter().enumerate().take(width) {
            columns.retain(|known| known.name != *name);
            columns.push(array.column((*name).to_owned(), column, width, count));
        }
    }
    Ok(())
}

/// Adds the arrays of numbers with an entry for each of `count` points that say nothing else: each of their columns is
/// a scalar field.
fn add_fields_sidecar<'a>(
    columns: &mut Vec<Column<'a>>,
    arrays: &[NamedArray<'a>],
    positions: Option<&str>,
    count: usize,
    options: &ReadOptions,
) {
    let is_known = |name: &str| {
        COLORS.contains(&name) || NORMALS.contains(&name) || attributes::is_reserved(name) || splats::is_used(name)
    };
    for (name, array) in arrays {
        if is_known(name) || positions == Some(name.as_str()) {
            continue;
        }
        match &array.kind {
            ArrayLayout::Table(_) => columns.extend(entries(name, array, count).unwrap_or_default()),
            ArrayLayout::Records { .. } if array.shape[..] == [count] => {
                columns.extend(records(array, count, options).unwrap_or_default());
            }
            ArrayLayout::Records { .. } => {}
        }
    }
}

/// The columns of a table with an entry for each of `count` points: `name`, or `name_0` and so on where they are
/// several. `None` where the array is of something else.
fn entries<'a>(name: &str, array: &Array<'a>, count: usize) -> Option<Vec<Column<'a>>> {
    let width = match array.shape[..] {
        [rows] if rows == count => 1,
        [1, rows] if rows == count => 1,
        [rows, width] if rows == count && width <= MAX_COLUMNS => width,
        _ => return None,
    };
    let named = |index: usize| match width {
        1 => name.to_owned(),
        _ => format!("{name}_{index}"),
    };
    Some(
        (0..width)
            .map(|index| array.column(named(index), index, width, count))
            .collect(),
    )
}

fn grid_of(width: usize, height: usize, count: usize) -> Option<ImageGrid> {
    ImageGrid::of(u32::try_from(width).ok()?, u32::try_from(height).ok()?, count)
}

/// The arrays that say something of splats, as columns.
fn splat_arrays<'a>(arrays: &'a [(String, Array<'a>)], count: usize) -> Vec<SplatArray<'a>> {
    let of_splats = arrays.iter().filter(|(name, array)| {
        let is_table = matches!(array.kind, ArrayLayout::Table(_));
        is_table && splats::is_used(name) && array.shape.first() == Some(&count) && array.shape.len() <= 2
    });
    let columns = |(name, array): &'a (String, Array<'a>)| SplatArray {
        name,
        columns: entries(name, array, count).unwrap_or_default(),
    };
    of_splats.map(columns).collect()
}

/// Names and bytes of the arrays in an archive, unpacked to no more than may be.
pub(super) fn unpacked(bytes: &[u8], options: &ReadOptions) -> Result<Vec<(String, Vec<u8>)>, Fault> {
    let damaged = |error: &dyn std::fmt::Display| Fault::header(format!("the archive is damaged ({error})"));
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut members = Vec::new();
    let mut left = options.left_bytes();
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(|error| damaged(&error))?;
        let name = member.name().map_err(|error| damaged(&error))?;
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
            continue;
        };
        if member.size() > left {
            return Err(Fault::too_large(&format!("array `{name}`"), member.size(), options));
        }
        // The size is a claim as well: it is believed up to the maximum expansion of the packed bytes, and it limits
        // the unpacked size.
        let claimed = member.size();
        let believed = claimed.min(member.compressed_size().saturating_mul(MAX_DEFLATED));
        let mut unpacked = Vec::new();
        crate::memory::try_reserve(&mut unpacked, believed as usize).map_err(|error| damaged(&error))?;
        member
            .take(claimed.saturating_add(1))
            .read_to_end(&mut unpacked)
            .map_err(|error| damaged(&error))?;
        if unpacked.len() as u64 > claimed {
            let problem = format!("array `{name}` unpacks to more than the {claimed} bytes that it claims");
            return Err(damaged(&problem));
        }
        left -= unpacked.len() as u64;
        members.push((name, unpacked));
    }
    Ok(members)
}

/// The columns of an array of numbers with one point per row, and their number. `meaning` describes the interpretation
/// of those after the coordinates.
fn table<'a>(
    array: &Array<'a>,
    first: &str,
    options: &ReadOptions,
    meaning: &mut Option<Assumption>,
) -> Result<(Vec<Column<'a>>, usize), Fault> {
    let map = options.columns;
    let shape = shape_text(&array.shape);
    let [count, width] = array.shape[..] else {
        let advice = match array.shape.len() {
            3 => {
                "save each of its frames as a file of its own or all of them in an NPZ, or an image of points as one \
                 table with `reshape(-1, 3)`"
            }
            _ => "save a table with a row for each point, x, y and z first",
        };
        return Err(Fault::header(format!(
            "the array is {shape}, expected two dimensions, N × 3 or more: {advice}"
        )));
    };
    if !(3..=MAX_COLUMNS).contains(&width) {
        let advice = if count == 3 {
            "; if its rows are the coordinates, save it transposed"
        } else {
            ""
        };
        return Err(Fault::header(format!(
            "the array is {shape}, expected a row for each point with 3 to {MAX_COLUMNS} numbers, {first}, y and z \
             first{advice}"
        )));
    }
    let numbers = parsed_numbers_of(array, width);
    options.claim_entries("the columns of the array", count, numbers * size_of::<f64>())?;
    let column = |index: usize| array.column(String::new(), index, width, count);
    // The columns after the coordinates are interpreted by the same rule as for text.
    let told_by: Vec<Vec<f64>> = (0..width)
        .map(|index| match width {
            5.. if (3..xyz::MAX_GUESSED_COLUMN).contains(&index) => column(index).to_f64(count),
            _ => Vec::new(),
        })
        .collect();
    let mut names = xyz::guessed_names(&told_by);
    if let Some(map) = map.filter(|map| map.roles().iter().any(|(role, _)| role != FRAME_ROLE)) {
        name_as_given(&mut names, map)?;
    } else if width > 3 {
        let values_tell = names.iter().any(|name| ["red", "nx"].contains(&name.as_str()));
        let (why, evidence) = if values_tell {
            (
                "the array does not name its columns, their values are like that",
                Evidence::Statistics,
            )
        } else {
            ("the array does not name its columns", Evidence::Fallback)
        };
        *meaning = Some(Assumption::new(Subject::Columns, names.join(" "), why, evidence));
    }
    let columns = names
        .into_iter()
        .enumerate()
        .map(|(index, name)| Column { name, ..column(index) });
    Ok((columns.collect(), count))
}

/// Gives columns the names chosen by the user.
fn name_as_given(names: &mut [String], map: ColumnMap) -> Result<(), Fault> {
    let roles = || map.roles().iter().filter(|(role, _)| role != FRAME_ROLE);
    let width = names.len();
    for (index, name) in names.iter_mut().enumerate() {
        if roles().any(|(role, _)| role == name) {
            *name = format!("value_{}", index + 1);
        }
    }
    for (role, column) in roles() {
        let index = match column {
            ColumnName::Index(index) if *index < width => *index,
            _ => {
                return Err(Fault::header(format!(
                    "column {column} of --columns does not exist: the array has {width} without names, counted from 0"
                )));
            }
        };
        names[index].clone_from(role);
    }
    Ok(())
}

/// Numbers of a row that are parsed: those that determine the meaning of columns, and half-precision ones.
fn parsed_numbers_of(array: &Array<'_>, width: usize) -> usize {
    let told_by = width.min(xyz::MAX_GUESSED_COLUMN).saturating_sub(3);
    let halves = matches!(array.kind, ArrayLayout::Table(number) if number.scalar.is_none());
    told_by + if halves { width } else { 0 }
}

/// Numbers of half precision of a point in all arrays.
fn parsed_numbers(arrays: &[NamedArray<'_>]) -> usize {
    let width = |array: &Array<'_>| array.shape.get(1).copied().unwrap_or(1).min(MAX_COLUMNS);
    let is_half = |array: &Array<'_>| matches!(array.kind, ArrayLayout::Table(number) if number.scalar.is_none());
    let halves = arrays.iter().filter(|(_, array)| is_half(array));
    halves.map(|(_, array)| width(array)).sum()
}

/// The columns of an array of records; fields that are short arrays themselves are several.
fn records<'a>(array: &Array<'a>, count: usize, options: &ReadOptions) -> Result<Vec<Column<'a>>, Fault> {
    let ArrayLayout::Records { fields, row_bytes } = &array.kind else {
        return Ok(Vec::new());
    };
    let mut columns = Vec::new();
    for field in fields {
        let Some(number) = field.number else {
            continue;
        };
        let lower = field.name.to_ascii_lowercase();
        let known: &[&str] = match lower.as_str() {
            _ if field.length == 1 => &[&field.name],
            name if POSITIONS.contains(&name) => &["x", "y", "z"],
            name if COLORS.contains(&name) => &["red", "green", "blue", "alpha"],
            name if NORMALS.contains(&name) => &["nx", "ny", "nz"],
            _ => &[],
        };
        let several = || (0..field.length.min(MAX_ENTRIES)).map(|index| format!("{}_{index}", field.name));
        let names: Vec<String> = if known.is_empty() {
            several().collect()
        } else {
            known.iter().take(field.length).map(|name| (*name).to_owned()).collect()
        };
        if number.scalar.is_none() {
            options.claim_entries("the field", count, names.len() * size_of::<f64>())?;
        }
        for (index, name) in names.into_iter().enumerate() {
            let start = field.offset + index * number.bytes();
            columns.push(column_of(number, name, array.payload, [start, *row_bytes], count));
        }
    }
    if columns.is_empty() && count > 0 {
        return Err(Fault::new(Place::Header, "no field of the records is a number"));
    }
    Ok(columns)
}
