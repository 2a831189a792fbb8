//! A table of numpy: all columns are of one type, and nothing names them.
//!
//! So only those are written that their number tells (see the reader of text): a colour, a normal, both, or a scalar
//! alone or before a colour. Alpha, radii and further scalars are left out. Where the values would tell something else
//! (normals that are all upright look like a dark colour), rows are records with the names of their fields.

use super::super::xyz;
use super::columns::{CHUNK_BYTES, Colors, Type, WrittenColumn, columns};
use super::encoder::{Encoder, Held, WriteSeek};
use super::loss::Loss;
use crate::cloud::RawCloud;

const HOLDS: &[Held] = &[Held::Normals, Held::Alpha, Held::Radii, Held::Scalars, Held::Holes];

/// A bare table of numpy: positions, with colours and normals, or with one scalar.
pub(in crate::io) const ENCODER: &Encoder = &Encoder {
    name: "npy",
    extension: "npy",
    holds: HOLDS,
    lost,
    write: |out, cloud| write(out, cloud),
};

fn write(out: &mut dyn WriteSeek, cloud: &RawCloud) -> std::io::Result<()> {
    let columns = columns(cloud, Colors::Untyped, ["nx", "ny", "nz"], str::to_owned);
    let columns = told_by_number(columns, cloud);
    let is_double = columns.iter().any(|column| column.kind() == Type::F64);
    let (kind, bytes) = if is_double { ("<f8", 8) } else { ("<f4", 4) };
    let rows = cloud.positions.len();
    let layout = if are_told(&columns, rows) {
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

/// The columns that are not told by their number.
fn lost(cloud: &RawCloud) -> Vec<(Loss, f64)> {
    let all = columns(cloud, Colors::Untyped, ["nx", "ny", "nz"], str::to_owned);
    let names: Vec<String> = all.iter().map(|column| column.name.clone()).collect();
    let kept = told_by_number(all, cloud);
    let is_kept = |name: &String| kept.iter().any(|column| column.name == *name);
    let lost = names.into_iter().filter(|name| !is_kept(name));
    lost.map(|name| (Loss::Field(format!("`{name}`")), 0.0)).collect()
}

fn told_by_number<'a>(columns: Vec<WrittenColumn<'a>>, cloud: &RawCloud) -> Vec<WrittenColumn<'a>> {
    let (has_colors, has_normals) = (cloud.attributes.colors.is_some(), cloud.attributes.normals.is_some());
    let scalar = match cloud.attributes.scalars.first() {
        Some(_) if !has_normals => Some(columns.len() - cloud.attributes.scalars.len()),
        _ => None,
    };
    let wanted = |name: &str| match name {
        "x" | "y" | "z" => true,
        "red" | "green" | "blue" => has_colors,
        "nx" | "ny" | "nz" => has_normals,
        _ => false,
    };
    let (mut kept, mut behind) = (Vec::new(), Vec::new());
    for (index, column) in columns.into_iter().enumerate() {
        if scalar == Some(index) {
            kept.insert(3, column);
        } else if index < 3 {
            kept.push(column);
        } else if wanted(&column.name) {
            behind.push(column);
        }
    }
    kept.extend(behind);
    kept
}

/// Whether readers that know nothing but the values take each column for what it is.
fn are_told(columns: &[WrittenColumn<'_>], rows: usize) -> bool {
    // Fewer columns are told by their number, and these by the first behind the coordinates.
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
    const START: usize = 10;
    const ALIGNMENT: usize = 64;
    let mut text = format!("{{{layout}, }}");
    let end = (START + text.len() + 1).next_multiple_of(ALIGNMENT);
    text.extend(std::iter::repeat_n(' ', end - START - text.len() - 1));
    text.push('\n');
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((text.len() as u16).to_le_bytes());
    header.extend(text.bytes());
    header
}
