//! A table of numpy: all columns have one type and no names.
//!
//! That is enough for a colour, a normal, both, or a scalar called `scalar` alone or before a colour: their number
//! determines their meaning (see the reader of text). Where there are more, a field has a name, or the values would
//! suggest another meaning (normals that are all upright look like a dark colour), rows are records with the names of
//! their fields.

use super::columns::{CHUNK_BYTES, Colors, Type, WrittenColumn, columns};
use super::encoder::{Encoder, Held, WriteSeek};
use crate::cloud::RawCloud;
use crate::io::formats::xyz;

const HOLDS: &[Held] = &[Held::Normals, Held::Alpha, Held::Radii, Held::Scalars, Held::Holes];

/// Encoder of numpy files: a bare table if its columns can be identified by their number, otherwise records.
pub(in crate::io) const ENCODER: &Encoder = &Encoder {
    name: "npy",
    extension: "npy",
    holds: HOLDS,
    lost: |_| Vec::new(),
    write: |out, cloud| write(out, cloud),
};

fn write(out: &mut dyn WriteSeek, cloud: &RawCloud) -> std::io::Result<()> {
    let columns = columns(cloud, Colors::Untyped, ["nx", "ny", "nz"], str::to_owned);
    let rows = cloud.positions.len();
    let (columns, is_table) = match told_by_number(columns) {
        Ok(columns) => {
            let is_table = are_told(&columns, rows);
            (columns, is_table)
        }
        Err(columns) => (columns, false),
    };
    let is_double = columns.iter().any(|column| column.kind() == Type::F64);
    let (kind, bytes) = if is_double { ("<f8", 8) } else { ("<f4", 4) };
    let layout = if is_table {
        let width = columns.len();
        format!("'descr': '{kind}', 'fortran_order': False, 'shape': ({rows}, {width})")
    } else {
        let fields: Vec<String> = columns
            .iter()
            .map(|column| format!("('{}', '{kind}')", quoted(&column.name)))
            .collect();
        let fields = fields.join(", ");
        format!("'descr': [{fields}], 'fortran_order': False, 'shape': ({rows},)")
    };
    out.write_all(&header(&layout))?;
    let mut chunk = Vec::new();
    for row in 0..rows {
        for column in &columns {
            let value = column.value(row);
            if bytes == 8 {
                chunk.extend(value.to_le_bytes());
            } else {
                chunk.extend((value as f32).to_le_bytes());
            }
        }
        if chunk.len() >= CHUNK_BYTES {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    out.write_all(&chunk)
}

/// The columns in the order of a table that their number tells, the scalar first; `None` where there are others.
fn told_by_number(columns: Vec<WrittenColumn<'_>>) -> Result<Vec<WrittenColumn<'_>>, Vec<WrittenColumn<'_>>> {
    let is_scalar = |column: &WrittenColumn<'_>| column.name == SCALAR;
    let has_normals = columns.iter().any(|column| column.name == VECTORS[6]);
    let known =
        |column: &WrittenColumn<'_>| VECTORS.contains(&column.name.as_str()) || is_scalar(column) && !has_normals;
    if !columns.iter().all(known) {
        return Err(columns);
    }
    let mut columns = columns;
    if let Some(place) = columns.iter().position(is_scalar) {
        let scalar = columns.remove(place);
        columns.insert(3, scalar);
    }
    Ok(columns)
}

/// The name of the column that a table may have without a name.
const SCALAR: &str = "scalar";

/// Returns true if readers that know nothing but the values interpret each column correctly.
fn are_told(columns: &[WrittenColumn<'_>], rows: usize) -> bool {
    // Fewer columns are identified by their number, these by the first ones after the coordinates.
    let values = columns.iter().enumerate().map(|(index, column)| {
        let is_looked_at = columns.len() >= 5 && (3..xyz::MAX_GUESSED_COLUMN).contains(&index);
        let rows = if is_looked_at { rows } else { 0 };
        (0..rows).map(|row| column.value(row)).collect()
    });
    let guessed = xyz::guessed_names(&values.collect::<Vec<Vec<f64>>>());
    let is_vector = |name: &str| VECTORS.contains(&name);
    columns
        .iter()
        .zip(&guessed)
        .all(|(column, guessed)| column.name == *guessed || !is_vector(&column.name) && !is_vector(guessed))
}

/// Columns that are components of something.
const VECTORS: [&str; 9] = ["x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"];

/// A name as a string of Python holds it.
fn quoted(name: &str) -> String {
    name.replace('\\', "\\\\").replace('\'', "\\'")
}

/// Padded so that the numbers begin at a multiple of 64 bytes.
fn header(layout: &str) -> Vec<u8> {
    /// Offset of the header text in version 1 of the format. Later versions begin with two bytes more, and their
    /// numbers at two bytes past such a multiple.
    const START: usize = 10;
    const ALIGNMENT: usize = 64;
    let mut text = format!("{{{layout}, }}");
    let end = (START + text.len() + 1).next_multiple_of(ALIGNMENT);
    text.extend(std::iter::repeat_n(' ', end - START - text.len() - 1));
    text.push('\n');
    // Many fields need a longer header than version 1 allows, and non-ASCII names the encoding of version 3.
    let mut header = match u16::try_from(text.len()) {
        Ok(length) if text.is_ascii() => [&b"\x93NUMPY\x01\x00"[..], &length.to_le_bytes()].concat(),
        _ => {
            let version = if text.is_ascii() { 2 } else { 3 };
            [&b"\x93NUMPY"[..], &[version, 0], &(text.len() as u32).to_le_bytes()].concat()
        }
    };
    header.extend(text.bytes());
    header
}
