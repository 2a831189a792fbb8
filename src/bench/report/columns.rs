//! Rows of labels and numbers, and the names of their columns.

use serde::ser::{Serialize, Serializer};

/// Number format of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Text,
    Number { decimals: usize },
    Percent { decimals: usize },
}

/// A column of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name in JSON and CSV; carries the unit.
    pub key: &'static str,
    /// Its display name.
    pub title: &'static str,
    /// False for columns in files only.
    pub is_shown: bool,
    format: Format,
}

impl Column {
    /// Key of the text column that tells the tables of a report apart, where it has several.
    pub const TABLE: &'static str = "table";

    pub(in crate::bench) const fn text(key: &'static str, title: &'static str) -> Self {
        Self {
            key,
            title,
            is_shown: true,
            format: Format::Text,
        }
    }

    pub(in crate::bench) const fn number(key: &'static str, title: &'static str, decimals: usize) -> Self {
        Self {
            key,
            title,
            is_shown: true,
            format: Format::Number { decimals },
        }
    }

    /// A share of 1 that people see in percent.
    pub(in crate::bench) const fn percent(key: &'static str, title: &'static str, decimals: usize) -> Self {
        Self {
            key,
            title,
            is_shown: true,
            format: Format::Percent { decimals },
        }
    }

    pub(in crate::bench) const fn hidden(self) -> Self {
        Self {
            is_shown: false,
            ..self
        }
    }

    /// True for labels, false for numbers.
    pub fn is_text(&self) -> bool {
        self.format == Format::Text
    }

    /// The cell as people see it.
    pub(super) fn show(&self, cell: &Cell) -> String {
        match (cell, self.format) {
            (Cell::Text(text), _) => text.clone(),
            (Cell::Missing, _) => "–".to_owned(),
            (Cell::Number(number), Format::Percent { decimals }) => {
                format!("{:.decimals$} %", number * 100.0)
            }
            (Cell::Number(number), Format::Number { decimals }) => format!("{number:.decimals$}"),
            (Cell::Number(number), Format::Text) => number.to_string(),
        }
    }
}

/// One value.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A label.
    Text(String),
    /// A number in the unit of its column.
    Number(f64),
    /// Not measured, such as GPU time on an adapter without timestamps.
    Missing,
}

impl Cell {
    pub(in crate::bench) fn maybe(number: Option<f64>) -> Self {
        number.map_or(Self::Missing, Self::Number)
    }

    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Text(_) | Self::Missing => None,
        }
    }
}

impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => serializer.serialize_str(text),
            // Counts are written without a fraction.
            Self::Number(number) if number.fract() == 0.0 && number.abs() < 1e15 => {
                serializer.serialize_i64(*number as i64)
            }
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Missing => serializer.serialize_none(),
        }
    }
}

/// One row: a cell for each column of the suite.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub(super) cells: Vec<Cell>,
}

impl Row {
    pub(in crate::bench) fn new(cells: Vec<Cell>) -> Self {
        Self { cells }
    }

    /// A row of `table` with `cells` under their keys; the others of `columns` are missing.
    pub(in crate::bench) fn of_table(columns: &[Column], table: &str, cells: &[(&str, Cell)]) -> Self {
        debug_assert!(
            cells
                .iter()
                .all(|(key, _)| columns.iter().any(|column| column.key == *key)),
            "every cell has a column"
        );
        let cell_of = |column: &Column| match cells.iter().find(|(key, _)| *key == column.key) {
            Some((_, cell)) => cell.clone(),
            None if column.key == Column::TABLE => Cell::Text(table.to_owned()),
            None => Cell::Missing,
        };
        Self::new(columns.iter().map(cell_of).collect())
    }
}
