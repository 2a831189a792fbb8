//! The loops of the suites, and what they share: choosing frames, placing viewpoints, progress, collecting rows.

pub(super) mod accuracy;
pub(super) mod draw;
pub(super) mod error;
pub(super) mod octree;
pub(super) mod play;
pub(super) mod render;
mod traversals;
pub(super) mod window;

use super::cover::Cover;
use super::report::{Row, SequenceSummary};
use super::runner::Runner;
use super::scenario::{self, Coverage, Viewpoint};
use super::{
    BenchError, BenchOptions, Environment, Input, LabPoint, Report, Step, check_cancelled,
};
use crate::levels::octree::StopCriterion;
use crate::progress::Progress;
use crate::render::AnyRenderer;
use crate::render::gpu::Context;
use crate::scene::{
    Backdrop, Background, Camera, FirstLook, LevelStyle, Primitive, Scene, Splatting, Style,
    SurfelStyle, VoxelLight, VoxelStyle,
};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The two backgrounds that tell covered pixels from free ones.
const COVERAGE_BACKGROUNDS: [[u8; 3]; 2] = [[0, 0, 0], [255, 255, 255]];

/// One run of a suite.
pub(super) struct Run<'a> {
    pub(super) options: &'a BenchOptions,
    /// The adapter if there is one, else the processor.
    pub(super) runner: Runner,
    inputs: &'a [Input],
    say: &'a dyn Fn(Step),
    progress: &'a Progress,
    report: Report,
    steps_done: usize,
    steps_total: usize,
}

/// How Table II draws, and by what the viewpoints of Table III are placed, which draws nothing.
fn surfel_settings() -> Style {
    Style {
        primitive: Primitive::Surfel,
        surfels: SurfelStyle {
            splatting: Splatting::TwoPassEnlarged,
            enlargement: 2.0,
            ..SurfelStyle::default()
        },
        ..Style::default()
    }
}

/// How Table IV draws: cells of the paper's δ, lit by their faces.
fn paper_voxel_settings() -> Style {
    Style {
        primitive: Primitive::Voxel,
        voxels: VoxelStyle {
            light: VoxelLight::Faces,
        },
        levels: LevelStyle {
            stop: StopCriterion::PAPER,
            ..LevelStyle::default()
        },
        ..Style::default()
    }
}

/// One sequence of a run.
pub(super) struct Subject<'a> {
    pub(super) name: &'a str,
    pub(super) sequence: &'a Arc<Sequence>,
    pub(super) shape: Option<Shape>,
    /// Indices of the frames to measure.
    pub(super) chosen: Vec<usize>,
}

impl Subject<'_> {
    /// The whole of `frame`, upright.
    fn framing(&self, frame: &PreparedFrame) -> Camera {
        let origin = self.sequence.origin();
        let up = FirstLook::of(&[&frame.frame], origin).up;
        Camera::framing(&frame.frame.bounds(), origin, up)
    }

    /// `count` views of it from all around, so many times as far away.
    fn views(&self, frame: &PreparedFrame, count: usize, distance: f64) -> Vec<Camera> {
        let framing = self.framing(frame);
        let view = |(azimuth_deg, elevation_deg)| Camera {
            azimuth_deg,
            elevation_deg,
            distance: distance * framing.distance,
            ..framing
        };
        scenario::directions(count).map(view).collect()
    }
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
            report: Report::new(
                options.clone(),
                Environment::detect(context.map(Arc::as_ref)),
            ),
            steps_done: 0,
            steps_total: 0,
        })
    }

    pub(super) fn into_report(self) -> Report {
        self.report
    }

    /// The sequences with the frames chosen from each. A run has `steps_per_frame` steps a frame.
    pub(super) fn subjects(
        &mut self,
        steps_per_frame: usize,
    ) -> Result<Vec<Subject<'a>>, BenchError> {
        let wanted = self.options.frames;
        let mut subjects = Vec::new();
        for Input {
            name,
            sequence,
            shape,
        } in self.inputs
        {
            let chosen = spread(sequence.len(), wanted);
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

    /// Fails once the run is cancelled.
    pub(super) fn check_cancelled(&self) -> Result<(), BenchError> {
        check_cancelled(self.progress)
    }

    /// Says what comes next.
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

    /// Shows what was measured before the run is over.
    pub(super) fn say_measured(&self, point: LabPoint) {
        (self.say)(Step {
            done: self.steps_done,
            total: self.steps_total,
            label: point.label.clone(),
            measured: Some(Arc::new(point)),
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
        self.begin_step(format!("{} frame {index}: preparing", subject.name))?;
        let loaded = match subject.sequence.frame(index) {
            Ok(frame) if frame.is_empty() => Err(format!("frame {index} has no points")),
            Ok(frame) => {
                let counters = PrepareCounters::default();
                Ok(prepare(index, Arc::new(frame), 0.0, needs, &counters))
            }
            Err(error) => Err(error.to_string()),
        };
        if let Err(reason) = &loaded {
            self.steps_done += steps_per_frame - 1;
            self.report
                .notes
                .push(format!("{}: skipped: {reason}", subject.name));
        }
        Ok(loaded)
    }

    /// Viewpoints around `frame`, each with the share of pixels that it covers when drawn by `settings`. A note names
    /// those that could not be brought into the band.
    pub(super) fn viewpoints(
        &mut self,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        settings: &Style,
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
                self.cover(subject, frame, camera, settings)
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
                "{} frame {}: no distance and aim was found at which coverage is in the band: {}",
                subject.name,
                frame.index,
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
        settings: &Style,
    ) -> Result<Cover, BenchError> {
        self.check_cancelled()?;
        let origin = subject.sequence.origin();
        let mut scene = Scene::default();
        let mut on_background = |background| {
            let settings = Style {
                backdrop: Backdrop {
                    background: Background::solid(background),
                    ..settings.backdrop
                },
                ..*settings
            };
            let packet = scene.packet(frame, origin, camera, &settings, self.options.viewport_px);
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

    /// Adds what was measured of a sequence.
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
        self.report.rows.extend(rows);
    }
}

/// `wanted` of `count` indices, evenly spread from the first; all of them if there are not more.
fn spread(count: usize, wanted: usize) -> Vec<usize> {
    let chosen = wanted.min(count);
    (0..chosen).map(|index| index * count / chosen).collect()
}

/// Middle of the mass of points; the origin without points.
fn mean_position(positions: &[Vec3]) -> DVec3 {
    let sum: DVec3 = positions.iter().map(|position| position.as_dvec3()).sum();
    sum / positions.len().max(1) as f64
}

/// Arithmetic mean; 0 without values.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_mass_is_where_most_points_are() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::X, Vec3::new(2.0, 4.0, 0.0)];
        assert_eq!(mean_position(&positions), DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(mean_position(&[]), DVec3::ZERO);
    }

    #[test]
    fn frames_are_spread_evenly() {
        assert_eq!(spread(24, 4), [0, 6, 12, 18]);
        assert_eq!(spread(3, 8), [0, 1, 2]);
        assert_eq!(spread(10, 1), [0]);
        assert_eq!(spread(0, 4), [0usize; 0]);
    }
}
