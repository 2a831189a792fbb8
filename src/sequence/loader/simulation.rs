//! A loader whose threads are an abacus: jobs are taken as by workers, and take the time set by a test, by the test's
//! own clock.

use super::worker::{Finished, finish, make};
use super::{Loader, LoaderOptions};
use crate::sequence::{Detail, Sequence, Timings};
use std::sync::Arc;
use std::time::Duration;

use super::queue::Job;

/// Cost of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cost {
    pub(crate) decode_ms: f64,
    pub(crate) ns_per_point: f64,
}

/// Workers that do not exist.
pub(crate) struct Simulation {
    now: Duration,
    /// End time and result of each.
    workers: Vec<Option<(Duration, Job)>>,
    cost: Box<dyn Fn(usize) -> Cost>,
    points: usize,
}

impl Simulation {
    /// A loader for frames of `points` points, at the `cost` of their index, and its workers.
    pub(crate) fn new(
        sequence: &Arc<Sequence>,
        options: LoaderOptions,
        points: usize,
        cost: impl Fn(usize) -> Cost + 'static,
    ) -> (Loader, Self) {
        let workers = std::iter::repeat_with(|| None).take(options.workers);
        let simulation = Self {
            now: Duration::ZERO,
            workers: workers.collect(),
            cost: Box::new(cost),
            points,
        };
        sequence.origin();
        let loader = Loader::without_threads(Arc::clone(sequence), options).unwrap();
        (loader, simulation)
    }

    /// Time at which the next frame will be finished.
    pub(crate) fn next_event(&self) -> Option<Duration> {
        self.workers.iter().flatten().map(|&(at, _)| at).min()
    }

    /// Works until `now`.
    pub(crate) fn advance(&mut self, loader: &Loader, now: Duration) {
        loop {
            self.take_jobs(loader);
            let Some(next) = self.next_event().filter(|&at| at <= now) else {
                break;
            };
            self.now = next;
            let done = |worker: &&mut Option<(Duration, Job)>| worker.as_ref().is_some_and(|(at, _)| *at == next);
            let (_, job) = self.workers.iter_mut().find(done).and_then(Option::take).unwrap();
            self.finish(loader, &job);
        }
        self.now = now;
    }

    fn take_jobs(&mut self, loader: &Loader) {
        for number in 0..self.workers.len() {
            if self.workers[number].is_some() {
                continue;
            }
            let Some(job) = loader.shared.queue().next_job() else {
                return;
            };
            let timings = self.timings(&job);
            let takes = Duration::from_secs_f64(f64::from(timings.total_ms()) / 1e3);
            self.workers[number] = Some((self.now + takes, job));
        }
    }

    fn timings(&self, job: &Job) -> Timings {
        let cost = (self.cost)(job.index);
        let points = match job.detail {
            Detail::Full => self.points,
            detail @ Detail::AtMost(_) => detail.max_points().min(self.points),
        };
        let is_decoded = job.existing.is_none();
        Timings {
            decode_ms: if is_decoded { cost.decode_ms as f32 } else { 0.0 },
            analysis_ms: (cost.ns_per_point * points as f64 / 1e6) as f32,
            ..Timings::default()
        }
    }

    fn finish(&self, loader: &Loader, job: &Job) {
        let timings = self.timings(job);
        let outcome = make(&loader.shared, job).map(|made| {
            made.map(|mut made: Finished| {
                made.frame.timings = timings;
                made.decoder_ms = job.existing.is_none().then_some(timings.decode_ms);
                made
            })
        });
        match outcome.transpose() {
            None => loader.shared.queue().cancel(job.index),
            Some(outcome) => finish(&loader.shared, job.index, outcome.map_err(Arc::new)),
        }
    }
}
