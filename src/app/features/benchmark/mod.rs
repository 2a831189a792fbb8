//! A benchmark on its own thread, with its progress and its result as plain data for the panel.

mod hit;
mod in_window;
mod lab;
pub(in crate::app) mod panel;
mod pictures;
mod rates;
mod setup;
mod task;

pub use setup::BenchmarkSetup;
pub(in crate::app) use task::benchmark_job;

use crate::app::work::outcome::Message;
use crate::app::work::tasks::{TaskOutcome, Tasks, Wake};
use crate::app::work::works::{Work, WorkKind};
use crate::bench::{self, LabPoint, Measured, RatePoint, Step};
use crate::locks::lock;
use crate::progress::Progress;
use crate::scene::Strategy;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// File format of a benchmark report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReportFormat {
    /// For programs.
    Json,
    /// For spreadsheets.
    Csv,
    /// For browsers.
    Html,
}

impl ReportFormat {
    /// Its display name.
    pub(in crate::app) fn name(self) -> &'static str {
        match self {
            Self::Json => "JSON",
            Self::Csv => "CSV",
            Self::Html => "HTML page",
        }
    }

    /// Returns the file name extension of the format.
    pub(in crate::app) fn extension(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Csv => "csv",
            Self::Html => "html",
        }
    }
}

/// A finished benchmark as the panel shows and exports it.
#[derive(Debug, Clone, Default)]
pub struct BenchmarkTable {
    /// Name of the suite.
    pub suite: String,
    /// GPU adapter of the measurement.
    pub adapter: String,
    /// Result tables; most suites have one table.
    pub tables: Vec<bench::Table>,
    /// Notes a reader must know, such as frames that were skipped.
    pub notes: Vec<String>,
    /// The instancing strategy that took the least time, and that time in milliseconds, where they were compared.
    pub fastest: Option<(Strategy, f64)>,
    /// Title of the bars.
    pub bars_title: String,
    /// Label and length of each bar of the chart.
    pub bars: Vec<(String, f64)>,
    /// The report for programs.
    pub json: String,
    /// The report for spreadsheets.
    pub csv: String,
    /// The report as a page; empty where there is none.
    pub html: String,
    /// Render modes by time and error; most suites have none.
    pub points: Vec<Arc<LabPoint>>,
    /// Encodings of a frame by rate and distortion; most suites have none.
    pub rates: Vec<Arc<RatePoint>>,
}

/// The work of a benchmark: reports its steps, stops soon after it was cancelled. `Err` is a text for the user.
pub type BenchmarkJob = Box<dyn FnOnce(&dyn Fn(Step), &Progress) -> Result<BenchmarkTable, String> + Send>;

impl Message for BenchmarkEnded {}

/// Outcome of a benchmark; `Err` is a text for the user.
#[derive(Debug)]
pub struct BenchmarkEnded(Result<BenchmarkTable, String>);

/// Contents of the benchmark window.
#[derive(Debug, Default)]
pub enum Benchmark {
    /// Nothing was started.
    #[default]
    Idle,
    /// One is running.
    Running(RunningBenchmark),
    /// It was cancelled; earlier measurements stay.
    Cancelled(SoFar),
    /// It could not be finished.
    Failed(String, SoFar),
    /// It is finished.
    Done(Box<BenchmarkTable>),
}

/// Partial results of a benchmark that ended too early.
#[derive(Debug, Clone, Default)]
pub struct SoFar {
    /// Render modes by time and error.
    pub points: Vec<Arc<LabPoint>>,
    /// Encodings of a frame by rate and distortion.
    pub rates: Vec<Arc<RatePoint>>,
}

/// A benchmark that runs.
#[derive(Debug)]
pub struct RunningBenchmark {
    /// Name of the suite.
    pub suite: String,
    /// Progress of the benchmark.
    pub work: Work,
    label: Arc<Mutex<String>>,
    points: Arc<Mutex<Vec<Arc<LabPoint>>>>,
    rates: Arc<Mutex<Vec<Arc<RatePoint>>>>,
}

impl RunningBenchmark {
    /// Returns the label of the measurement in progress.
    pub fn label(&self) -> String {
        lock(&self.label).clone()
    }

    /// Returns the render modes whose time and error are known.
    pub fn points(&self) -> Vec<Arc<LabPoint>> {
        lock(&self.points).clone()
    }

