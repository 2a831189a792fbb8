//! Rows of numbers as the machine has them, of either byte order.
//!
//! Rows without lists are of one length: their columns are left where they are, and nothing is copied. Others are
//! walked one by one.

use super::faces::{FaceList, Faces};
use super::header::{Element, PlyHeader, Property, PropertyKind};
use super::retained_columns::{POINTS, RetainedColumns};
use crate::io::columns::column::{Column, Scalar};
use crate::io::columns::fixed_rows::{FixedRows, RowField};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;

/// The columns of `vertex` and the triangles in `payload`, of whose elements the first are `elements`, and the number
/// of bytes behind these.
pub(super) fn read<'a>(
    payload: &'a [u8],
    big_endian: bool,
    elements: &[Element],
    vertex: &Element,
    options: &ReadOptions,
) -> Result<(Vec<Column<'a>>, Faces, usize), Fault> {
    let mut cursor = Cursor {
        bytes: payload,
        at: 0,
        big_endian,
    };
    let mut vertices = None;
    let retained = match rows(vertex, 0, big_endian) {
        Some(_) => 0,
        None => RetainedColumns::bytes(vertex),
    };
    let mut faces = Faces::new(vertex.count, options.holding(retained));
    let mut is_whole = true;
    for element in elements {
        if element.name == POINTS {
            vertices = Some(columns(&mut cursor, element, options)?);
            continue;
        }
        let read = match FaceList::of(element) {
            Some(list) => cursor.read_faces(element, list, &mut faces),
            None => cursor.skip(element),
        };
        match read {
            Ok(()) => {}
            Err(fault) if vertices.is_some() => {
                faces.stop(fault);
                is_whole = false;
                break;
            }
            Err(fault) => return Err(fault),
        }
    }
    let rest = if is_whole { cursor.rest().len() } else { 0 };
    Ok((vertices.unwrap_or_default(), faces, rest))
}

/// The columns of `vertex`, which begins at the cursor.
fn columns<'a>(cursor: &mut Cursor<'a>, vertex: &Element, options: &ReadOptions) -> Result<Vec<Column<'a>>, Fault> {
    let Some(rows) = rows(vertex, 0, cursor.big_endian) else {
        return walked_columns(cursor, vertex, options);
    };
    vertex.check_claim(rows.row_bytes, cursor.rest().len())?;
    let columns = rows.columns(cursor.rest());
    cursor.at += rows.count * rows.row_bytes;
    Ok(columns)
}

/// The rows of `vertex` if they are of one length, behind `start` bytes.
pub(super) fn rows(vertex: &Element, start: usize, big_endian: bool) -> Option<FixedRows> {
    let mut row_bytes = 0;
    let mut fields = Vec::with_capacity(vertex.properties.len());
    for property in &vertex.properties {
        let PropertyKind::Scalar(scalar) = property.kind else {
            return None;
        };
        fields.push(RowField {
            name: property.name.clone(),
            scalar,
            offset: row_bytes,
        });
        row_bytes += scalar.byte_size();
    }
    Some(FixedRows {
        start,
        row_bytes,
        count: vertex.count,
        big_endian,
        fields,
        is_all: false,
        sensor: None,
        convention: None,
        grid: None,
        dropped: Vec::new(),
    })
}

/// Returns the layout of the point rows in a file with this header, if all rows and all data before them are of fixed
/// length, and no faces follow.
pub(super) fn fixed_rows(header: &PlyHeader, big_endian: bool) -> Option<FixedRows> {
    let has_faces = |element: &Element| element.count > 0 && FaceList::of(element).is_some();
    if header.elements.iter().any(has_faces) {
        return None;
    }
    let mut start = header.byte_size;
    for element in &header.elements {
        if element.name == POINTS {
            let is_all = header.elements.last().is_some_and(|last| last.name == POINTS);
            return rows(element, start, big_endian).map(|rows| FixedRows { is_all, ..rows });
        }
        start = start.checked_add(element.count.checked_mul(element.fixed_row_bytes()?)?)?;
    }
    None
}

