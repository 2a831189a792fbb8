//! A cloud that grows as its rows are read.

use super::arrays::{Scales, append_colors, append_f32, append_f64, rounded_colors};
use super::attributes::{self, Colors, Roles};
use super::column::{Column, Scalar};
use super::unique_names::UniqueNames;
use crate::cloud::{Attributes, Dropped, Positions, RawCloud, ScalarField};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use crate::locks::lock;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// The arrays of a cloud so far, with capacity for all points.
///
/// Columns of the same names and types are appended piece by piece, or all at once. Threads with a piece each follow
/// one another along the arrays: one appends positions while the one before appends the rest, and each scalar field is
/// its own step, so that files with many of them do not wait for a single thread.
#[derive(Debug)]
pub(super) struct Growing {
    roles: Roles,
    positions: Mutex<Positions>,
    others: Mutex<Others>,
    /// In the order of the roles.
    scalars: Vec<Mutex<GrowingField>>,
    /// Names that were changed.
    warnings: Vec<String>,
}

/// All arrays but the positions and the scalars.
#[derive(Debug)]
struct Others {
    attributes: Attributes,
    scales: Option<Scales>,
    rounds_colors: bool,
}

/// A scalar field so far.
#[derive(Debug)]
struct GrowingField {
    name: String,
    values: ScalarValues,
    /// True if the file stores the field as 64-bit integers.
    is_long: bool,
}

/// Numbers of a scalar field, as wide as the file has them.
#[derive(Debug)]
enum ScalarValues {
    Narrow(Vec<f32>),
    Wide(Vec<f64>),
}

