//! Benchmark report of a run: rows of labels and numbers that the window, the terminal, JSON and CSV all show without
//! knowing the suite.

mod columns;
mod html;
mod text;

pub use columns::{Cell, Column, Row};

use super::scenario::Coverage;
use super::{BenchOptions, Environment, LabPoint, RatePoint, Suite};
use crate::scene::Strategy;
use serde::ser::{Serialize, SerializeMap, SerializeStruct, Serializer};

/// Rows of one kind, as people see them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Table {
    /// Name that distinguishes it from the other tables of its report; empty for the only one.
    pub name: String,
    /// Headings of the columns that some row fills.
    pub columns: Vec<String>,
    /// Cells, one for each heading.
    pub rows: Vec<Vec<String>>,
}

/// Summary of a sequence as a whole.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SequenceSummary {
    /// Name given by the user who started the run.
    pub name: String,
    /// Frames it has.
    pub frames: usize,
    /// Frames that were measured.
    pub measured_frames: usize,
    /// Mean number of points of these.
    pub mean_points: f64,
    /// Coverage of all viewpoints of all of these, by the suite's primitive; by surfels where it draws nothing.
    pub coverage: Option<Coverage>,
}

/// The answer of a run.
#[derive(Debug, Clone)]
pub struct Report {
    /// Options of the measurement.
    pub options: BenchOptions,
    /// Hardware and build.
    pub environment: Environment,
    /// Each sequence in the order of the inputs.
    pub sequences: Vec<SequenceSummary>,
    /// Under [`Report::all_columns`]; people see them as [`Report::tables`].
    pub rows: Vec<Row>,
    /// Notes that a reader must know: skipped frames and the like.
    pub notes: Vec<String>,
    /// Compared render modes, one per row; empty for suites that compare none.
    pub points: Vec<LabPoint>,
    /// The compared encodings of frames, one per row; empty for suites that compare none.
    pub rates: Vec<RatePoint>,
}

impl Report {
    pub(super) fn new(options: BenchOptions, environment: Environment) -> Self {
        Self {
            options,
            environment,
            sequences: Vec::new(),
            rows: Vec::new(),
            notes: Vec::new(),
            points: Vec::new(),
            rates: Vec::new(),
        }
    }

