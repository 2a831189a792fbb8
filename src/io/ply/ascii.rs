//! Rows of numbers as text.
//!
//! A row is as many numbers as its element has properties, whatever line they are on: writers break lines as they like.

use super::super::column::Column;
use super::super::error::{Fault, Place};
use super::super::numbers::{Tokens, note_row, quoted};
use super::faces::{FaceList, Faces};
use super::header::{Element, PlyHeader, Property, PropertyKind};
use super::kept_columns::{KeptColumns, POINTS};
use crate::progress::Progress;

/// The columns of `vertex` and the triangles in the file `bytes`, of whose elements the first are `elements`.
pub(super) fn read(
    bytes: &[u8],
    (header, elements, vertex): (&PlyHeader, &[Element], &Element),
    progress: &Progress,
) -> Result<(Vec<Column<'static>>, Faces), Fault> {
    let payload = &bytes[header.byte_size..];
    let mut tokens = Tokens::new(payload, header.line_count + 1);
    let mut columns = None;
    let mut faces = Faces::new(vertex.count);
    for element in elements {
        if element.name == POINTS {
            check_ascii_claim(element, payload)?;
            let kept = columns.insert(vertices(&mut tokens, element, progress)?);
            if kept.is_empty() {
                // Nothing is kept of these points, so there is no cloud to be made of them.
                break;
            }
            continue;
        }
        let claim = check_ascii_claim(element, payload);
        let read = match claim {
            // The faces that are there are read.
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
    Ok((columns.unwrap_or_default(), faces))
}

/// Steps over the rows of an element that is not the points, and makes triangles of its faces if there are any.
fn others(tokens: &mut Tokens<'_>, element: &Element, faces: &mut Faces, progress: &Progress) -> Result<(), Fault> {
    // Rows of nothing take no time, however many are claimed.
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
                    faces.end_list(list);
                }
                None => {
                    ascii_step(tokens, property, &element.name, row, |_| ())?;
                }
            }
        }
    }
    Ok(())
}

fn vertices(tokens: &mut Tokens<'_>, vertex: &Element, progress: &Progress) -> Result<Vec<Column<'static>>, Fault> {
    let mut kept = KeptColumns::new(vertex);
    if kept.columns.is_empty() {
        return Ok(kept.columns);
    }
    for row in 0..vertex.count {
        note_row(row, vertex.count, progress)?;
        for (index, property) in vertex.properties.iter().enumerate() {
            if let Some(value) = ascii_step(tokens, property, POINTS, row, |_| ())? {
                kept.push(index, value);
            }
        }
    }
    note_row(vertex.count, vertex.count, progress)?;
    Ok(kept.columns)
}

/// A number as text takes a digit and what separates it from the next.
fn check_ascii_claim(element: &Element, payload: &[u8]) -> Result<(), Fault> {
    const LEAST_NUMBER_BYTES: usize = 2;
    // The last number need not be followed by anything.
    element.check_claim(element.properties.len() * LEAST_NUMBER_BYTES, payload.len() + 1)
}

/// Steps over a property of a row, of which each item is handed over if it is a list; the value, if it is none.
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
