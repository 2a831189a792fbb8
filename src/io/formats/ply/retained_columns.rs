//! The retained columns of points: all but lists, and of splats those that are not converted.

use super::header::{Element, Property, PropertyKind};
use super::splats;
use crate::io::columns::column::{Column, Values};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;

/// The element whose rows are points.
pub(super) const POINTS: &str = "vertex";

/// Parsed columns of the retained properties.
pub(super) struct RetainedColumns {
    pub(super) columns: Vec<Column<'static>>,
    /// Column of each property.
    pub(super) column_of: Vec<Option<usize>>,
}

impl RetainedColumns {
    pub(super) fn new(vertex: &Element) -> Self {
        let mut retained = Self {
            columns: Vec::new(),
            column_of: Vec::new(),
        };
        let names = |name: &str| vertex.properties.iter().any(|property| property.name == name);
        let is_splat = splats::are_splats(&names);
        for property in &vertex.properties {
            let scalar = match property.kind {
                PropertyKind::Scalar(scalar) if !(is_splat && splats::is_unread(&property.name)) => Some(scalar),
                _ => None,
            };
            retained.column_of.push(scalar.map(|_| retained.columns.len()));
            retained.columns.extend(scalar.map(|scalar| Column {
                name: property.name.clone(),
                scalar,
                values: Values::Parsed(Vec::with_capacity(vertex.count)),
            }));
        }
        retained
    }

    /// Bytes that the columns of `vertex` take.
    pub(super) fn bytes(vertex: &Element) -> usize {
        let is_number = |property: &&Property| matches!(property.kind, PropertyKind::Scalar(_));
        let numbers = vertex.properties.iter().filter(is_number).count();
        vertex.count.saturating_mul(numbers * size_of::<f64>())
    }

    /// Fails if memory does not suffice for the columns of `vertex`.
    pub(super) fn claim(vertex: &Element, options: &ReadOptions) -> Result<(), Fault> {
        let what = format!("the numbers of {} points", vertex.count);
        options.claim(&what, Self::bytes(vertex) as u64)
    }

    pub(super) fn push(&mut self, property: usize, value: f64) {
        if let Some(column) = self.column_of[property]
            && let Values::Parsed(values) = &mut self.columns[column].values
        {
            values.push(value);
        }
    }

    /// Truncates to the first `rows` rows; missing values are NaN.
    pub(super) fn resize(&mut self, rows: usize) {
        for column in &mut self.columns {
            if let Values::Parsed(values) = &mut column.values {
                values.resize(rows, f64::NAN);
            }
        }
    }
}
