//! A report for the terminal: the protocol, its limits, and aligned tables.

use super::Report;
use crate::bench::suite::Defaults;
use crate::bench::{BenchOptions, COVERAGE_BAND, Coverage};
use std::fmt::Write as _;

impl Report {
    /// The whole report as text that ends with a line break.
    pub fn to_table(&self) -> String {
        let mut text = self.header();
        if self.suite().has_paper_layout {
            text.push('\n');
            text.push_str(&align(&self.paper_layout()));
        }
        for table in self.tables() {
            text.push('\n');
            if !table.name.is_empty() {
                text.push_str(&table.name);
                text.push('\n');
            }
            let rows: Vec<_> = std::iter::once(table.columns).chain(table.rows).collect();
            text.push_str(&align(&rows));
        }
        text
    }

    /// Returns the header of the report: the context of its numbers.
    pub fn header(&self) -> String {
        let mut lines = self.protocol_lines();
        lines.extend(self.sequence_lines());
        lines.extend(self.note_lines().map(|note| format!("note      {note}")));
        lines.join("\n") + "\n"
    }

    /// Returns the protocol of the measurement: subject, hardware and method.
    fn protocol_lines(&self) -> Vec<String> {
        let BenchOptions {
            suite,
            viewport_px: [width, height],
            viewpoints,
            warmup,
            repeat,
            ..
        } = self.options;
        let environment = &self.environment;
        vec![
            format!("pointreel {} bench {suite}: {}", environment.version, suite.description),
            format!("adapter   {}", environment.adapter),
            format!(
                "machine   {}, {} threads, {}",
                environment.cpu, environment.threads, environment.system
            ),
            format!(
                "pictures  {width}x{height}, {viewpoints} viewpoints around each frame, {warmup} warm-up and \
                 {repeat} timed rounds over them"
            ),
            format!("measured  {}", suite.measured),
            format!("not       {}", suite.not_measured),
        ]
    }

    /// Returns a description of each sequence, and its pixel coverage of the images.
    fn sequence_lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for sequence in &self.sequences {
            lines.push(format!(
                "sequence  {}: {} of {} frames, {:.0} points",
                sequence.name, sequence.measured_frames, sequence.frames, sequence.mean_points
            ));
            let coverage = sequence.coverage.as_ref();
            let line = |coverage| coverage_line(self.suite().covered_by, coverage);
            lines.extend(coverage.map(line));
        }
        lines
    }

    /// Returns the notes on possibly misleading numbers.
    fn note_lines(&self) -> impl Iterator<Item = String> {
        let wanted = Defaults::PROTOCOL_VIEWPOINTS;
        let is_short = self.suite().is_of_paper && self.options.viewpoints < wanted;
        let short = is_short.then(|| format!("the protocol wants at least {wanted} viewpoints"));
        let debug = self
            .environment
            .is_debug_build
            .then(|| "this program has debug assertions: measure a release build".to_owned());
        let notes = self.notes.iter().cloned();
        short.into_iter().chain(debug).chain(notes)
    }

    /// Lays out the table as in the paper: one line per sequence, one column per strategy, median draw times.
    fn paper_layout(&self) -> Vec<Vec<String>> {
        let mut head = vec!["median draw ms".to_owned()];
        let mut lines: Vec<Vec<String>> = Vec::new();
        for row in &self.rows {
            let cells = self.cells(row);
            let [sequence, strategy, ..] = cells.as_slice() else {
                continue;
            };
            let median = self.value(row, self.suite().headline).and_then(super::Cell::number);
            let median = median.map_or_else(|| "–".to_owned(), |median| format!("{median:.3}"));
            if !head.contains(strategy) {
                head.push(strategy.clone());
            }
            // Rows of a sequence are consecutive and start over with the first strategy.
            match lines.last_mut() {
                Some(line) if line.len() < head.len() && line[0] == *sequence => line.push(median),
                _ => lines.push(vec![sequence.clone(), median]),
            }
        }
        std::iter::once(head).chain(lines).collect()
    }
}

/// Formats the pixel coverage of the images as a line.
fn coverage_line(what: &str, coverage: &Coverage) -> String {
    let percent = |share: f64| format!("{:.0}", share * 100.0);
    format!(
        "covered   {} to {} % by {what}, mean {} %; {} of {} viewpoints outside {} to {} %",
        percent(coverage.min),
        percent(coverage.max),
        percent(coverage.mean),
        coverage.outside,
        coverage.count,
        percent(*COVERAGE_BAND.start()),
        percent(*COVERAGE_BAND.end()),
    )
}

/// Pads cells to columns: the first to the left, others to the right.
fn align(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns)
        .map(|column| {
            rows.iter()
                .filter_map(|row| row.get(column))
                .map(|cell| cell.chars().count())
                .max()
                .unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            // Writing to a String cannot fail.
            let _ = match column {
                0 => write!(line, "{cell:<width$}"),
                _ => write!(line, "  {cell:>width$}"),
            };
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::align;

    #[test]
    fn columns_are_aligned() {
        let rows = [["sequence", "δ"], ["a", "2 %"], ["long name", "10 %"]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(align(&rows), "sequence      δ\na           2 %\nlong name  10 %\n");
        assert_eq!(align(&[]), "");
    }
}
