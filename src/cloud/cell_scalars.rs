//! Scalar fields of points that become one per cell: the mean of measurements, the most frequent of categories.

use super::ScalarField;
use std::collections::BTreeMap;

/// Names of fields whose numbers are categories: fields of LAS (1.4 R15, table 15) and labels of data sets. A mean of
/// class 2 and class 6 is neither.
const CATEGORIES: &[&str] = &[
    "category",
    "class",
    "class_id",
    "classification",
    "cluster",
    "id",
    "instance",
    "instance_id",
    "label",
    "labels",
    "number_of_returns",
    "object_id",
    "point_source_id",
    "return_number",
    "ring",
    "scan_channel",
    "scanner_channel",
    "segment",
    "semantic",
    "user_data",
];

/// Values of one field, by cell.
#[derive(Debug)]
pub(super) struct CellScalars {
    /// Name and offset.
    field: ScalarField,
    values: Values,
}

#[derive(Debug)]
enum Values {
    Sums(Vec<f64>),
    /// Number of occurrences of each value, keyed by its bits, which are in the order of the values from 0 on.
    Votes(Vec<BTreeMap<u32, u32>>),
}

impl CellScalars {
    pub(super) fn new(field: &ScalarField) -> Self {
        let name = field.name.to_ascii_lowercase();
        let is_category = CATEGORIES.contains(&name.as_str());
        Self {
            field: field.with_values(Vec::new()),
            values: if is_category {
                Values::Votes(Vec::new())
            } else {
                Values::Sums(Vec::new())
            },
        }
    }

    /// Adds an empty cell.
    pub(super) fn push_cell(&mut self) {
        match &mut self.values {
            Values::Sums(sums) => sums.push(0.0),
            Values::Votes(votes) => votes.push(BTreeMap::new()),
        }
    }

    pub(super) fn add(&mut self, cell: usize, value: f32) {
        match &mut self.values {
            Values::Sums(sums) => sums[cell] += f64::from(value),
            Values::Votes(votes) => *votes[cell].entry(value.to_bits()).or_default() += 1,
        }
    }

    /// Takes the field's cells, which are returned, and leaves the same field without any.
    pub(super) fn take(&mut self) -> Self {
        let empty = Self::new(&self.field);
        std::mem::replace(self, empty)
    }

    /// Adds a cell of `other`, which is of the same field.
    pub(super) fn add_cell(&mut self, cell: usize, other: &Self, other_cell: usize) {
        match (&mut self.values, &other.values) {
            (Values::Sums(sums), Values::Sums(others)) => sums[cell] += others[other_cell],
            (Values::Votes(votes), Values::Votes(others)) => {
                for (value, count) in &others[other_cell] {
                    *votes[cell].entry(*value).or_default() += count;
                }
            }
            (Values::Sums(_) | Values::Votes(_), _) => unreachable!("the kind follows from the name"),
        }
    }

    /// One value per cell; `counts` are the numbers of points. Of categories that are as frequent the smallest.
    pub(super) fn into_field(self, counts: impl Iterator<Item = u32>) -> ScalarField {
        let values = match self.values {
            Values::Sums(sums) => sums
                .into_iter()
                .zip(counts)
                .map(|(sum, count)| (sum / f64::from(count)) as f32)
                .collect(),
            Values::Votes(votes) => votes.iter().map(max_frequent).collect(),
        };
        self.field.with_values(values)
    }
}

fn max_frequent(votes: &BTreeMap<u32, u32>) -> f32 {
    let max = votes.values().copied().max();
    let value = votes.iter().find(|(_, count)| Some(**count) == max);
    f32::from_bits(value.map_or(0, |(value, _)| *value))
}
