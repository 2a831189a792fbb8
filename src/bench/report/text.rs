//! A report for the terminal: how it was measured, what that does not include, and aligned tables.

use super::{Report, Suite};
use crate::bench::{BenchOptions, COVERAGE_BAND, Coverage};
use std::fmt::Write as _;

impl Report {
    /// The whole report as text that ends with a line break.
    pub fn to_table(&self) -> String {
        let mut text = self.header();
        if matches!(self.suite(), Suite::Surfels | Suite::Voxels) {
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

    /// What a reader must know before reading a number.
    pub fn header(&self) -> String {
        let BenchOptions {
            suite,
            viewport_px: [width, height],
            viewpoints,
            warmup,
            repeat,
            ..
        } = self.options;
        let environment = &self.environment;
        let mut lines = vec![
            format!(
                "pointreel {} bench {suite}: {}",
                environment.version,
                suite.description()
            ),
            format!("adapter   {}", environment.adapter),
            format!(
                "machine   {}, {} threads, {}",
                environment.cpu, environment.threads, environment.system
            ),
            format!(
                "pictures  {width}x{height}, {viewpoints} viewpoints around each frame, {warmup} warm-up and {repeat} timed \
                 rounds over them"
            ),
        ];
        let [measured, not_measured] = match suite {
            Suite::Surfels | Suite::Voxels => [
                "CPU wall time from packet to finished picture (draw ms); GPU time of its passes (GPU ms); copying the \
                 records to the adapter (upload ms)",
                "decoding, normals, octrees and traversal, reading back, showing; uploads are not in draw ms",
            ],
            Suite::Octree => [
                "building from positions and colours in memory, in the order of the file and in Morton order, each on one thread and \
                 on all; traversal into reused memory on all threads; nodes are internal nodes",
                "decoding, normals, drawing; the adapter only draws the pictures whose coverage is counted",
            ],
            Suite::Accuracy => [
                "normals: angle to the truth on sampled shapes, either sign; noise is the standard deviation along each axis as a \
                 part of the diameter, outliers are 3 % of it off; tree, neighbours and planes on all threads, by least squares and robust. leaves: from points to the middles of \
                 their leaves, scene units and cell edges. lod: pictures of voxels, the whole object in view and from 4 times as \
                 far, against those of all leaves, τ = 0 (– is the truth itself, or a PSNR of equal pictures): PSNR and \
                 FLIP over the picture, FLIP over the pixels that show the object; to surfels: the same against surfels",
                "decoding, orientation of normals, radii, building octrees, drawing",
            ],
            Suite::Render => [
                "CPU wall time from packet to finished picture, processor and adapter in turn: the whole object in view, from 4 \
                 times as far (afar), from 0.3 times (near)",
                "decoding, normals, octrees, traversal, uploads, reading back, showing",
            ],
            Suite::Play => [
                "the player of the window by the clock, frames decoded and prepared meanwhile: frames a second asked for and shown, \
                 the share of their files' points that they had, those that had not all (coarse), were not there when due (late) \
                 or passed unseen (skipped); CPU wall time from packet to finished picture; memory of the whole program at the \
                 beginning, at most and at the end",
                "panels, showing; the first frame",
            ],
            Suite::Window => [
                "a real window that plays, is turned and scrubbed by a mouse of 125 moves a second: pictures presented and frames                  held a second, from opening to the first picture (first after), from a move to its presented picture (latency), from the last move to the picture of all points                  (whole after); processor time of all threads (CPU), of those that prepare frames and of a driver's; times of                  drawing, panels, painting and presenting, medians of pictures",
                "the work of the X server or the compositor, which takes the same cores; the time until a screen shows the picture",
            ],
            Suite::Error => [
                "CPU wall time from camera to finished picture, traversal and uploads of what it chose included; errors against \
                 the truth (a shape ray-traced, else all points as disks in f64; 8x8 samples a pixel): FLIP over the pixels that \
                 show the object and over all, PSNR, SSIM, background where the surface is (holes), another surface than a \
                 splat's diameter away (wrong surface), surface where the background is (too much); bytes uploaded for a first \
                 picture; on the front is what no other way beats in time and FLIP of the object",
                "decoding, normals, octrees, reading back, showing",
            ],
        };
        lines.push(format!("measured  {measured}"));
        lines.push(format!("not       {not_measured}"));
        for sequence in &self.sequences {
            lines.push(format!(
                "sequence  {}: {} of {} frames, {:.0} points",
                sequence.name, sequence.measured_frames, sequence.frames, sequence.mean_points
            ));
            let what = match suite {
                Suite::Voxels => "voxels",
                _ => "surfels",
            };
            let coverage = sequence.coverage.as_ref();
            lines.extend(coverage.map(|coverage| coverage_line(what, coverage)));
        }
        let is_of_paper = matches!(suite, Suite::Surfels | Suite::Octree | Suite::Voxels);
        if is_of_paper && viewpoints < BenchOptions::PROTOCOL_VIEWPOINTS {
            lines.push(format!(
                "note      the protocol wants at least {} viewpoints",
                BenchOptions::PROTOCOL_VIEWPOINTS
            ));
        }
        if environment.is_debug_build {
            lines.push(
                "note      this program has debug assertions: measure a release build".to_owned(),
            );
        }
        lines.extend(self.notes.iter().map(|note| format!("note      {note}")));
        lines.join("\n") + "\n"
    }

    /// The paper's layout: a line a sequence, a column a strategy, median draw times.
    fn paper_layout(&self) -> Vec<Vec<String>> {
        let mut head = vec!["median draw ms".to_owned()];
        let mut lines: Vec<Vec<String>> = Vec::new();
        for row in &self.rows {
            let cells = self.cells(row);
            let [sequence, strategy, ..] = cells.as_slice() else {
                continue;
            };
            let median = self
                .value(row, self.headline())
                .and_then(super::Cell::number);
            let median = median.map_or_else(|| "–".to_owned(), |median| format!("{median:.3}"));
            if !head.contains(strategy) {
                head.push(strategy.clone());
            }
            // Rows of a sequence follow each other and start over with the first strategy.
            match lines.last_mut() {
                Some(line) if line.len() < head.len() && line[0] == *sequence => line.push(median),
                _ => lines.push(vec![sequence.clone(), median]),
            }
        }
        std::iter::once(head).chain(lines).collect()
    }
}

/// How much of the pictures is covered.
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
    fn columns_stand_under_each_other() {
        let rows = [["sequence", "δ"], ["a", "2 %"], ["long name", "10 %"]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(
            align(&rows),
            "sequence      δ\na           2 %\nlong name  10 %\n"
        );
        assert_eq!(align(&[]), "");
    }
}