impl Growing {
    /// No points yet, with capacity for `count` of `columns`, whose values are examined where types do not determine
    /// the range of colours: only allowed for the columns of a piece if [`Roles::are_local`].
    pub(in crate::io) fn new(roles: Roles, columns: &[Column<'_>], count: usize) -> Self {
        let is_wide = |&index: &usize| columns[index].is_wide();
        let positions = if roles.positions.iter().any(is_wide) {
            Positions::F64(Vec::with_capacity(count))
        } else {
            Positions::F32(Vec::with_capacity(count))
        };
        let scales = match roles.colors {
            Some(Colors::Channels { channels, alpha }) => Some(Scales::of(
                channels.map(|index| &columns[index]),
                alpha.map(|index| &columns[index]),
                count,
            )),
            _ => None,
        };
        let names = field_names(roles.scalars.iter().map(|&index| (index, columns[index].name.as_str())));
        let renamed = roles.scalars.iter().zip(&names);
        let renamed = renamed.filter(|(index, name)| {
            let given = columns[**index].name.trim();
            !given.is_empty() && given != name.as_str()
        });
        let warnings = renamed.map(|(&index, name)| {
            format!(
                "header: the field `{}` has the name of another one: it is read as `{name}`",
                columns[index].name
            )
        });
        let warnings: Vec<String> = warnings.collect();
        let scalar = |(&index, name): (&usize, String)| {
            let values = if columns[index].scalar.is_wide() {
                ScalarValues::Wide(Vec::with_capacity(count))
            } else {
                ScalarValues::Narrow(Vec::with_capacity(count))
            };
            let is_long = matches!(columns[index].scalar, Scalar::I64 | Scalar::U64);
            Mutex::new(GrowingField { name, values, is_long })
        };
        let scalars = roles.scalars.iter().zip(names).map(scalar).collect();
        let others = Others {
            attributes: Attributes {
                normals: roles.normals.map(|_| Vec::with_capacity(count)),
                colors: roles.colors.map(|_| Vec::with_capacity(count)),
                radii: roles.radii.map(|_| Vec::with_capacity(count)),
                ..Attributes::default()
            },
            scales,
            rounds_colors: false,
        };
        Self {
            roles,
            positions: Mutex::new(positions),
            others: Mutex::new(others),
            scalars,
            warnings,
        }
    }

    /// Arrays that are appended to one after the other.
    pub(super) fn step_count(&self) -> usize {
        2 + self.scalars.len()
    }

    /// Appends the first `count` rows of `columns`. Rows of several threads come in the order of their turns: `turn`
    /// blocks the others, and is dropped as soon as they cannot overtake.
    pub(in crate::io) fn append<T>(&self, columns: &[Column<'_>], count: usize, turn: T) {
        let mut positions = lock(&self.positions);
        drop(turn);
        let coordinates = self.roles.positions.map(|index| &columns[index]);
        match &mut *positions {
            Positions::F32(vectors) => append_f32(vectors, coordinates, count),
            Positions::F64(vectors) => append_f64(vectors, coordinates, count),
        }
        let mut others = lock(&self.others);
        drop(positions);
        others.append(&self.roles, columns, count);
        let mut fields = self.scalars.iter().zip(&self.roles.scalars);
        let Some((first, &index)) = fields.next() else { return };
        // The next array is locked before the last one is released: no thread overtakes another.
        let mut field = lock(first);
        drop(others);
        field.values.append(&columns[index], count);
        for (next, &index) in fields {
            field = lock(next);
            field.values.append(&columns[index], count);
        }
    }

    /// [`Growing::append`] of columns that have all rows: each array by its own thread.
    fn append_all(&self, columns: &[Column<'_>], count: usize) {
        let vectors = || {
            let coordinates = self.roles.positions.map(|index| &columns[index]);
            match &mut *lock(&self.positions) {
                Positions::F32(vectors) => append_f32(vectors, coordinates, count),
                Positions::F64(vectors) => append_f64(vectors, coordinates, count),
            }
            lock(&self.others).append(&self.roles, columns, count);
        };
        let scalars = || {
            let fields = self.scalars.par_iter().zip(&self.roles.scalars);
            fields.for_each(|(field, &index)| lock(field).values.append(&columns[index], count));
        };
        rayon::join(vectors, scalars);
    }

    /// The cloud of all rows that were appended.
    pub(in crate::io) fn finish(self) -> RawCloud {
        let positions = self.positions.into_inner();
        let mut cloud = RawCloud::from_positions(positions.unwrap_or_else(PoisonError::into_inner));
        let others = self.others.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(scales) = &others.scales {
            (cloud.has_narrow_colors, cloud.color_depth) = (scales.is_narrow, scales.depth);
        }
        cloud.attributes = others.attributes;
        cloud.warnings = self.warnings;
        cloud.dropped.extend(others.rounds_colors.then(rounded_colors));
        let field = |field: Mutex<GrowingField>| {
            let GrowingField { name, values, is_long } = field.into_inner().unwrap_or_else(PoisonError::into_inner);
            let rounded = is_long.then(|| values.rounded(&name)).flatten();
            let field = match values {
                ScalarValues::Narrow(values) => ScalarField::new(name, values),
                ScalarValues::Wide(values) => ScalarField::from_f64(name, &values),
            };
            (field, rounded)
        };
        let (scalars, rounded): (Vec<ScalarField>, Vec<Option<Dropped>>) =
            self.scalars.into_par_iter().map(field).unzip();
        cloud.attributes.scalars = scalars;
        cloud.dropped.extend(rounded.into_iter().flatten());
        // Writers without support for transparency leave zeros.
        if let (Some(Colors::Packed(_)), Some(colors)) = (self.roles.colors, &mut cloud.attributes.colors)
            && colors.iter().all(|color| color[3] == 0)
        {
            for color in colors {
                color[3] = 255;
            }
        }
        cloud
    }
}

impl Others {
    fn append(&mut self, roles: &Roles, columns: &[Column<'_>], count: usize) {
        let three = |indices: [usize; 3]| indices.map(|index| &columns[index]);
        if let (Some(normals), Some(indices)) = (&mut self.attributes.normals, roles.normals) {
            append_f32(normals, three(indices), count);
        }
        match (&mut self.attributes.colors, roles.colors, &self.scales) {
            (Some(colors), Some(Colors::Channels { channels, alpha }), Some(scales)) => {
                let alpha = alpha.map(|index| &columns[index]);
                self.rounds_colors |= append_colors(colors, three(channels), alpha, scales, count);
            }
            (Some(colors), Some(Colors::Packed(index)), _) => {
                append_packed_colors(colors, &columns[index], count);
            }
            _ => {}
        }
        if let (Some(radii), Some(index)) = (&mut self.attributes.radii, roles.radii) {
            columns[index].append_f32(radii, count);
        }
    }
}

impl ScalarValues {
    /// Returns the note about integers that double precision may not hold.
    fn rounded(&self, name: &str) -> Option<Dropped> {
        const LARGEST: f64 = (1u64 << f64::MANTISSA_DIGITS) as f64;
        let Self::Wide(values) = self else { return None };
        let count = values.iter().filter(|value| value.abs() > LARGEST).count();
        (count > 0).then(|| {
            Dropped::quiet(format!(
                "{count} integers of 64 bits in `{name}` are beyond 2^53: they are rounded to double precision"
            ))
        })
    }

    fn append(&mut self, column: &Column<'_>, count: usize) {
        match self {
            Self::Narrow(numbers) => column.append_f32(numbers, count),
            Self::Wide(numbers) => column.append_f64(numbers, count),
        }
    }
}

/// The names of scalar fields from pairs of column index and name: unnamed ones get their index, and each differs from
/// all fields before it, ignoring case and a prefix `scalar_`, as in queries for fields.
fn field_names<'a>(columns: impl Iterator<Item = (usize, &'a str)>) -> Vec<String> {
    let mut names = UniqueNames::default();
    let unique = |(index, name): (usize, &str)| {
        let numbered = format!("column_{}", index + 1);
        let name = match name.trim() {
            "" => &numbered,
            name => name,
        };
        names.take(name, attributes::plain_scalar_name)
    };
    columns.map(unique).collect()
}

/// PCL packs colours as 0xAARRGGBB, into an unsigned integer or into the bits of a float. `rgb` leaves alpha at 0.
fn append_packed_colors(colors: &mut Vec<[u8; 4]>, column: &Column<'_>, count: usize) {
    let has_alpha = column.name.eq_ignore_ascii_case("rgba");
    colors.extend(column.bits(count).into_iter().map(|bits| {
        let [blue, green, red, alpha] = bits.to_le_bytes();
        [red, green, blue, if has_alpha { alpha } else { 255 }]
    }));
}

/// The cloud of `count` points in `columns`, if there is memory for it next to those that are parsed.
pub(in crate::io) fn cloud(columns: &[Column<'_>], count: usize, options: &ReadOptions) -> Result<RawCloud, Fault> {
    let roles = Roles::of(columns)?;
    let parsed = columns.iter().map(Column::parsed_bytes).sum();
    let what = format!("{count} points");
    options
        .holding(parsed)
        .claim_entries(&what, count, roles.point_bytes(columns))?;
    let growing = Growing::new(roles, columns, count);
    growing.append_all(columns, count);
    Ok(growing.finish())
}