    /// Returns the suite of the report.
    pub fn suite(&self) -> &'static Suite {
        self.options.suite
    }

    /// All columns, in the order of the cells of a row; those with [`Column::is_shown`] are displayed.
    pub fn all_columns(&self) -> &'static [Column] {
        self.suite().columns
    }

    /// The tables that people are shown, in the order of their first rows.
    pub fn tables(&self) -> Vec<Table> {
        let mut tables: Vec<Table> = Vec::new();
        for row in &self.rows {
            let name = self.table_name(row);
            let place = tables.iter().position(|table| table.name == name);
            let place = place.unwrap_or_else(|| {
                tables.push(Table {
                    name: name.to_owned(),
                    columns: self.shown(name).map(|(_, column)| column.title.to_owned()).collect(),
                    rows: Vec::new(),
                });
                tables.len() - 1
            });
            tables[place].rows.push(self.cells(row));
        }
        tables
    }

    /// The cells of `row` under the headings of its table.
    pub fn cells(&self, row: &Row) -> Vec<String> {
        self.shown(self.table_name(row))
            .map(|(index, column)| column.show(row.cells.get(index).unwrap_or(&Cell::Missing)))
            .collect()
    }

    /// Empty in a report of one table.
    fn table_name<'a>(&self, row: &'a Row) -> &'a str {
        match self.value(row, Column::TABLE) {
            Some(Cell::Text(name)) => name,
            _ => "",
        }
    }

    /// The instancing strategy whose image took the least time, and that time in milliseconds: the mean of the
    /// sequences, where strategies were compared. `None` where there was only one.
    pub fn fastest_strategy(&self) -> Option<(Strategy, f64)> {
        let mean_ms = |strategy: &Strategy| {
            let is_of_it =
                |row: &&Row| matches!(self.value(row, "strategy"), Some(Cell::Text(name)) if name == strategy.name());
            let times: Option<Vec<f64>> = self
                .rows
                .iter()
                .filter(is_of_it)
                .map(|row| match self.value(row, self.suite().headline) {
                    Some(&Cell::Number(ms)) => Some(ms),
                    _ => None,
                })
                .collect();
            let times = times.filter(|times| !times.is_empty())?;
            Some((*strategy, times.iter().sum::<f64>() / times.len() as f64))
        };
        let known: Vec<_> = Strategy::ALL.iter().filter_map(mean_ms).collect();
        let fastest = known.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
        fastest.filter(|_| known.len() > 1)
    }

    /// The value of `row` in the column with this key.
    pub fn value<'a>(&self, row: &'a Row, key: &str) -> Option<&'a Cell> {
        let index = self.all_columns().iter().position(|column| column.key == key)?;
        row.cells.get(index)
    }

    /// Returns the title of the values that [`Report::bars`] shows.
    pub fn bars_title(&self) -> &'static str {
        self.suite().bars_title
    }

    /// One bar a row: its first cells, which tell it apart, and the number that the suite is about; see
    /// [`Report::bars_title`].
    pub fn bars(&self) -> Vec<(String, f64)> {
        let Suite {
            headline, bar_labels, ..
        } = self.suite();
        self.rows
            .iter()
            .filter_map(|row| {
                let labels: Vec<String> = self.cells(row).into_iter().take(*bar_labels).collect();
                Some((labels.join(" "), self.value(row, headline)?.number()?))
            })
            .collect()
    }

    /// Rows as CSV under the keys of all columns; values common to all rows come first.
    pub fn to_csv(&self) -> String {
        let [width, height] = self.options.viewport_px;
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = ["suite", "adapter", "width_px", "height_px"]
            .into_iter()
            .chain(self.all_columns().iter().map(|column| column.key));
        // Writing to memory cannot fail; every row has as many fields as the header.
        let _ = writer.write_record(header);
        for row in &self.rows {
            let common = [
                self.suite().to_string(),
                self.environment.adapter.clone(),
                width.to_string(),
                height.to_string(),
            ];
            let cells = row.cells.iter().map(|cell| match cell {
                Cell::Text(text) => text.clone(),
                Cell::Number(number) => number.to_string(),
                Cell::Missing => String::new(),
            });
            let _ = writer.write_record(common.into_iter().chain(cells));
        }
        let bytes = writer.into_inner().unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Everything as JSON: environment, options, sequences, notes, and rows as objects under the keys of all columns.
    pub fn to_json(&self) -> String {
        // Numbers, strings and maps with string keys are always JSON.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Displayed columns of a table, with their place in a row: those that some row of it fills.
    fn shown(&self, table: &str) -> impl Iterator<Item = (usize, &'static Column)> {
        self.all_columns().iter().enumerate().filter(move |&(index, column)| {
            let is_filled = |row: &Row| row.cells.get(index).is_some_and(|cell| *cell != Cell::Missing);
            let in_table = |row: &&Row| self.table_name(row) == table;
            let mut rows = self.rows.iter().filter(in_table);
            column.is_shown && column.key != Column::TABLE && rows.any(is_filled)
        })
    }
}

impl Serialize for Report {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct RowObject<'a>(&'static [Column], &'a Row);
        impl Serialize for RowObject<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let mut map = serializer.serialize_map(Some(self.0.len()))?;
                for (column, cell) in self.0.iter().zip(&self.1.cells) {
                    map.serialize_entry(column.key, cell)?;
                }
                map.end()
            }
        }
        let rows: Vec<RowObject<'_>> = self.rows.iter().map(|row| RowObject(self.all_columns(), row)).collect();
        let mut report = serializer.serialize_struct("Report", 6)?;
        report.serialize_field("suite", &self.suite())?;
        report.serialize_field("environment", &self.environment)?;
        report.serialize_field("options", &self.options)?;
        report.serialize_field("sequences", &self.sequences)?;
        report.serialize_field("notes", &self.notes)?;
        report.serialize_field("rows", &rows)?;
        report.end()
    }
}
