//! Shared parts of the suites: choosing frames, placing viewpoints, progress, collecting rows.

use super::cover::Cover;
use super::report::{Row, SequenceSummary};
use super::runner::Runner;
use super::scenario::{self, Coverage, Viewpoint};
use super::statistics::mean;
use super::subject::{Subject, mean_position};
use super::{BenchError, BenchOptions, Environment, Input, LabPoint, Measured, RatePoint, Report, Step};
use crate::messages::frame_place;
use crate::progress::Progress;
use crate::render::AnyRenderer;
use crate::render::gpu::Context;
use crate::scene::{Background, Camera, Scene, Style};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, prepare};
use std::sync::Arc;

/// The two backgrounds that tell covered pixels from free ones.
pub(super) const COVERAGE_BACKGROUNDS: [[u8; 3]; 2] = [[0, 0, 0], [255, 255, 255]];

/// One run of a suite.
pub(super) struct Run<'a> {
    pub(super) options: &'a BenchOptions,
    /// The adapter if there is one, else the CPU.
    pub(super) runner: Runner,
    pub(super) progress: &'a Progress,
    inputs: &'a [Input],
    say: &'a dyn Fn(Step),
    report: Report,
    steps_done: usize,
    steps_total: usize,
}

impl<'a> Run<'a> {
    pub(super) fn new(
        inputs: &'a [Input],
        options: &'a BenchOptions,
        context: Option<&Arc<Context>>,
        say: &'a dyn Fn(Step),
        progress: &'a Progress,
    ) -> Result<Self, BenchError> {
        let renderer = match context {
            Some(context) => AnyRenderer::gpu(Arc::clone(context))?,
            None => AnyRenderer::cpu(),
        };
        Ok(Self {
            options,
            runner: Runner::new(renderer),
            inputs,
            say,
            progress,
            report: Report::new(options.clone(), Environment::detect(context.map(Arc::as_ref))),
            steps_done: 0,
            steps_total: 0,
        })
    }

    pub(super) fn into_report(self) -> Report {
        self.report
    }

