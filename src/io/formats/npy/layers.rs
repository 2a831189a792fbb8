//! Sequences in one array: T × N × 3, one layer per frame, or T × H × W × 3, one image of points per frame.
//!
//! A single image of points, H × W × 3, has the same shape as the first: they are distinguished by its values
//! ([`super::looks`]). An array with one layer is one frame.

use super::header::{Array, ArrayLayout};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::contents::Part;
use crate::io::error::Fault;

/// An array and its name, in lower case.
pub(super) type NamedArray<'a> = (String, Array<'a>);

/// Maximum number of columns at which an array is recognised as a table by its column count.
pub(super) const MAX_COLUMNS: usize = 64;

/// The number of the layer that a part of a file is.
pub(in crate::io) fn layer_of(part: &Part) -> usize {
    match part {
        Part::Layer(layer) => *layer,
        _ => 0,
    }
}

/// Reshapes images of points, T × H × W × 3 at `place`, into layers T × H·W × 3, together with the companion arrays
/// that have values for each of their points. Returns height and width of these images; `None` if there are none.
pub(super) fn unroll_images(arrays: &mut [NamedArray<'_>], place: usize) -> Option<[usize; 2]> {
    let positions = &arrays[place].1;
    let (ArrayLayout::Table(_), &[frames, height, width, columns]) = (&positions.kind, &positions.shape[..]) else {
        return None;
    };
    let points = height.checked_mul(width)?;
    if positions.is_fortran || !(3..=MAX_COLUMNS).contains(&columns) {
        return None;
    }
    for (_, array) in arrays {
        let is_table = matches!(array.kind, ArrayLayout::Table(_)) && !array.is_fortran;
        if is_table && array.shape.starts_with(&[frames, height, width]) {
            array.shape.splice(1..3, [points]);
        }
    }
    Some([height, width])
}

/// Returns the number of frames (layers) of an array; `None` if it is one frame.
pub(super) fn layer_count(array: &Array<'_>) -> Option<usize> {
    let (ArrayLayout::Table(_), &[layers, points, width]) = (&array.kind, &array.shape[..]) else {
        return None;
    };
    let is_sequence = layers > 1 && points > 0 && (3..=MAX_COLUMNS).contains(&width);
    is_sequence.then_some(layers)
}

/// Places of arrays that are frames, in the order of their numbers: all arrays are, their names differ in the numbers
/// alone, and they are tables of the same type and width. So `numpy.savez(file, *frames)` names them `arr_0`, `arr_1`,
/// ….
pub(super) fn numbered_frames(arrays: &[NamedArray<'_>]) -> Option<Vec<usize>> {
    let number = |name: &str| -> Option<(String, u64)> {
        let text = name.trim_end_matches(|c: char| c.is_ascii_digit());
        Some((text.to_owned(), name[text.len()..].parse().ok()?))
    };
    let numbers: Option<Vec<(String, u64)>> = arrays.iter().map(|(name, _)| number(name)).collect();
    let numbers = numbers.filter(|numbers| numbers.len() > 1)?;
    let of_type = |array: &Array<'_>| match (&array.kind, &array.shape[..]) {
        (ArrayLayout::Table(number), &[_, width]) if (3..=MAX_COLUMNS).contains(&width) => {
            Some((number.bytes(), number.scalar, width))
        }
        _ => None,
    };
    let first = of_type(&arrays[0].1)?;
    let is_alike = arrays.iter().all(|(_, array)| of_type(array) == Some(first));
    if !is_alike || numbers.iter().any(|(text, _)| *text != numbers[0].0) {
        return None;
    }
    let mut places: Vec<usize> = (0..arrays.len()).collect();
    places.sort_by_key(|&place| numbers[place].1);
    Some(places)
}

/// Says that the arrays at `places` are frames.
pub(super) fn assume_frames(arrays: &[NamedArray<'_>], places: &[usize]) -> Assumption {
    let [first, last] =
        [places.first(), places.last()].map(|place| place.map_or("", |&place| arrays[place].0.as_str()));
    Assumption::new(
        Subject::Frames,
        format!("{} arrays, {first} to {last}", places.len()),
        "the arrays have numbered names, one type and one width",
        Evidence::Statistics,
    )
    .with_option(None)
}

/// Takes one layer of each array with one per frame and the entry count of the positions at `place`; returns the number
/// of layers, and that they are frames. `None` if the positions have no layers.
pub(super) fn take_layer(
    arrays: &mut [NamedArray<'_>],
    place: usize,
    layer: usize,
) -> Result<Option<Assumption>, Fault> {
    let positions = &arrays[place].1;
    let Some(frames) = layer_count(positions) else {
        return if layer == 0 { Ok(None) } else { Err(no_layer(layer, 1)) };
    };
    if layer >= frames {
        return Err(no_layer(layer, frames));
    }
    let points = positions.shape[1];
    let assumption = Assumption::new(
        Subject::Frames,
        format!("{frames} frames of {points} points"),
        "the array of positions has three dimensions",
        Evidence::Convention,
    )
    .with_option(Some("--columns"));
    for (_, array) in arrays {
        let is_table = matches!(array.kind, ArrayLayout::Table(_));
        if is_table && array.shape.starts_with(&[frames, points]) {
            array.take_layer(layer);
        }
    }
    Ok(Some(assumption))
}

pub(super) fn no_layer(layer: usize, frames: usize) -> Fault {
    Fault::header(format!(
        "layer {layer} does not exist, only {frames} counted from 0: the file has changed since it was opened"
    ))
}
