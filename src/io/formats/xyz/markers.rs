//! Tables with several points per row: the markers of motion capture, a frame per row.

use super::frames::{Counter, Frame, Rows, guessed_seconds};
use super::parsed::Parsed;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::columns::column::{Column, Scalar, Values};
use std::time::Duration;

/// The points of all rows one after the other, with the number of their marker, and a frame per row.
pub(super) fn unrolled(parsed: &Parsed, assumptions: &mut Vec<Assumption>) -> (Vec<Column<'static>>, Vec<Frame>) {
    let markers = &parsed.naming.markers;
    let rows = parsed.rows.len();
    let axis = |axis: usize| -> Vec<f64> {
        let of_row = |row: usize| markers.iter().map(move |marker| parsed.rows.columns[marker[axis]][row]);
        (0..rows).flat_map(of_row).collect()
    };
    let numbers = (0..rows).flat_map(|_| 0..markers.len()).map(|marker| marker as f64);
    let column = |name: &str, values: Vec<f64>| Column {
        name: name.to_owned(),
        scalar: Scalar::F64,
        values: Values::Parsed(values),
    };
    let columns = vec![
        column("x", axis(0)),
        column("y", axis(1)),
        column("z", axis(2)),
        column("marker", numbers.collect()),
    ];
    let times = times(parsed);
    let frame = |row: usize| Frame {
        rows: Rows::Range(row * markers.len()..(row + 1) * markers.len()),
        name: format!("frame {}", row + 1),
        time: times.as_ref().map(|times| times[row]),
    };
    let is_one = parsed.naming.frame == Some(None);
    // A choice of the user is not an assumption.
    if parsed.naming.frame.is_none() {
        let why = format!("the header names x, y and z of {} points per row", markers.len());
        let value = format!("{rows}, a row each");
        let assumption = Assumption::new(Subject::Frames, value, why, Evidence::Convention);
        assumptions.push(assumption.with_option(Some("--columns")));
    }
    let frames = if rows > 1 && !is_one {
        (0..rows).map(frame).collect()
    } else {
        Vec::new()
    };
    (columns, frames)
}

/// The times of the rows, if a column has them and they grow.
fn times(parsed: &Parsed) -> Option<Vec<Duration>> {
    let timed = parsed
        .raw_names
        .iter()
        .position(|name| matches!(Counter::of(name), Some(Counter::Times(_))))?;
    let values = parsed.rows.columns.get(timed)?;
    let seconds = match Counter::of(&parsed.raw_names[timed]) {
        Some(Counter::Times(Some(seconds))) => seconds,
        _ => guessed_seconds(values).0,
    };
    let first = values.first().copied().unwrap_or(0.0).min(0.0);
    let time = |value: &f64| Duration::try_from_secs_f64((value - first) * seconds).ok();
    let times: Vec<Duration> = values.iter().map(time).collect::<Option<_>>()?;
    times.is_sorted_by(|one, next| one < next).then_some(times)
}