    /// The sequences with the frames chosen from each. A run has `steps_per_frame` steps a frame.
    pub(super) fn subjects(&mut self, steps_per_frame: usize) -> Result<Vec<Subject<'a>>, BenchError> {
        let wanted = self.options.frames;
        let mut subjects = Vec::new();
        for Input { name, sequence, shape } in self.inputs {
            let first = self.options.first_frame;
            let chosen = spread(sequence.len(), first, wanted);
            if chosen.is_empty() {
                return Err(BenchError::Nothing(format!("{name} has no frames")));
            }
            self.steps_total += steps_per_frame * chosen.len();
            subjects.push(Subject {
                name,
                sequence,
                shape: *shape,
                chosen,
            });
        }
        Ok(subjects)
    }

    /// Adds steps to the step count, in addition to the frames' steps.
    pub(super) fn add_steps(&mut self, count: usize) {
        self.steps_total += count;
    }

    /// Fails once the run is cancelled.
    pub(super) fn check_cancelled(&self) -> Result<(), BenchError> {
        BenchError::check_cancelled(self.progress)
    }

    /// Progress that cancels the run.
    pub(super) fn progress(&self) -> &'a Progress {
        self.progress
    }

    /// Says something in the report.
    pub(super) fn note(&mut self, text: String) {
        self.report.notes.push(text);
    }

    /// Reports the next step.
    pub(super) fn begin_step(&mut self, label: String) -> Result<(), BenchError> {
        self.check_cancelled()?;
        (self.say)(Step {
            done: self.steps_done,
            total: self.steps_total,
            label,
            measured: None,
        });
        self.steps_done += 1;
        Ok(())
    }

    /// Shows a measurement before the run is over.
    pub(super) fn say_measured(&self, measured: impl Into<Measured>) {
        let measured = measured.into();
        (self.say)(Step {
            done: self.steps_done,
            total: self.steps_total,
            label: measured.label().to_owned(),
            measured: Some(measured),
        });
    }

    /// Decodes and prepares a frame on this thread. A frame that cannot be measured uses up its steps and returns why.
    pub(super) fn load(
        &mut self,
        subject: &Subject<'_>,
        index: usize,
        steps_per_frame: usize,
        needs: &Needs,
    ) -> Result<Result<PreparedFrame, String>, BenchError> {
        self.begin_step(format!("{}: preparing", subject.named(index)))?;
        let loaded = match subject.sequence.frame(index) {
            Ok(frame) if frame.is_empty() => {
                Err(format!("{} has no points", frame_place(index, subject.sequence.len())))
            }
            Ok(frame) => {
                let counters = PrepareCounters::default();
                Ok(prepare(index, Arc::new(frame), 0.0, needs, &counters))
            }
            Err(error) => Err(error.to_string()),
        };
        if let Err(reason) = &loaded {
            self.steps_done += steps_per_frame - 1;
            self.report.notes.push(format!("{}: skipped: {reason}", subject.name));
        }
        Ok(loaded)
    }

    /// Viewpoints around `frame`, each with the share of pixels that it covers when drawn by `style`. A note names
    /// those that could not be brought into the band.
    pub(super) fn viewpoints(
        &mut self,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        style: &Style,
    ) -> Result<Vec<Viewpoint>, BenchError> {
        let origin = subject.sequence.origin();
        let framing = Camera {
            target_in_world: origin + mean_position(frame.frame.positions()),
            ..subject.framing(frame)
        };
        let height_px = f64::from(self.options.viewport_px[1]);
        let mut viewpoints = Vec::new();
        for (azimuth_deg, elevation_deg) in scenario::directions(self.options.viewpoints) {
            let start = Camera {
                azimuth_deg,
                elevation_deg,
                ..framing
            };
            viewpoints.push(scenario::place(start, height_px, |camera| {
                self.cover(subject, frame, camera, style)
            })?);
        }
        let outside: Vec<String> = viewpoints
            .iter()
            .filter(|viewpoint| !viewpoint.is_in_band())
            .map(|Viewpoint { camera, coverage }| {
                format!(
                    "{:.1} % from azimuth {}°, elevation {}°",
                    coverage * 100.0,
                    camera.azimuth_deg,
                    camera.elevation_deg
                )
            })
            .collect();
        if !outside.is_empty() {
            self.report.notes.push(format!(
                "{}: no distance and aim was found at which coverage is in the band: {}",
                subject.named(frame.index),
                outside.join("; ")
            ));
        }
        Ok(viewpoints)
    }

    /// The pixels that `frame` covers.
    fn cover(
        &mut self,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        camera: &Camera,
        style: &Style,
    ) -> Result<Cover, BenchError> {
        self.check_cancelled()?;
        let mut scene = Scene::default();
        let mut on_background = |background| {
            let style = style.with(|style| style.backdrop.background = Background::solid(background));
            let packet = subject.packet(&mut scene, frame, camera, &style, self.options.viewport_px);
            self.runner.image(&packet)
        };
        let [first, second] = COVERAGE_BACKGROUNDS;
        let [on_first, on_second] = [on_background(first)?, on_background(second)?];
        Ok(Cover::of(&on_first, &on_second, COVERAGE_BACKGROUNDS))
    }

    /// Fails if no frame of a sequence could be measured, with the first reason.
    pub(super) fn check_measured(
        subject: &Subject<'_>,
        point_counts: &[f64],
        first_failure: Option<String>,
    ) -> Result<(), BenchError> {
        match first_failure {
            Some(reason) if point_counts.is_empty() => Err(BenchError::NoFrame {
                sequence: subject.name.to_owned(),
                reason,
            }),
            _ => Ok(()),
        }
    }

    /// Adds the measurements of a sequence.
    pub(super) fn finish(
        &mut self,
        subject: &Subject<'_>,
        point_counts: &[f64],
        coverages: &[f64],
        rows: impl IntoIterator<Item = Row>,
    ) {
        self.report.sequences.push(SequenceSummary {
            name: subject.name.to_owned(),
            frames: subject.sequence.len(),
            measured_frames: point_counts.len(),
            mean_points: mean(point_counts),
            coverage: Coverage::of(coverages),
        });
        self.add_rows(rows);
    }

    /// Adds rows that belong to no sequence.
    pub(super) fn add_rows(&mut self, rows: impl IntoIterator<Item = Row>) {
        self.report.rows.extend(rows);
    }

    /// Adds an encoding of a frame, by rate and distortion.
    pub(super) fn add_rate(&mut self, point: RatePoint) {
        self.report.rates.push(point);
    }

    /// Adds render modes by time and error.
    pub(super) fn add_points(&mut self, points: impl IntoIterator<Item = LabPoint>) {
        self.report.points.extend(points);
    }
}

/// `wanted` of `count` indices, evenly spread from `first` on and around the end; all of them if there are not more.
fn spread(count: usize, first: usize, wanted: usize) -> Vec<usize> {
    let chosen = wanted.min(count);
    (0..chosen)
        .map(|index| (first + index * count / chosen) % count)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_evenly() {
        assert_eq!(spread(24, 0, 4), [0, 6, 12, 18]);
        assert_eq!(spread(3, 0, 8), [0, 1, 2]);
        assert_eq!(spread(10, 0, 1), [0]);
        assert_eq!(spread(10, 7, 2), [7, 2]);
        assert_eq!(spread(0, 3, 4), [0usize; 0]);
    }
}
