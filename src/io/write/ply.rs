//! PLY, binary and as text.

use super::columns::{CHUNK_BYTES, Colors, Type, WrittenColumn, columns, plain_name, renamed};
use super::encoder::{Encoder, Held, WriteSeek};
use crate::cloud::RawCloud;

const HOLDS: &[Held] = &[
    Held::Normals,
    Held::Alpha,
    Held::Radii,
    Held::Scalars,
    Held::Faces,
    Held::Holes,
];

/// PLY, little endian: holds all but ellipses and where the sensor stood.
pub(in crate::io) const BINARY: &Encoder = &Encoder {
    name: "ply",
    extension: "ply",
    holds: HOLDS,
    lost: |cloud| renamed(cloud, Colors::Typed, ["nx", "ny", "nz"], name),
    write: |out, cloud| write(out, cloud, false),
};

/// PLY as text: the same.
pub(in crate::io) const ASCII: &Encoder = &Encoder {
    name: "ply-ascii",
    extension: "ply",
    holds: HOLDS,
    lost: |cloud| renamed(cloud, Colors::Typed, ["nx", "ny", "nz"], name),
    write: |out, cloud| write(out, cloud, true),
};

fn write(out: &mut dyn WriteSeek, cloud: &RawCloud, is_text: bool) -> std::io::Result<()> {
    let columns = columns(cloud, Colors::Typed, ["nx", "ny", "nz"], name);
    header(out, cloud, &columns, is_text)?;
    if is_text {
        text(out, cloud, &columns)
    } else {
        binary(out, cloud, &columns)
    }
}

/// Names of properties are letters, digits and underscores, a letter first.
fn name(name: &str) -> String {
    let plain = plain_name(name, |sign| sign.is_ascii_alphanumeric() || sign == '_' || sign == '-');
    if plain.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') {
        plain
    } else {
        format!("_{plain}")
    }
}

fn header(
    out: &mut dyn WriteSeek,
    cloud: &RawCloud,
    columns: &[WrittenColumn<'_>],
    is_text: bool,
) -> std::io::Result<()> {
    let encoding = if is_text { "ascii" } else { "binary_little_endian" };
    writeln!(out, "ply\nformat {encoding} 1.0\ncomment written by pointreel")?;
    writeln!(out, "element vertex {}", cloud.positions.len())?;
    for column in columns {
        let kind = match column.kind() {
            Type::U8 => "uchar",
            Type::F32 => "float",
            Type::F64 => "double",
        };
        writeln!(out, "property {kind} {}", column.name)?;
    }
    if !cloud.faces.is_empty() {
        writeln!(out, "element face {}", cloud.faces.len())?;
        writeln!(out, "property list uchar {} vertex_indices", index_type(cloud))?;
    }
    writeln!(out, "end_header")
}

/// Most readers expect `int`; more points than that has need the sign.
fn index_type(cloud: &RawCloud) -> &'static str {
    if i32::try_from(cloud.positions.len()).is_ok() {
        "int"
    } else {
        "uint"
    }
}

fn binary(out: &mut dyn WriteSeek, cloud: &RawCloud, columns: &[WrittenColumn<'_>]) -> std::io::Result<()> {
    let mut bytes = Vec::new();
    for row in 0..cloud.positions.len() {
        for column in columns {
            column.put_bytes(row, &mut bytes);
        }
        if bytes.len() >= CHUNK_BYTES {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)?;
    for face in &cloud.faces {
        out.write_all(&[3])?;
        for corner in face {
            out.write_all(&corner.to_le_bytes())?;
        }
    }
    Ok(())
}

fn text(out: &mut dyn WriteSeek, cloud: &RawCloud, columns: &[WrittenColumn<'_>]) -> std::io::Result<()> {
    super::text::rows(out, cloud.positions.len(), columns)?;
    for [a, b, c] in &cloud.faces {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}
