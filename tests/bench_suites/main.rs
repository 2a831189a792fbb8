//! Each benchmark suite runs on the demo at small size, and has the same figures in its table, JSON and CSV.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod accuracy;
mod coded;
#[path = "../common/mod.rs"]
mod common;
mod drawing;
mod error;
mod inputs;
mod runs;
mod stability;
mod temporal;

use pointreel::bench::{BenchOptions, Cell, Column, Input, Report, Row, Suite, run};
use pointreel::progress::Progress;
use pointreel::sequence::Sequence;
use std::sync::Arc;

const STRATEGIES: [&str; 5] = ["storage", "uniform", "texture", "vertex", "compute"];

/// Few and small images: these tests are about the suites, not about the clock.
fn small(suite: &'static Suite) -> BenchOptions {
    BenchOptions {
        viewport_px: [96, 64],
        viewpoints: 2,
        frames: 2,
        warmup: 1,
        repeat: 2,
        cloud_points: Vec::new(),
        ..BenchOptions::new(suite)
    }
}

fn demo() -> Vec<Input> {
    vec![input("demo", Sequence::demo())]
}

fn input(name: &str, sequence: Sequence) -> Input {
    Input {
        name: name.to_owned(),
        sequence: Arc::new(sequence),
        shape: None,
    }
}

fn measure(options: &BenchOptions) -> Report {
    run(
        &demo(),
        options,
        Some(&common::context()),
        &|_| {},
        &Progress::default(),
    )
    .unwrap()
}

fn numbers(report: &Report, key: &str) -> Vec<f64> {
    let number = |row| report.value(row, key).and_then(Cell::number);
    report
        .rows
        .iter()
        .map(|row| number(row).unwrap_or_else(|| panic!("{key} is missing")))
        .collect()
}

/// JSON and CSV are read back and compared with the rows, cell for cell.
fn assert_files_agree(report: &Report) {
    let json: serde_json::Value = serde_json::from_str(&report.to_json()).unwrap();
    assert_eq!(json["suite"], report.suite().name());
    assert_eq!(
        json["environment"]["adapter"].as_str(),
        Some(report.environment.adapter.as_str())
    );
    let csv_text = report.to_csv();
    let mut csv = csv::Reader::from_reader(csv_text.as_bytes());
    let headers = csv.headers().unwrap().clone();
    let records: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
    assert_eq!(records.len(), report.rows.len());
    assert_eq!(json["rows"].as_array().unwrap().len(), report.rows.len());
    for (index, (row, record)) in report.rows.iter().zip(&records).enumerate() {
        for column in report.all_columns() {
            let field = &record[headers.iter().position(|header| header == column.key).unwrap()];
            let value = &json["rows"][index][column.key];
            match report.value(row, column.key).unwrap() {
                Cell::Text(text) => assert_eq!((field, value.as_str()), (text.as_str(), Some(text.as_str()))),
                Cell::Number(number) => {
                    assert_eq!(field.parse(), Ok(*number), "{} in CSV", column.key);
                    // serde_json reads the last digit of some numbers incorrectly.
                    let error = (value.as_f64().unwrap() - number).abs();
                    assert!(
                        error <= 1e-14 * number.abs(),
                        "{} in JSON: {value} for {number}",
                        column.key
                    );
                }
                Cell::Missing => assert!(field.is_empty() && value.is_null(), "{}", column.key),
            }
        }
    }
    let text = report.to_table();
    let tables = report.tables();
    let row_count: usize = tables.iter().map(|table| table.rows.len()).sum();
    assert_eq!(row_count, report.rows.len());
    for table in &tables {
        for cells in table.rows.iter().chain([&table.columns]) {
            assert_eq!(cells.len(), table.columns.len());
            let line = text
                .lines()
                .rev()
                .find(|line| cells.iter().all(|cell| line.contains(cell.as_str())));
            assert!(line.is_some(), "no line of the table has all of {cells:?}\n{text}");
        }
    }
}

/// The rows of one table of the accuracy suite.
fn rows_of<'a>(report: &'a Report, table: &str) -> Vec<&'a Row> {
    let is_of = |row: &&Row| report.value(row, Column::TABLE) == Some(&Cell::Text(table.to_owned()));
    report.rows.iter().filter(is_of).collect()
}

fn column(report: &Report, rows: &[&Row], key: &str) -> Vec<f64> {
    let number = |row| report.value(row, key).and_then(Cell::number);
    rows.iter()
        .map(|row| number(row).unwrap_or_else(|| panic!("{key} is missing")))
        .collect()
}