/// Points that own lists have rows of different lengths: they are walked one by one.
fn walked_columns<'a>(
    cursor: &mut Cursor<'a>,
    vertex: &Element,
    options: &ReadOptions,
) -> Result<Vec<Column<'a>>, Fault> {
    vertex.check_claim(vertex.min_row_bytes(), cursor.rest().len())?;
    RetainedColumns::claim(vertex, options)?;
    let mut retained = RetainedColumns::new(vertex);
    for row in 0..vertex.count {
        for (index, property) in vertex.properties.iter().enumerate() {
            if let Some(value) = cursor.step(property, POINTS, row)? {
                retained.push(index, value);
            }
        }
    }
    Ok(retained.columns)
}

/// A place in a binary payload.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at.min(self.bytes.len())..]
    }

    /// Steps over all rows of an element.
    fn skip(&mut self, element: &Element) -> Result<(), Fault> {
        if let Some(row_bytes) = element.fixed_row_bytes() {
            element.check_claim(row_bytes, self.rest().len())?;
            self.at += element.count * row_bytes;
            return Ok(());
        }
        element.check_claim(element.min_row_bytes(), self.rest().len())?;
        for row in 0..element.count {
            for property in &element.properties {
                self.step(property, &element.name, row)?;
            }
        }
        Ok(())
    }

    /// Steps over all rows of an element with faces, and makes triangles of them.
    fn read_faces(&mut self, element: &Element, list: FaceList, faces: &mut Faces) -> Result<(), Fault> {
        let claim = element.check_claim(element.min_row_bytes(), self.rest().len());
        let read = self.read_faces_to_end(element, list, faces);
        read.map_err(|fault| fault.explained_by(claim))
    }

    fn read_faces_to_end(&mut self, element: &Element, list: FaceList, faces: &mut Faces) -> Result<(), Fault> {
        for row in 0..element.count {
            for (index, property) in element.properties.iter().enumerate() {
                match property.kind {
                    PropertyKind::List { length, item } if index == list.property => {
                        let big_endian = self.big_endian;
                        let items = self.list(length, item, &element.name, row)?;
                        for bytes in items.chunks_exact(item.byte_size()) {
                            faces.push(list, element, row, item.read(bytes, big_endian));
                        }
                        faces.end_list(list)?;
                    }
                    _ => {
                        self.step(property, &element.name, row)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Steps over a property of a row; returns the value if it is not a list.
    fn step(&mut self, property: &Property, list: &str, row: usize) -> Result<Option<f64>, Fault> {
        match property.kind {
            PropertyKind::Scalar(scalar) => self.number(scalar, list, row).map(Some),
            PropertyKind::List { length, item } => self.list(length, item, list, row).map(|_| None),
        }
    }

    /// Steps over a list; the bytes of its items.
    fn list(&mut self, length: Scalar, item: Scalar, list: &str, row: usize) -> Result<&'a [u8], Fault> {
        let length = self.number(length, list, row)?;
        if length < 0.0 || length.fract() != 0.0 {
            return Err(Fault::entry(list, row, format!("a list cannot have {length} items")));
        }
        let items = (length as usize)
            .checked_mul(item.byte_size())
            .and_then(|bytes| self.rest().get(..bytes));
        let items = items.ok_or_else(|| {
            Fault::entry(
                list,
                row,
                format!("a list of {length} items goes beyond the end of the file"),
            )
        })?;
        self.at += items.len();
        Ok(items)
    }

    fn number(&mut self, scalar: Scalar, list: &str, row: usize) -> Result<f64, Fault> {
        let rest = self.rest();
        if rest.len() < scalar.byte_size() {
            return Err(Fault::entry(
                list,
                row,
                "the file ends here: it is truncated, or its header is wrong",
            ));
        }
        self.at += scalar.byte_size();
        Ok(scalar.read(rest, self.big_endian))
    }
}