    /// The encodings of a frame with known rate and distortion.
    pub fn rates(&self) -> Vec<Arc<RatePoint>> {
        lock(&self.rates).clone()
    }
}

impl Benchmark {
    /// Returns true if a benchmark is running.
    pub fn is_running(&self) -> bool {
        self.work().is_some()
    }

    /// Returns the running work.
    pub(in crate::app) fn work(&self) -> Option<&Work> {
        match self {
            Self::Running(running) => Some(&running.work),
            _ => None,
        }
    }

    /// Returns the render modes whose time and error are known.
    pub fn points(&self) -> Vec<Arc<LabPoint>> {
        match self {
            Self::Running(running) => running.points(),
            Self::Done(table) => table.points.clone(),
            Self::Cancelled(so_far) | Self::Failed(_, so_far) => so_far.points.clone(),
            Self::Idle => Vec::new(),
        }
    }

    /// The encodings of a frame with known rate and distortion.
    pub fn rates(&self) -> Vec<Arc<RatePoint>> {
        match self {
            Self::Running(running) => running.rates(),
            Self::Done(table) => table.rates.clone(),
            Self::Cancelled(so_far) | Self::Failed(_, so_far) => so_far.rates.clone(),
            Self::Idle => Vec::new(),
        }
    }

    /// Starts `job` at `now` unless one is running. `wake` is called whenever there is progress.
    pub(in crate::app) fn start<T: TaskOutcome + From<BenchmarkEnded>>(
        &mut self,
        suite: &str,
        job: BenchmarkJob,
        tasks: &Tasks<T>,
        wake: Wake,
        now: Duration,
    ) {
        if matches!(self, Self::Running(_)) {
            return;
        }
        let name = format!("Benchmark {suite}");
        let (work, progress) = Work::begin(WorkKind::Benchmark, name, now);
        let label = Arc::new(Mutex::new(String::new()));
        let points = Arc::new(Mutex::new(Vec::new()));
        let reported_label = Arc::clone(&label);
        let reported_points = Arc::clone(&points);
        let rates = Arc::new(Mutex::new(Vec::new()));
        let reported_rates = Arc::clone(&rates);
        tasks.start("benchmark", move || {
            let report = |step: Step| {
                match step.measured {
                    Some(Measured::Way(point)) => lock(&reported_points).push(point),
                    Some(Measured::Rate(point)) => lock(&reported_rates).push(point),
                    None => {}
                }
                *lock(&reported_label) = step.label;
                progress.set(step.done, step.total);
                wake();
            };
            BenchmarkEnded(job(&report, &progress))
        });
        *self = Self::Running(RunningBenchmark {
            suite: suite.to_owned(),
            work,
            label,
            points,
            rates,
        });
    }

    /// Takes the result of the thread.
    pub(in crate::app) fn finish(&mut self, BenchmarkEnded(result): BenchmarkEnded) {
        let cancelled = matches!(self, Self::Running(running) if running.work.progress().is_cancelled());
        let so_far = SoFar {
            points: self.points(),
            rates: self.rates(),
        };
        *self = match result {
            _ if cancelled => Self::Cancelled(so_far),
            Ok(table) => Self::Done(Box::new(table)),
            Err(text) => Self::Failed(text, so_far),
        };
    }
}

impl BenchmarkTable {
    /// The report in a format.
    pub(in crate::app) fn text_as(&self, format: ReportFormat) -> &str {
        match format {
            ReportFormat::Json => &self.json,
            ReportFormat::Csv => &self.csv,
            ReportFormat::Html => &self.html,
        }
    }

    fn of(measured: bench::Report) -> Self {
        Self {
            suite: measured.suite().name().to_owned(),
            adapter: measured.environment.adapter.clone(),
            tables: measured.tables(),
            notes: measured.notes.clone(),
            fastest: measured.fastest_strategy(),
            bars_title: measured.bars_title().to_owned(),
            bars: measured.bars(),
            json: measured.to_json(),
            csv: measured.to_csv(),
            html: if measured.points.is_empty() {
                String::new()
            } else {
                measured.to_html()
            },
            points: measured.points.into_iter().map(Arc::new).collect(),
            rates: measured.rates.into_iter().map(Arc::new).collect(),
        }
    }
}
