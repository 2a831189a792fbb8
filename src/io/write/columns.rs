//! The attributes of a cloud as named columns. Ellipses are omitted: no other program would recognise them by a name.

use super::loss::Loss;
use crate::cloud::{Positions, RawCloud};
use std::fmt::Write as _;

/// A column.
pub(super) struct WrittenColumn<'a> {
    pub(super) name: String,
    data: Data<'a>,
}

/// Source of the numbers: one component of an array of vectors, or an array of numbers.
#[derive(Clone, Copy)]
enum Data<'a> {
    Vectors32(&'a [[f32; 3]], usize),
    Vectors64(&'a [[f64; 3]], usize),
    Channel(&'a [[u8; 4]], usize),
    /// A channel in which 1 is the brightest.
    Fraction(&'a [[u8; 4]], usize),
    Numbers(&'a [f32]),
    /// Values with an offset, to be added to each, as the second field.
    Offset(&'a [f32], f64),
}

/// Type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    U8,
    F32,
    F64,
}

/// Colour encoding of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colors {
    /// As bytes of a column with that type.
    Typed,
    /// Untyped numbers with no stated scale. Readers infer the scale from the largest one, so colours that are all
    /// below 2 are written as fractions, which are recognised as such.
    Untyped,
    /// Not at all.
    None,
}

/// The columns of `cloud`, coordinates first. `names` makes a scalar's name one that the format can hold.
pub(super) fn columns<'a>(
    cloud: &'a RawCloud,
    colors: Colors,
    normal_names: [&str; 3],
    names: impl Fn(&str) -> String,
) -> Vec<WrittenColumn<'a>> {
    let attributes = &cloud.attributes;
    let mut columns: Vec<WrittenColumn<'a>> = Vec::new();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let data = match &cloud.positions {
            Positions::F32(positions) => Data::Vectors32(positions, axis),
            Positions::F64(positions) => Data::Vectors64(positions, axis),
        };
        columns.push(WrittenColumn {
            name: name.to_owned(),
            data,
        });
    }
    if let Some(values) = attributes.colors.as_deref().filter(|_| colors != Colors::None) {
        let has_alpha = values.iter().any(|color| color[3] != u8::MAX);
        let scaled = |channels: std::ops::Range<usize>| {
            let is_dark = values
                .iter()
                .all(|color| color[channels.clone()].iter().all(|&channel| channel <= 1));
            colors == Colors::Untyped && is_dark
        };
        let (color_scaled, alpha_scaled) = (scaled(0..3), scaled(3..4));
        for (channel, name) in ["red", "green", "blue", "alpha"]
            .into_iter()
            .enumerate()
            .take(if has_alpha { 4 } else { 3 })
        {
            let is_scaled = if channel < 3 { color_scaled } else { alpha_scaled };
            let data = if is_scaled {
                Data::Fraction(values, channel)
            } else {
                Data::Channel(values, channel)
            };
            columns.push(WrittenColumn {
                name: name.to_owned(),
                data,
            });
        }
    }
    if let Some(normals) = &attributes.normals {
        for (axis, name) in normal_names.into_iter().enumerate() {
            columns.push(WrittenColumn {
                name: name.to_owned(),
                data: Data::Vectors32(normals, axis),
            });
        }
    }
    if let Some(radii) = &attributes.radii {
        columns.push(WrittenColumn {
            name: "radius".to_owned(),
            data: Data::Numbers(radii),
        });
    }
    for field in &attributes.scalars {
        let data = if field.offset == 0.0 {
            Data::Numbers(&field.values)
        } else {
            Data::Offset(&field.values, field.offset)
        };
        let name = unique(names(&field.name), &columns);
        columns.push(WrittenColumn { name, data });
    }
    columns
}

