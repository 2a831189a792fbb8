//! PLY, binary and as text.

use super::columns::{CHUNK_BYTES, Colors, Column, Type, columns, plain_name};
use crate::cloud::RawCloud;
use std::io::Write;

pub(super) fn write(out: &mut impl Write, cloud: &RawCloud, is_text: bool) -> std::io::Result<()> {
    let columns = columns(cloud, Colors::Typed, ["nx", "ny", "nz"], name);
    out.write_all(header(cloud, &columns, is_text).as_bytes())?;
    if is_text {
        text(out, cloud, &columns)
    } else {
        binary(out, cloud, &columns)
    }
}

/// Names of properties are letters, digits and underscores, a letter first.
fn name(name: &str) -> String {
    let plain = plain_name(name, |sign| {
        sign.is_ascii_alphanumeric() || sign == '_' || sign == '-'
    });
    if plain.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') {
        plain
    } else {
        format!("_{plain}")
    }
}

fn header(cloud: &RawCloud, columns: &[Column<'_>], is_text: bool) -> String {
    let encoding = if is_text {
        "ascii"
    } else {
        "binary_little_endian"
    };
    let mut header = format!(
        "ply\nformat {encoding} 1.0\ncomment written by pointreel\nelement vertex {}\n",
        cloud.positions.len()
    );
    for column in columns {
        let kind = match column.kind() {
            Type::U8 => "uchar",
            Type::F32 => "float",
            Type::F64 => "double",
        };
        header += &format!("property {kind} {}\n", column.name);
    }
    if !cloud.faces.is_empty() {
        header += &format!(
            "element face {}\nproperty list uchar {} vertex_indices\n",
            cloud.faces.len(),
            index_type(cloud)
        );
    }
    header + "end_header\n"
}

/// Most readers expect `int`; more points than that has need the sign.
fn index_type(cloud: &RawCloud) -> &'static str {
    if i32::try_from(cloud.positions.len()).is_ok() {
        "int"
    } else {
        "uint"
    }
}

fn binary(out: &mut impl Write, cloud: &RawCloud, columns: &[Column<'_>]) -> std::io::Result<()> {
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

fn text(out: &mut impl Write, cloud: &RawCloud, columns: &[Column<'_>]) -> std::io::Result<()> {
    super::text::rows(out, cloud.positions.len(), columns)?;
    for [a, b, c] in &cloud.faces {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}
