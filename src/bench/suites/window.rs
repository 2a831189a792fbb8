//! Window responsiveness as a user perceives it: a real window is opened, plays, orbits and scrubs in real time.
//!
//! How it works: the window drives itself (`app/window_bench`), since only it knows when something was presented; here
//! its results become rows. A *image* is counted when it has been handed to the window system. The later work of an X
//! server or a compositor is in other processes: it takes the same cores, but is not in any time or share here.

use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::bench::{BenchError, BenchOptions, Environment, Input, Quantiles, Report, SequenceSummary};

/// Columns, in the order in which [`WindowAction::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("primitive", "primitive"),
    Column::text("action", "action"),
    Column::text("painted_by", "painted by").hidden(),
    Column::number("fps_asked", "fps asked", 1),
    Column::number("fps_presented", "presented", 1),
    Column::number("fps_held", "held", 1),
    Column::percent("points_share", "points shown", 1),
    Column::number("latency_ms_median", "latency ms", 1),
    Column::number("latency_ms_p95", "95 %", 1),
    Column::number("start_ms", "opened after ms", 0).hidden(),
    Column::number("first_ms", "first after ms", 0),
    Column::number("all_points_ms", "all points after ms", 0),
    Column::number("in_view_ms", "surfels in view after ms", 0),
    Column::number("rest_ms", "whole after ms", 0),
    Column::number("read_ms", "plain read ms", 0),
    Column::number("cpu_percent", "CPU % of a core", 0),
    Column::number("prepare_cpu_ms", "prepare ms a picture", 2),
    Column::number("draw_ms_median", "draw ms", 2),
    Column::number("draw_cpu_ms", "helpers' CPU ms", 2).hidden(),
    Column::number("panels_ms_median", "panels ms", 2),
    Column::number("paint_ms_median", "paint ms", 2),
    Column::number("present_ms_median", "present ms", 2),
    Column::number("driver_cpu_ms", "driver ms", 2),
    Column::number("wait_ms_median", "wait ms", 2).hidden(),
    Column::number("pictures", "pictures", 0),
    Column::number("panel_runs", "panel runs", 0),
    Column::number("frames_shown", "frames", 0).hidden(),
    Column::number("frames_late", "late", 0),
    Column::number("frames_skipped", "skipped", 0),
    Column::number("resident_mib", "RSS MiB", 0),
    Column::number("peak_mib", "peak RSS MiB", 0),
    Column::number("gpu_submissions", "submissions a picture", 2).hidden(),
    Column::number("gpu_passes", "passes a picture", 2).hidden(),
    Column::number("gpu_uploaded_kib", "uploaded KiB a picture", 1).hidden(),
];

/// A real window that plays, orbits and scrubs: presented images, their latency, and their cost.
pub const WINDOW: &Suite = &Suite {
    name: "window",
    brief: "frame rate, latency and cost of a real window",
    title: "Window",
    hint: "Play, turn and scrub in a window of its own: frames per second presented, latency, CPU time by part",
    description: "a real window, played, turned and scrubbed: rate presented, latency, CPU time by part",
    measured: "a real window that plays, is turned and scrubbed by a mouse at 125 moves per second: frames presented \
        and held per second, from opening to the first picture (first after), from a move to its presented picture \
        (latency), from the last move to the picture of all points (whole after); processor time of all threads (CPU), \
        of those that prepare frames and of a driver's; times of drawing, panels, painting and presenting, medians of \
        pictures",
    not_measured: "the work of the X server or the compositor, which takes the same cores; the time until a screen \
        shows the picture",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [1280, 800],
        viewpoints: 1,
        frames: 300,
    },
    takes: &[OptionGroup::Playing, OptionGroup::Window],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "fps_presented",
    bars_title: "Frames per second presented",
    bar_labels: 3,
};

