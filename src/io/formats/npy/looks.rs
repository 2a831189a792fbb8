//! Classification of an array by its shape, its type and its values: images, depths, voxels and poses are refused by
//! name, and a single image with one point per pixel (H × W × 3) is distinguished from T frames of N points.
//!
//! **How it works.** Neighbouring rows of an image of points are about as near to each other as neighbours in a row,
//! and a row is a thin strip of the scene. Neighbouring frames are the same points moved a little, or others, and each
//! of them is as large as the scene.

use super::header::{Array, ArrayLayout};
use super::layers::{MAX_COLUMNS, NamedArray};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::binary::Scalar;
use crate::io::columns::column_map::ColumnMap;
use crate::io::columns::likeness::{is_camera_matrix, is_grid, poses};
use crate::io::error::Fault;

/// Minimum pixels along each side of images and volumes.
const MIN_SIDE: usize = 8;

/// Number of examined rows and columns.
const SAMPLED_ROWS: usize = 32;
const SAMPLED_COLUMNS: usize = 64;

/// A bare sum of the shape, `48 × 64 × 3`.
pub(super) fn shape_text(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    sides.join(" × ")
}

/// Fails for an array that is not points. A user who names `columns` knows better if a table has rows of points.
pub(super) fn refuse(array: &Array<'_>, columns: Option<ColumnMap>) -> Result<(), Fault> {
    let ArrayLayout::Table(number) = array.kind else {
        return Ok(());
    };
    let shape = &array.shape;
    if shape.contains(&0) {
        return Ok(());
    }
    let is_byte = number.scalar == Some(Scalar::U8);
    let is_large = |sides: &[usize]| sides.iter().all(|&side| side >= MIN_SIDE);
    let fault = |what: &str, advice: &str| {
        Err(Fault::header(format!(
            "the array is {}: this is {what}, not a list of points. {advice}",
            shape_text(shape)
        )))
    };
    match shape[..] {
        [_, height, width, 3 | 4] if is_byte && is_large(&[height, width]) => fault(
            "a sequence of images of bytes (frames × height × width × colours)",
            "Save each as an image of a folder, with depth images or cameras next to them",
        ),
        [3, 3] if columns.is_none() && is_camera_matrix(&entries(array)) => fault(
            "the matrix of a camera",
            "Name the file with --intrinsics next to depth images",
        ),
        [height, width, 3 | 4] if is_byte && is_large(&[height, width]) => fault(
            "an image of bytes (height × width × colours)",
            "Depth images next to images of colours are read as a folder; an image alone has no depth",
        ),
        [_, 4 | 3, 4] if poses(&entries(array)).is_some() => fault(
            "a matrix per frame: poses",
            "Name the file with --poses next to the frames; positions alone are `poses[:, :3, 3]`",
        ),
        [a, b, c] if is_large(&[a, b, c]) && ((a == b && b == c) || (is_byte && holds_bits(array))) => fault(
            "a grid of voxels",
            "Save the coordinates of the occupied ones with `numpy.argwhere(grid > 0)`",
        ),
        [_, height, width] if columns.is_none() && is_large(&[height, width]) && is_image(array, &[1, 2]) => fault(
            "an image of values per layer, such as depths",
            "Save each layer as a file of a folder of depth images, with the camera next to it (--intrinsics), or \
             points as N × 3",
        ),
        [_, _] if columns.is_none() && poses(&entries(array)).is_some() => fault(
            "a pose per row",
            "Name the file with --poses next to the frames, or say which columns are coordinates (--columns \
             x=0,y=1,z=2)",
        ),
        [height, width] if columns.is_none() && is_large(&[height, width]) && is_image(array, &[0, 1]) => fault(
            "an image or a grid of values, such as depths",
            "Put depth images into a folder with the camera next to them (--intrinsics); if rows are points, say \
             which columns are coordinates (--columns x=0,y=1,z=2)",
        ),
        _ => Ok(()),
    }
}

/// The values of the first entries along the first dimension, column by column of the others.
fn entries(array: &Array<'_>) -> Vec<Vec<f64>> {
    const MAX_ROWS: usize = 1024;
    let rows = array.shape[0].min(MAX_ROWS);
    let inner = &array.shape[1..];
    let width: usize = inner.iter().product();
    if width > 2 * MAX_COLUMNS {
        return Vec::new();
    }
    let place = |row: usize, column: usize| match inner {
        [_, last] => vec![row, column / last, column % last],
        _ => vec![row, column],
    };
    let values = |column: usize| (0..rows).map(|row| array.at(&place(row, column))).collect();
    (0..width).map(values).collect()
}

