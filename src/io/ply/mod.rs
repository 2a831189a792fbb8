//! PLY: a header of elements with typed properties, then their rows as text or binary.
//!
//! The header's lines are read by `ply-rs-bw`; of the payload only the columns of the `vertex` element are kept, all else
//! is stepped over without being stored.

mod ascii;
mod binary;
mod header;

use super::attributes;
use super::column::{Column, Values};
use super::error::Fault;
use crate::cloud::RawCloud;
use header::{Element, Header, Kind};
use ply_rs_bw::ply::Encoding;

/// The element whose rows are points.
const POINTS: &str = "vertex";

pub(super) fn decode(bytes: &[u8]) -> Result<RawCloud, Fault> {
    let header = Header::parse(bytes)?;
    let Some(position) = header
        .elements
        .iter()
        .position(|element| element.name == POINTS)
    else {
        return Err(Fault::header(
            "there is no element `vertex`: a point cloud keeps its points there",
        ));
    };
    let (before, after) = header.elements.split_at(position);
    let vertex = &after[0];
    let columns = match header.encoding {
        Encoding::Ascii => ascii::columns(bytes, &header, before, vertex)?,
        Encoding::BinaryLittleEndian | Encoding::BinaryBigEndian => {
            let big_endian = header.encoding == Encoding::BinaryBigEndian;
            binary::columns(&bytes[header.byte_size..], big_endian, before, vertex)?
        }
    };
    attributes::cloud(&columns, vertex.count)
}

/// Parsed columns of the properties that a cloud has a use for.
struct KeptColumns {
    columns: Vec<Column<'static>>,
    /// Column of each property.
    column_of: Vec<Option<usize>>,
}

impl KeptColumns {
    fn new(vertex: &Element) -> Self {
        let mut kept = Self {
            columns: Vec::new(),
            column_of: Vec::new(),
        };
        for property in &vertex.properties {
            let scalar = match property.kind {
                Kind::Scalar(scalar) if attributes::is_used(&property.name) => Some(scalar),
                _ => None,
            };
            kept.column_of.push(scalar.map(|_| kept.columns.len()));
            kept.columns.extend(scalar.map(|scalar| Column {
                name: property.name.clone(),
                scalar,
                values: Values::Parsed(Vec::with_capacity(vertex.count)),
            }));
        }
        kept
    }

    fn push(&mut self, property: usize, value: f64) {
        if let Some(column) = self.column_of[property]
            && let Values::Parsed(values) = &mut self.columns[column].values
        {
            values.push(value);
        }
    }
}