/// Measurements of one action in the window. Times are milliseconds.
#[derive(Debug, Clone, Default)]
pub struct WindowAction {
    /// Name of the sequence.
    pub sequence: String,
    /// Primitive that was drawn.
    pub primitive: String,
    /// Action that was performed.
    pub action: String,
    /// Painter of the window.
    pub painted_by: String,
    /// Frames per second of the sequence, where it played.
    pub fps_asked: Option<f64>,
    /// Length of the action.
    pub seconds: f64,
    /// Images that were presented.
    pub pictures: u64,
    /// Runs of the panels.
    pub panel_runs: u64,
    /// Frames of the sequence that were shown.
    pub frames: u64,
    /// Frames that were not there in time, and those that were skipped.
    pub frames_late: u64,
    /// See [`WindowAction::frames_late`].
    pub frames_skipped: u64,
    /// Points in images, and in the files of their frames.
    pub points: [u64; 2],
    /// From each event to the presented image that follows from it.
    pub latencies_ms: Vec<f64>,
    /// From the start of the program to opening, where that is the first action.
    pub start_ms: Option<f64>,
    /// From opening the sequence to its first presented image.
    pub first_ms: Option<f64>,
    /// From opening it to the presented image of all points.
    pub all_points_ms: Option<f64>,
    /// From opening it to the presented image of surfels, be it of those in view alone.
    pub in_view_ms: Option<f64>,
    /// From opening it to the presented image with everything requested.
    pub whole_ms: Option<f64>,
    /// Reading the file, from the system's cache, and doing nothing with it.
    pub read_ms: Option<f64>,
    /// The most memory that the program had at once while it was opened.
    pub peak_bytes: Option<u64>,
    /// From the last event to the presented image of all points.
    pub rest_ms: Option<f64>,
    /// CPU time of all threads.
    pub cpu_ms: Option<f64>,
    /// CPU time of the threads that prepare frames, of driver threads, and of threads that help to draw.
    pub cpu_ms_of: Option<[f64; 3]>,
    /// Times of drawing, panels, painting, presenting and waiting of each image.
    pub parts_ms: [Vec<f64>; 5],
    /// Memory of the program at the end.
    pub resident_bytes: u64,
    /// Submissions, passes and uploaded bytes that the images took on a GPU, where one paints the window.
    pub gpu: Option<[u64; 3]>,
}

impl WindowAction {
    fn row(&self) -> Row {
        let a_second = |count: u64| count as f64 / self.seconds.max(1e-9);
        let median = |values: &[f64]| Quantiles::of(values).map(|quantiles| quantiles.median);
        let [draw, panels, paint, present, wait] = &self.parts_ms;
        let a_picture = |of_all: f64| of_all / self.pictures.max(1) as f64;
        let cpu = self.cpu_ms_of.map(|of| of.map(a_picture));
        let gpu = self.gpu.map(|of| of.map(|count| a_picture(count as f64)));
        let [shown, in_files] = self.points;
        let held = (self.frames > 1).then(|| a_second(self.frames - 1));
        Row::new(vec![
            Cell::Text(self.sequence.clone()),
            Cell::Text(self.primitive.clone()),
            Cell::Text(self.action.clone()),
            Cell::Text(self.painted_by.clone()),
            Cell::maybe(self.fps_asked),
            Cell::Number(a_second(self.pictures)),
            Cell::maybe(held),
            Cell::maybe((in_files > 0).then(|| shown as f64 / in_files as f64)),
            Cell::maybe(median(&self.latencies_ms)),
            Cell::maybe(percentile_95(&self.latencies_ms)),
            Cell::maybe(self.start_ms),
            Cell::maybe(self.first_ms),
            Cell::maybe(self.all_points_ms),
            Cell::maybe(self.in_view_ms),
            Cell::maybe(self.whole_ms.or(self.rest_ms)),
            Cell::maybe(self.read_ms),
            Cell::maybe(self.cpu_ms.map(|cpu_ms| cpu_ms / (10.0 * self.seconds))),
            Cell::maybe(cpu.map(|[prepare, ..]| prepare)),
            Cell::maybe(median(draw)),
            Cell::maybe(cpu.map(|[.., helpers]| helpers)),
            Cell::maybe(median(panels)),
            Cell::maybe(median(paint)),
            Cell::maybe(median(present)),
            Cell::maybe(cpu.map(|[_, driver, _]| driver)),
            Cell::maybe(median(wait)),
            Cell::Number(self.pictures as f64),
            Cell::Number(self.panel_runs as f64),
            Cell::Number(self.frames as f64),
            Cell::Number(self.frames_late as f64),
            Cell::Number(self.frames_skipped as f64),
            Cell::Number(mebibytes(self.resident_bytes)),
            Cell::maybe(self.peak_bytes.map(mebibytes)),
            Cell::maybe(gpu.map(|[submissions, ..]| submissions)),
            Cell::maybe(gpu.map(|[_, passes, _]| passes)),
            Cell::maybe(gpu.map(|[.., bytes]| bytes / 1024.0)),
        ])
    }
}

fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// The value below which 95 % of `values` are; `None` without values.
fn percentile_95(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[(0.95 * last as f64).ceil() as usize])
}

