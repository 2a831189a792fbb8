//! Benchmarks of the open sequence, and their results on its render modes.

use super::BenchmarkEnded;
use super::ReportFormat;
use super::panel::{BenchmarkRequest, benchmark_ui};
use crate::app::command::{Command, Offer};
use crate::app::commands::common::Row;
use crate::app::features::benchmark::setup::setup_ui;
use crate::app::features::benchmark::{Benchmark, BenchmarkJob, BenchmarkSetup, benchmark_job};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::open_panels::PanelId;
use crate::app::panel_row::PanelRow;
use crate::app::state::{Dialog, State};
use crate::app::work::files::{save_bytes, with_extension};
use crate::app::work::outcome::Outcome;
use crate::bench::{LabPoint, Suite, suites};
use egui::Ui;
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// Measures the open sequence with the default options of a suite.
    pub fn start_default_benchmark(&mut self, suite: &'static Suite) {
        self.start_benchmark(BenchmarkSetup::new(suite));
    }

    /// Measures the open sequence on a thread; playing rests, it would disturb the measurement.
    pub fn start_benchmark(&mut self, setup: BenchmarkSetup) {
        let Some(player) = &mut self.player else {
            return;
        };
        if player.is_playing() {
            player.toggle(self.shared.now);
        }
        let sequence = Arc::clone(player.sequence());
        let shown = player.shown().map_or(0, |frame| frame.index);
        let name = self.sequence_name().unwrap_or_default();
        let job = benchmark_job(setup, name, sequence, shown);
        self.start_benchmark_job(setup.suite.name(), job);
    }

    /// Shows the benchmark window and runs `job` in it.
    pub fn start_benchmark_job(&mut self, suite: &str, job: BenchmarkJob) {
        self.panels.set(PanelId::BENCHMARK, true);
        let (wake, now) = (self.wake(), self.shared.now);
        self.features.benchmark.start(suite, job, &self.shared.tasks, wake, now);
    }

    /// Takes over the results of a benchmark of the open sequence, and stores them.
    pub(in crate::app) fn learn_quality(&mut self) {
        let Benchmark::Done(table) = &self.features.benchmark else {
            return;
        };
        let points: Vec<LabPoint> = table.points.iter().map(|point| (**point).clone()).collect();
        let is_of_open = self
            .sequence_name()
            .is_some_and(|name| points.first().is_some_and(|point| point.sequence == name));
        if is_of_open {
            self.features.quality.learn(&points);
        }
    }
}

fn suite_of(name: &str) -> Result<&'static Suite, String> {
    suites::named(name).map_err(|_| format!("unknown benchmark {name}"))
}

fn why_not_run(state: &State) -> Result<(), &'static str> {
    match (&state.player, state.features.benchmark.is_running()) {
        (None, _) => Err("Nothing is open yet"),
        (_, true) => Err("A benchmark is under way"),
        _ => Ok(()),
    }
}

const COMMANDS: &[Row] = &[
    Row::taking(Command::RUN_BENCHMARK, "Run a benchmark", "SUITE", |state, name| {
        state.start_default_benchmark(suite_of(name)?);
        Ok(())
    })
    .applies(why_not_run),
    Row::taking(
        Command::SET_UP_BENCHMARK,
        "Set up a benchmark",
        "SUITE",
        |state, name| {
            let suite = suite_of(name)?;
            let setup = state.features.benchmark_setup.filter(|setup| setup.suite == suite);
            // Another suite has other defaults; choices for the same one are kept.
            state.features.benchmark_setup = Some(setup.unwrap_or_else(|| BenchmarkSetup::new(suite)));
            state.panels.set(PanelId::BENCHMARK_SETUP, true);
            Ok(())
        },
    )
    .offers(|_, _| {
        let offer = |suite: &'static Suite| {
            Offer::new(format!("Benchmark: {}", suite.title), suite.name())
                .hint(suite.hint)
                .also(&["performance test", "measure speed", "profiling"])
        };
        suites::all().map(offer).collect()
    })
    .applies(why_not_run),
    Row::new(Command::panel(PanelId::BENCHMARK), "Show the last result", |state| {
        state.panels.toggle(PanelId::BENCHMARK);
    })
    .what("Benchmark: show the last result")
    .applies(|state| match state.features.benchmark {
        Benchmark::Idle => Err("Nothing was measured yet"),
        _ => Ok(()),
    }),
];

impl Feature<State> for FeatureOf<Benchmark> {
    fn update(&self, state: &mut State) -> bool {
        let now = state.now();
        if let Benchmark::Running(running) = &mut state.features.benchmark {
            running.work.look(now);
        }
        false
    }

    fn has_news(&self, state: &State) -> bool {
        state.features.benchmark.is_running()
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|ended: BenchmarkEnded| {
            state.features.benchmark.finish(ended);
            state.learn_quality();
        })
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::window(PanelId::BENCHMARK, benchmark)];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

impl Feature<State> for FeatureOf<Option<BenchmarkSetup>> {
    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::window(PanelId::BENCHMARK_SETUP, setup)];
        PANELS
    }
}

/// Shows the start dialog while it is open.
fn setup(ui: &mut Ui, state: &mut State) {
    let Some(mut setup) = state.features.benchmark_setup else {
        return;
    };
    let mut is_open = state.panels.has(PanelId::BENCHMARK_SETUP);
    let lack = why_not_run(state).err();
    let frame_count = state.player.as_ref().map_or(1, |player| player.sequence().len());
    let is_started = setup_ui(ui, &mut is_open, &mut setup, frame_count, lack);
    state.panels.set(PanelId::BENCHMARK_SETUP, is_open && !is_started);
    state.features.benchmark_setup = Some(setup);
    if is_started {
        state.start_benchmark(setup);
    }
}

fn benchmark(ui: &mut Ui, state: &mut State) {
    let now = state.now();
    let mut is_open = state.panels.has(PanelId::BENCHMARK);
    let request = benchmark_ui(
        ui,
        &mut is_open,
        &mut state.appearance.benchmark_place,
        &state.features.benchmark,
        now,
    );
    state.panels.set(PanelId::BENCHMARK, is_open);
    match request {
        Some(BenchmarkRequest::Save(format)) => state.ask_for_report(format),
        Some(BenchmarkRequest::DrawAs(way)) => state.draw_as_measured(&way.style),
        Some(BenchmarkRequest::Use(strategy)) => state.style.drawing.strategy = strategy,
        Some(BenchmarkRequest::ShowRetained(way)) => state.compare_with_retained(way.options.clone(), &way.label),
        None => {}
    }
}

impl State {
    /// Asks where to write the benchmark's result.
    pub(in crate::app) fn ask_for_report(&mut self, format: ReportFormat) {
        if let Benchmark::Done(table) = &self.features.benchmark {
            let name = format!("pointreel-{}.{}", table.suite, format.extension());
            let save = move |state: &mut Self, file| state.save_report(file, format);
            let dialog = Dialog::new_file("Save the benchmark", name, save);
            self.ask(dialog.filter(format.name(), [format.extension()]).of_own_work());
        }
    }

    /// Writes the benchmark's result to a file on a thread.
    pub(in crate::app) fn save_report(&mut self, file: PathBuf, format: ReportFormat) {
        let Benchmark::Done(table) = &self.features.benchmark else {
            return;
        };
        let text = table.text_as(format).to_owned();
        let file = with_extension(file, format.extension());
        self.shared
            .tasks
            .try_start("save file", move || save_bytes(file, text.as_bytes()));
    }
}