fn holds_bits(array: &Array<'_>) -> bool {
    array.payload[..array.claimed_bytes().unwrap_or(0)]
        .iter()
        .all(|&byte| byte <= 1)
}

/// Returns true if the array is an image: the plane of two dimensions, the first of its kind, holds values of one kind,
/// or 16-bit integers.
fn is_image(array: &Array<'_>, plane: &[usize; 2]) -> bool {
    const MIN_WIDTH: usize = 16;
    const MAX_WIDTH: usize = 256;
    let ArrayLayout::Table(number) = array.kind else {
        return false;
    };
    let [rows, width] = plane.map(|dimension| array.shape[dimension]);
    if width < MIN_WIDTH {
        return false;
    }
    let value = |row: usize, column: usize| match plane {
        [0, _] => array.at(&[row, column]),
        _ => array.at(&[0, row, column]),
    };
    let column = |column: usize| (0..rows.min(MAX_WIDTH)).map(|row| value(row, column)).collect();
    let columns: Vec<Vec<f64>> = (0..width.min(MAX_WIDTH)).map(column).collect();
    number.scalar == Some(Scalar::U16) || is_grid(&columns)
}

/// Returns the interpretation that `--columns frame=…` specifies for an array of three dimensions: frames, or none.
fn given(columns: Option<ColumnMap>) -> Option<bool> {
    columns.and_then(ColumnMap::frame).map(|frame| frame.is_some())
}