/// Only a window can; see [`window_report`].
pub(super) fn measure(_run: &mut Run<'_>) -> Result<(), BenchError> {
    Err(BenchError::NeedsWindow)
}

/// The report of a window's measurements of `inputs`.
pub fn window_report(inputs: &[Input], options: BenchOptions, actions: &[WindowAction]) -> Report {
    let mut report = Report::new(options, Environment::detect(None));
    report.sequences = inputs
        .iter()
        .map(|input| {
            let pictures = |action: &WindowAction| {
                let [shown, _] = action.points;
                (action.sequence == input.name && action.pictures > 0 && shown > 0)
                    .then(|| shown as f64 / action.pictures as f64)
            };
            let means: Vec<f64> = actions.iter().filter_map(pictures).collect();
            SequenceSummary {
                name: input.name.clone(),
                frames: input.sequence.len(),
                measured_frames: input.sequence.len(),
                mean_points: mean(&means),
                coverage: None,
            }
        })
        .collect();
    if let Some(action) = actions.first() {
        report.environment.adapter.clone_from(&action.painted_by);
    }
    report.rows = actions.iter().map(WindowAction::row).collect();
    report.notes.push(
        "presented is what was handed to the window system: its own work (X server, compositor) is in no time and no \
         share here"
            .to_owned(),
    );
    report
}

/// A report that another process wrote as JSON. `Err` is a text for the user.
pub fn window_report_of_json(json: &str) -> Result<Report, String> {
    let no_report = |reason: &dyn std::fmt::Display| format!("the report cannot be read: {reason}");
    let read: serde_json::Value = serde_json::from_str(json).map_err(|error| no_report(&error))?;
    let rows = read["rows"].as_array().ok_or_else(|| no_report(&"it has no rows"))?;
    let mut report = Report::new(BenchOptions::new(WINDOW), Environment::detect(None));
    if let Some(adapter) = read["environment"]["adapter"].as_str() {
        adapter.clone_into(&mut report.environment.adapter);
    }
    report.rows = rows
        .iter()
        .map(|row| {
            let cell = |column: &Column| match &row[column.key] {
                serde_json::Value::String(text) => Cell::Text(text.clone()),
                value => Cell::maybe(value.as_f64()),
            };
            Row::new(COLUMNS.iter().map(cell).collect())
        })
        .collect();
    let notes = read["notes"].as_array().into_iter().flatten();
    report.notes = notes.filter_map(|note| note.as_str().map(str::to_owned)).collect();
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_action_is_reported_per_second_and_per_frame() {
        let action = WindowAction {
            sequence: "walk".to_owned(),
            seconds: 2.0,
            pictures: 100,
            frames: 61,
            points: [50, 200],
            latencies_ms: (1..=100).map(f64::from).collect(),
            cpu_ms: Some(500.0),
            cpu_ms_of: Some([100.0, 0.0, 20.0]),
            parts_ms: [vec![3.0, 1.0, 2.0], vec![], vec![], vec![], vec![]],
            resident_bytes: 3 << 20,
            gpu: Some([100, 400, 204_800]),
            ..WindowAction::default()
        };
        let report = window_report(&[], BenchOptions::new(WINDOW), &[action]);
        let row = &report.rows[0];
        let number = |key: &str| report.value(row, key).unwrap().number();
        assert_eq!(number("fps_presented"), Some(50.0));
        assert_eq!(number("fps_held"), Some(30.0));
        assert_eq!(number("points_share"), Some(0.25));
        assert_eq!(number("cpu_percent"), Some(25.0));
        assert_eq!(number("prepare_cpu_ms"), Some(1.0));
        assert_eq!(number("draw_ms_median"), Some(2.0));
        assert_eq!(number("latency_ms_median"), Some(50.5));
        assert_eq!(number("latency_ms_p95"), Some(96.0));
        assert_eq!(number("resident_mib"), Some(3.0));
        assert_eq!(number("gpu_submissions"), Some(1.0));
        assert_eq!(number("gpu_passes"), Some(4.0));
        assert_eq!(number("gpu_uploaded_kib"), Some(2.0));
        assert_eq!(number("panels_ms_median"), None);
        assert_eq!(number("all_points_ms"), None);
        let again = window_report_of_json(&report.to_json()).unwrap();
        assert_eq!(again.rows, report.rows);
        assert_eq!(again.tables(), report.tables());
        assert!(window_report_of_json("{}").is_err());
    }
}
