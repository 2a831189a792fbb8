//! Text with a point a line.

use super::columns::{CHUNK_BYTES, Colors, WrittenColumn, columns, plain_name, renamed};
use super::encoder::{Encoder, Held, WriteSeek};
use crate::cloud::RawCloud;

const HOLDS: &[Held] = &[Held::Normals, Held::Alpha, Held::Radii, Held::Scalars, Held::Holes];

/// A point a line and the names of the columns in its first: all but faces and the sensor.
pub(in crate::io) const ENCODER: &Encoder = &Encoder {
    name: "xyz",
    extension: "xyz",
    holds: HOLDS,
    lost: |cloud| renamed(cloud, Colors::Untyped, ["nx", "ny", "nz"], name),
    write: |out, cloud| write(out, cloud),
};

fn write(out: &mut dyn WriteSeek, cloud: &RawCloud) -> std::io::Result<()> {
    let mut columns = columns(cloud, Colors::Untyped, ["nx", "ny", "nz"], name);
    for scalar in columns.iter_mut().rev().take(cloud.attributes.scalars.len()) {
        scalar.widen();
    }
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    writeln!(out, "# {}", names.join(" "))?;
    rows(out, cloud.positions.len(), &columns)
}

fn name(name: &str) -> String {
    plain_name(name, |sign| {
        !sign.is_whitespace() && !sign.is_control() && !",;\"#".contains(sign)
    })
}

/// A line for each of the `count` rows.
pub(super) fn rows(out: &mut dyn WriteSeek, count: usize, columns: &[WrittenColumn<'_>]) -> std::io::Result<()> {
    let mut text = String::new();
    for row in 0..count {
        for (index, column) in columns.iter().enumerate() {
            if index > 0 {
                text.push(' ');
            }
            column.put_text(row, &mut text);
        }
        text.push('\n');
        if text.len() >= CHUNK_BYTES {
            out.write_all(text.as_bytes())?;
            text.clear();
        }
    }
    out.write_all(text.as_bytes())
}
