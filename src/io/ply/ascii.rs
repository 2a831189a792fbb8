//! Rows of numbers as text.
//!
//! A row is as many numbers as its element has properties, whatever line they are on: writers break lines as they like.

use super::super::column::Column;
use super::super::error::{Fault, Place};
use super::super::numbers::{Tokens, quoted};
use super::header::{Element, Header, Kind, Property};
use super::{KeptColumns, POINTS};

/// The columns of `vertex` in the file `bytes`, where the elements of `before` come first.
pub(super) fn columns(
    bytes: &[u8],
    header: &Header,
    before: &[Element],
    vertex: &Element,
) -> Result<Vec<Column<'static>>, Fault> {
    let payload = &bytes[header.byte_size..];
    let mut tokens = Tokens::new(payload, header.line_count + 1);
    for element in before {
        check_ascii_claim(element, payload)?;
        // Rows of nothing take no time, however many are claimed.
        let rows = if element.properties.is_empty() {
            0
        } else {
            element.count
        };
        for row in 0..rows {
            for property in &element.properties {
                ascii_step(&mut tokens, property, &element.name, row)?;
            }
        }
    }
    check_ascii_claim(vertex, payload)?;
    let mut kept = KeptColumns::new(vertex);
    if kept.columns.is_empty() {
        // Nothing is kept of these points, so there is no cloud to be made of them.
        return Ok(kept.columns);
    }
    for row in 0..vertex.count {
        for (index, property) in vertex.properties.iter().enumerate() {
            if let Some(value) = ascii_step(&mut tokens, property, POINTS, row)? {
                kept.push(index, value);
            }
        }
    }
    Ok(kept.columns)
}

/// A number as text takes a digit and what separates it from the next.
fn check_ascii_claim(element: &Element, payload: &[u8]) -> Result<(), Fault> {
    const LEAST_NUMBER_BYTES: usize = 2;
    // The last number need not be followed by anything.
    element.check_claim(
        element.properties.len() * LEAST_NUMBER_BYTES,
        payload.len() + 1,
    )
}

fn ascii_step(
    tokens: &mut Tokens<'_>,
    property: &Property,
    list: &str,
    row: usize,
) -> Result<Option<f64>, Fault> {
    match property.kind {
        Kind::Scalar(_) => ascii_number(tokens, property, list, row).map(Some),
        Kind::List { .. } => {
            let length = ascii_number(tokens, property, list, row)?;
            if length < 0.0 || length.fract() != 0.0 {
                return Err(Fault::new(
                    Place::Line(tokens.line()),
                    format!("a list cannot have {length} items"),
                ));
            }
            let mut left = length;
            while left > 0.0 {
                ascii_number(tokens, property, list, row)?;
                left -= 1.0;
            }
            Ok(None)
        }
    }
}

fn ascii_number(
    tokens: &mut Tokens<'_>,
    property: &Property,
    list: &str,
    row: usize,
) -> Result<f64, Fault> {
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
