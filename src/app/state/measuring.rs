//! Benchmarks of the open sequence, and what they have found of its ways to draw.

use super::State;
use crate::app::features::benchmark::{Benchmark, BenchmarkJob, benchmark_job};
use crate::app::open_panels::PanelId;
use crate::bench::{LabPoint, Suite};
use std::sync::Arc;

impl State {
    /// Measures the open sequence on a thread; playing rests, it would disturb the measurement.
    pub fn start_benchmark(&mut self, suite: &'static Suite) {
        let Some(player) = &mut self.player else {
            return;
        };
        if player.is_playing() {
            player.toggle(self.now);
        }
        let sequence = Arc::clone(player.sequence());
        let shown = player.shown().map_or(0, |frame| frame.index);
        let name = self.sequence_name().unwrap_or_default();
        self.start_benchmark_job(suite.name(), benchmark_job(suite, name, sequence, shown));
    }

    /// Shows the benchmark window and runs `job` in it.
    pub fn start_benchmark_job(&mut self, suite: &str, job: BenchmarkJob) {
        self.panels.set(PanelId::BENCHMARK, true);
        let at = (self.wake(), self.now);
        self.benchmark.start(suite, job, &self.tasks, at);
    }

    /// Reads what was measured of the open sequence before. True if there is something.
    pub(super) fn look_for_quality(&mut self) -> bool {
        let Some(player) = &self.player else {
            return false;
        };
        self.quality.look(&self.graphics.adapter, player.sequence())
    }

    /// Takes over what a benchmark has found of the open sequence, and keeps it.
    pub(super) fn learn_quality(&mut self) {
        let Benchmark::Done(table) = &self.benchmark else {
            return;
        };
        let points: Vec<LabPoint> = table.points.iter().map(|point| (**point).clone()).collect();
        let is_of_open = self
            .sequence_name()
            .is_some_and(|name| points.first().is_some_and(|point| point.sequence == name));
        if is_of_open {
            self.quality.learn(&points);
        }
    }
}