/// Takes the array at `place` as a point map if it is one image of points, and returns its height and width, with the
/// assumption unless specified by the user: it becomes a table, together with the companion arrays that have values for
/// each pixel.
pub(super) fn take_point_map(
    arrays: &mut [NamedArray<'_>],
    place: usize,
    columns: Option<ColumnMap>,
) -> Option<([usize; 2], Option<Assumption>)> {
    let positions = &arrays[place].1;
    let &[height, width, _] = &positions.shape[..] else {
        return None;
    };
    let is_map = match given(columns) {
        Some(has_frames) => !has_frames && can_be_point_map(positions),
        None => can_be_point_map(positions) && is_point_map(positions),
    };
    if !is_map {
        return None;
    }
    for (_, array) in arrays {
        let is_table = matches!(array.kind, ArrayLayout::Table(_)) && !array.is_fortran;
        if is_table && array.shape.starts_with(&[height, width]) {
            array.shape.splice(0..2, [height * width]);
        }
    }
    let assumption = given(columns).is_none().then(|| {
        let value = format!("one: an image of {height} × {width} points");
        let why = "neighbouring rows are as near as neighbours in a row";
        Assumption::new(Subject::Frames, value, why, Evidence::Statistics).with_option(Some("--columns"))
    });
    Some(([height, width], assumption))
}

fn can_be_point_map(array: &Array<'_>) -> bool {
    /// Larger ones are not read to list the content of a file.
    const MAX_BYTES: usize = 1 << 30;
    let ArrayLayout::Table(_) = array.kind else {
        return false;
    };
    let &[height, width, columns] = &array.shape[..] else {
        return false;
    };
    let is_claimed = array
        .claimed_bytes()
        .is_some_and(|bytes| bytes <= array.payload.len().min(MAX_BYTES));
    is_claimed && !array.is_fortran && height > 1 && width > 1 && (3..=MAX_COLUMNS).contains(&columns)
}

fn is_point_map(array: &Array<'_>) -> bool {
    /// Maximum aspect ratio of one side to the other.
    const MAX_ASPECT: usize = 64;
    /// Maximum step as a fraction of the distance of points that are far away from each other in the array.
    const MAX_STEP: f64 = 0.25;
    /// Maximum ratio of the steps along rows and along columns.
    const MAX_RATIO: f64 = 16.0;
    /// Maximum thickness as a fraction of the extent of all.
    const MAX_THICKNESS: f64 = 0.35;
    let [height, width] = [array.shape[0], array.shape[1]];
    let is_image = height >= MIN_SIDE && width >= MIN_SIDE;
    if !is_image || height > MAX_ASPECT * width || width > MAX_ASPECT * height {
        return false;
    }
    let point = |row: usize, column: usize| {
        let point = [0, 1, 2].map(|axis| array.at(&[row, column, axis]));
        let is_known = point.iter().all(|value| value.is_finite()) && point != [0.0; 3];
        is_known.then_some(point)
    };
    let places = |count: usize, max: usize| {
        let taken = count.min(max);
        (0..taken).map(move |index| index * count / taken)
    };
    let (mut down, mut along, mut all) = (Vec::new(), Vec::new(), Vec::new());
    let mut strips: [Vec<f64>; 3] = Default::default();
    for row in places(height - 1, SAMPLED_ROWS) {
        let mut strip = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for column in places(width - 1, SAMPLED_COLUMNS) {
            let Some(here) = point(row, column) else { continue };
            down.extend(point(row + 1, column).map(|below| distance(here, below)));
            along.extend(point(row, column + 1).map(|next| distance(here, next)));
            all.push(here);
            for (range, value) in strip.iter_mut().zip(here) {
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
        for (strips, [low, high]) in strips.iter_mut().zip(strip) {
            strips.push(high - low);
        }
    }
    let far = all.len() * 5 / 8;
    let apart = (0..all.len()).map(|index| distance(all[index], all[(index + far) % all.len()]));
    let (Some(down), Some(along), Some(apart)) = (median(down), median(along), median(apart.collect())) else {
        return false;
    };
    let thickness = |(axis, strips): (usize, Vec<f64>)| {
        let values = || all.iter().map(|point| point[axis]);
        let extent = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        median(strips).filter(|_| extent > 0.0).map(|strip| strip / extent)
    };
    let thinnest = strips
        .into_iter()
        .enumerate()
        .filter_map(thickness)
        .fold(f64::INFINITY, f64::min);
    let are_near = down.max(along) <= MAX_STEP * apart && apart > 0.0;
    are_near && down <= MAX_RATIO * along && along <= MAX_RATIO * down && thinnest <= MAX_THICKNESS
}

fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    let squares = (0..3).map(|axis| (one[axis] - other[axis]).powi(2));
    squares.sum::<f64>().sqrt()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| value.is_finite());
    let center = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(center, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An array of singles in the order of C.
    fn bytes(shape: &str, values: impl Iterator<Item = f32>) -> Vec<u8> {
        let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(values.flat_map(f32::to_le_bytes));
        bytes
    }

    fn grid(rows: usize, columns: usize, point: impl Fn(usize, usize) -> [f32; 3]) -> Vec<u8> {
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let values = places.flat_map(|(row, column)| point(row, column));
        bytes(&format!("{rows}, {columns}, 3"), values)
    }

    #[test]
    fn point_maps_are_distinguished_from_frames() {
        let is_map = |bytes: &[u8]| {
            let array = Array::parse(bytes).unwrap();
            can_be_point_map(&array) && is_point_map(&array)
        };
        let depth = |row: usize, column: usize| 2.0 + 0.3 * (0.1 * (row + 2 * column) as f32).sin();
        let map = |row: usize, column: usize| {
            let depth = depth(row, column);
            [
                (column as f32 - 32.0) * 0.02 * depth,
                (row as f32 - 24.0) * 0.02 * depth,
                depth,
            ]
        };
        assert!(is_map(&grid(48, 64, map)));
        let noise = |index: usize| ((index * 7919) % 1009) as f32 / 1009.0;
        let cloud = |frame: usize, index: usize| {
            let place = [noise(index), noise(index + 300), noise(index + 700)];
            [place[0] + 0.01 * frame as f32, place[1], place[2]]
        };
        assert!(!is_map(&grid(40, 500, cloud)));
        let curve = |frame: usize, index: usize| {
            let angle = 0.04 * index as f32;
            [angle.cos() + 0.01 * frame as f32, angle.sin(), 0.05 * angle]
        };
        assert!(!is_map(&grid(40, 500, curve)));
    }

    #[test]
    fn other_arrays_are_rejected_by_name() {
        let problem = |bytes: &[u8]| {
            let refused = refuse(&Array::parse(bytes).unwrap(), None);
            refused.map_or_else(|fault| fault.problem, |()| String::new())
        };
        let noise = |index: usize| ((index * 7919) % 1009) as f32 / 1009.0;
        assert!(problem(&bytes("48, 64", (0..48 * 64).map(noise))).contains("image or a grid"));
        let pose = |frame: usize| {
            let (sine, cosine) = (0.1 * frame as f32).sin_cos();
            let moved = frame as f32;
            [
                cosine, -sine, 0.0, moved, sine, cosine, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ]
        };
        assert!(problem(&bytes("5, 4, 4", (0..5).flat_map(pose))).contains("poses"));
        assert!(problem(&bytes("8, 8, 8", (0..512).map(noise))).contains("voxels"));
        for points in [bytes("9, 3", (0..27).map(noise)), bytes("4, 5, 4", (0..80).map(noise))] {
            assert_eq!(problem(&points), "");
        }
    }
}
