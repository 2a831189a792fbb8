//! The columns that are kept of points.

use super::super::attributes;
use super::super::column::{Column, Values};
use super::header::{Element, PropertyKind};
use super::splats;

/// The element whose rows are points.
pub(super) const POINTS: &str = "vertex";

/// Parsed columns of the properties that a cloud has a use for.
pub(super) struct KeptColumns {
    pub(super) columns: Vec<Column<'static>>,
    /// Column of each property.
    pub(super) column_of: Vec<Option<usize>>,
}

impl KeptColumns {
    pub(super) fn new(vertex: &Element) -> Self {
        let mut kept = Self {
            columns: Vec::new(),
            column_of: Vec::new(),
        };
        let is_used = |name: &str| attributes::is_used(name) || splats::is_used(name);
        for property in &vertex.properties {
            let scalar = match property.kind {
                PropertyKind::Scalar(scalar) if is_used(&property.name) => Some(scalar),
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

    pub(super) fn push(&mut self, property: usize, value: f64) {
        if let Some(column) = self.column_of[property]
            && let Values::Parsed(values) = &mut self.columns[column].values
        {
            values.push(value);
        }
    }
}
