//! Rows of numbers as text.
//!
//! A row is as many numbers as its element has properties, whatever line they are on: writers break lines as they like.
//! Only where a row has a non-number do lines decide: either the row is bad, or a line does not belong to any.

use super::faces::{FaceList, Faces};
use super::header::{Element, PlyHeader, Property, PropertyKind};
use super::retained_columns::{POINTS, RetainedColumns};
use crate::io::columns::column::Column;
use crate::io::columns::numbers::{Tokens, note_row, quoted, with_decimal_points};
use crate::io::error::{Fault, Place};
use crate::io::options::ReadOptions;
use crate::progress::Progress;

/// A file with more non-numeric rows is damaged.
const MAX_ODD_ROWS: usize = 16;

/// The columns of `vertex`, the triangles and the oddities of the file `bytes`, whose first elements are `elements`.
pub(super) fn read(
    bytes: &[u8],
    header: &PlyHeader,
    elements: &[Element],
    vertex: &Element,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<(Vec<Column<'static>>, Faces, Vec<String>), Fault> {
    let payload = &bytes[header.byte_size..];
    let mut warnings = Vec::new();
    let is_first = elements.first().is_some_and(|element| element.name == POINTS);
    let decimal = with_decimal_points(payload, vertex.properties.len(), vertex.count).filter(|_| is_first);
    if decimal.is_some() {
        warnings.push("numbers have decimal commas: they are read as decimal points".to_owned());
    }
    let options = &options.holding(decimal.as_ref().map_or(0, Vec::len));
    let payload = decimal.as_deref().unwrap_or(payload);
    let mut tokens = Tokens::new(payload, header.line_count + 1);
    let mut columns = None;
    let mut faces = Faces::new(vertex.count, options.holding(RetainedColumns::bytes(vertex)));
    for (place, element) in elements.iter().enumerate() {
        if element.name == POINTS {
            check_ascii_claim(element, payload)?;
            RetainedColumns::claim(element, options)?;
            let counts = header.elements[place + 1..].iter().map(|element| element.count);
            let rows_behind = counts.fold(0, usize::saturating_add);
            let read = vertices(&mut tokens, element, rows_behind, &mut warnings, progress)?;
            let retained = columns.insert(read);
            if retained.is_empty() {
                // None of these points are retained, so no cloud can be made of them.
                break;
            }
            continue;
        }
        let claim = check_ascii_claim(element, payload);
        let read = match claim {
            // Faces are read as far as present.
            Err(_) if FaceList::of(element).is_none() => claim,
            claim => others(&mut tokens, element, &mut faces, progress).map_err(|fault| fault.explained_by(claim)),
        };
        match read {
            Ok(()) => {}
            Err(fault) if columns.is_some() && !progress.is_cancelled() => {
                faces.stop(fault);
                break;
            }
            Err(fault) => return Err(fault),
        }
    }
    Ok((columns.unwrap_or_default(), faces, warnings))
}

/// Steps over the rows of an element that is not the points, and makes triangles of its faces if there are any.
fn others(tokens: &mut Tokens<'_>, element: &Element, faces: &mut Faces, progress: &Progress) -> Result<(), Fault> {
    // Empty rows take no time, however many are claimed.
    let rows = if element.properties.is_empty() {
        0
    } else {
        element.count
    };
    let list = FaceList::of(element);
    for row in 0..rows {
        note_row(row, rows, progress)?;
        for (index, property) in element.properties.iter().enumerate() {
            match list.filter(|list| list.property == index) {
                Some(list) => {
                    ascii_step(tokens, property, &element.name, row, |item| {
                        faces.push(list, element, row, item);
                    })?;
                    faces.end_list(list)?;
                }
                None => {
                    ascii_step(tokens, property, &element.name, row, |_| ())?;
                }
            }
        }
    }
    Ok(())
}

/// The columns of the points, followed by `rows_behind` rows of other elements. A non-numeric row is a missing point,
/// or a line outside of any row, depending on the number of lines after it.
fn vertices(
    tokens: &mut Tokens<'_>,
    vertex: &Element,
    rows_behind: usize,
    warnings: &mut Vec<String>,
    progress: &Progress,
) -> Result<Vec<Column<'static>>, Fault> {
    let mut retained = RetainedColumns::new(vertex);
    if retained.columns.is_empty() {
        return Ok(retained.columns);
    }
    let mut odd_rows = 0;
    let mut row = 0;
    while row < vertex.count {
        note_row(row, vertex.count, progress)?;
        let end = tokens.line();
        let Err(fault) = point(tokens, vertex, row, &mut retained) else {
            row += 1;
            continue;
        };
        let Place::Line(line) = fault.place else {
            return Err(fault);
        };
        odd_rows += 1;
        let is_own_line = row == 0 || line == end + 1;
        let needed = (vertex.count - row - 1).saturating_add(rows_behind);
        let lines = tokens.lines_behind();
        let are_too_many = odd_rows > MAX_ODD_ROWS.min(vertex.count - 1);
        if !is_own_line || are_too_many || !(needed..=needed.saturating_add(1)).contains(&lines) {
            return Err(fault);
        }
        let what = if lines == needed {
            retained.resize(row + 1);
            row += 1;
            "this point is missing"
        } else {
            retained.resize(row);
            "this line is skipped"
        };
        tokens.skip_line();
        warnings.push(format!("line {line}: {}: {what}", fault.problem));
    }
    note_row(vertex.count, vertex.count, progress)?;
    Ok(retained.columns)
}

/// Adds the numbers of a point.
fn point(tokens: &mut Tokens<'_>, vertex: &Element, row: usize, retained: &mut RetainedColumns) -> Result<(), Fault> {
    for (index, property) in vertex.properties.iter().enumerate() {
        if let Some(value) = ascii_step(tokens, property, POINTS, row, |_| ())? {
            retained.push(index, value);
        }
    }
    Ok(())
}

/// A number as text takes a digit and a separator.
fn check_ascii_claim(element: &Element, payload: &[u8]) -> Result<(), Fault> {
    const MIN_NUMBER_BYTES: usize = 2;
    // The last number need not be followed by anything.
    element.check_claim(element.properties.len() * MIN_NUMBER_BYTES, payload.len() + 1)
}

/// Steps over a property of a row, handing over each item if it is a list; returns the value if it is not.
fn ascii_step(
    tokens: &mut Tokens<'_>,
    property: &Property,
    list: &str,
    row: usize,
    mut item: impl FnMut(f64),
) -> Result<Option<f64>, Fault> {
    match property.kind {
        PropertyKind::Scalar(_) => ascii_number(tokens, property, list, row).map(Some),
        PropertyKind::List { .. } => {
            let length = ascii_number(tokens, property, list, row)?;
            if length < 0.0 || length.fract() != 0.0 {
                return Err(Fault::new(
                    Place::Line(tokens.line()),
                    format!("a list cannot have {length} items"),
                ));
            }
            let mut left = length;
            while left > 0.0 {
                item(ascii_number(tokens, property, list, row)?);
                left -= 1.0;
            }
            Ok(None)
        }
    }
}

fn ascii_number(tokens: &mut Tokens<'_>, property: &Property, list: &str, row: usize) -> Result<f64, Fault> {
    let Some(number) = tokens.next_number() else {
        return Err(Fault::entry(
            list,
            row,
            format!(
                "the file ends before property `{}`: it is truncated, or its header is wrong",
                property.name
            ),
        ));
    };
    number.map_err(|token| {
        Fault::new(
            Place::Line(tokens.line()),
            format!(
                "property `{}` of {list} {row} is {}, expected a number",
                property.name,
                quoted(token)
            ),
        )
    })
}