/// The scalars that are written under another name: see [`columns`].
pub(super) fn renamed(
    cloud: &RawCloud,
    colors: Colors,
    normal_names: [&str; 3],
    names: impl Fn(&str) -> String,
) -> Vec<(Loss, f64)> {
    let scalars = &cloud.attributes.scalars;
    let columns = columns(cloud, colors, normal_names, names);
    let written = &columns[columns.len() - scalars.len()..];
    let pairs = scalars
        .iter()
        .zip(written)
        .map(|(field, column)| (&field.name, &column.name));
    let is_renamed = |(from, to): &(&String, &String)| from != to;
    let loss = |(from, to): (&String, &String)| (Loss::Name(from.clone(), to.clone()), 0.0);
    pairs.filter(is_renamed).map(loss).collect()
}

/// `name`, or `scalar_` before it, or with a number behind, until no column has it.
fn unique(name: String, columns: &[WrittenColumn<'_>]) -> String {
    let is_free = |name: &str| !columns.iter().any(|column| column.name.eq_ignore_ascii_case(name));
    if is_free(&name) && !crate::io::columns::attributes::is_reserved(&name) {
        return name;
    }
    let marked = format!("scalar_{name}");
    let numbered = (2..).map(|number| format!("{marked}_{number}"));
    std::iter::once(marked.clone())
        .chain(numbered)
        .find(|name| is_free(name))
        .unwrap_or(marked)
}

impl WrittenColumn<'_> {
    /// Writes numbers of single precision with the digits that they have in double precision: where a column has no
    /// declared type, readers take fewer for a rounded double.
    pub(super) fn widen(&mut self) {
        if let Data::Numbers(values) = self.data {
            self.data = Data::Offset(values, 0.0);
        }
    }

    pub(super) fn kind(&self) -> Type {
        match self.data {
            Data::Channel(..) => Type::U8,
            Data::Vectors32(..) | Data::Numbers(..) => Type::F32,
            Data::Fraction(..) | Data::Vectors64(..) | Data::Offset(..) => Type::F64,
        }
    }

    /// Number `row`.
    pub(super) fn value(&self, row: usize) -> f64 {
        match self.data {
            Data::Vectors32(values, axis) => f64::from(values[row][axis]),
            Data::Vectors64(values, axis) => values[row][axis],
            Data::Channel(values, channel) => f64::from(values[row][channel]),
            Data::Fraction(values, channel) => f64::from(values[row][channel]) / f64::from(u8::MAX),
            Data::Numbers(values) => f64::from(values[row]),
            Data::Offset(values, offset) => f64::from(values[row]) + offset,
        }
    }

    /// Adds number `row` to `out` as the machine's little-endian bytes.
    pub(super) fn put_bytes(&self, row: usize, out: &mut Vec<u8>) {
        match self.data {
            Data::Channel(values, channel) => out.push(values[row][channel]),
            Data::Vectors32(values, axis) => out.extend(values[row][axis].to_le_bytes()),
            Data::Numbers(values) => out.extend(values[row].to_le_bytes()),
            _ => out.extend(self.value(row).to_le_bytes()),
        }
    }

    /// Adds the shortest digits of number `row` to `out`.
    pub(super) fn put_text(&self, row: usize, out: &mut String) {
        let value = self.value(row);
        // Very large and very small numbers would be long rows of zeros.
        let is_plain = value == 0.0 || !value.is_finite() || (1e-5..1e16).contains(&value.abs());
        // Writing to a String cannot fail.
        let _ = match (self.kind(), is_plain) {
            (Type::F32, true) => write!(out, "{}", value as f32),
            (Type::F32, false) => write!(out, "{:e}", value as f32),
            (_, true) => write!(out, "{value}"),
            (_, false) => write!(out, "{value:e}"),
        };
    }
}

/// A name without the signs that `is_allowed` forbids, which become underscores, and never empty.
pub(super) fn plain_name(name: &str, is_allowed: impl Fn(char) -> bool) -> String {
    let plain: String = name
        .chars()
        .map(|sign| if is_allowed(sign) { sign } else { '_' })
        .collect();
    if plain.is_empty() { "scalar".to_owned() } else { plain }
}

/// Bytes that are collected before they are handed on.
pub(super) const CHUNK_BYTES: usize = 1 << 16;
