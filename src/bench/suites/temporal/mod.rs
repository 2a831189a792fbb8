//! Temporal error: flicker, crawling and popping that are not in the scene.
//!
//! How it works: short scenes with known changes are drawn image by image, as in playback, and the change from one
//! image to the next is compared with the truth's ([`TemporalError`]). A render mode with the same fault in every image
//! has no temporal error; the error lab has its spatial one.
//!
//! Scenes at rest have a change of zero, so the background is the only assumption. Truths of moving scenes are
//! ray-traced (`render/truth`).

mod scenes;
mod variants;

use super::error::variants::{label, selected};
use super::error::view::of_change;
use crate::bench::BenchError;
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::bench::truth_cache::TruthCache;
use crate::measure::TemporalError;
use crate::render::AnyRenderer;
use crate::scene::{RendererChoice, Scene, Settings, Style};
use crate::sequence::{PrepareCounters, complete};
use image::RgbaImage;
use scenes::{Picture, SceneKind, Scenes};

/// Columns, in the order in which [`Samples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("scene", "scene"),
    Column::text("way", "mode"),
    Column::text("renderer", "renderer").hidden(),
    Column::text("truth", "truth"),
    Column::number("points", "points", 0),
    Column::number("flip_over_time", "FLIP over time", 4),
    Column::percent("difference_rms", "difference", 2),
    Column::number("flip_over_time_max", "most", 4),
    Column::number("steps", "steps", 0),
];

/// Temporal error of render modes, by scene.
pub const TEMPORAL: &Suite = &Suite {
    name: "temporal",
    brief: "flicker of each render mode, from image to image",
    title: "Flicker",
    hint: "Error of the change from image to image: scenes at rest, a camera that turns, shapes that move",
    description: "temporal error: the change from one image to the next compared with that of the truth",
    measured: "over the pixels that show the object in one of the images: mean absolute difference between the FLIP of \
        two consecutive images and that of the truth (FLIP over time, 0 to 1; most: the worst step), and root mean \
        square of the difference of their difference images (share of a channel's range). Scenes of shapes: one point \
        moves outside the image, the shape is sampled again in every frame, the same of a quarter of the points, the \
        shape moves by a third of the spacing of its points; of any input: the camera turns by half a degree, and its \
        next frames where the truth is not known, so that their motion counts as well",
    not_measured: "time; errors that are the same in every image (see error)",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [640, 480],
        viewpoints: 2,
        frames: 1,
    },
    takes: &[OptionGroup::Modes],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "flip_over_time",
    bars_title: "FLIP over time, 0 to 1",
    bar_labels: 3,
};

/// Measurements of one mode in one scene.
#[derive(Default)]
struct Samples {
    points: Vec<f64>,
    errors: Vec<TemporalError>,
}

/// Renderers: always the CPU, and an adapter if there is one.
struct Runners {
    processor: Runner,
    cache: TruthCache,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let variants = selected(run, variants::variants(!run.runner.is_processor()))?;
    let mut runners = Runners {
        processor: Runner::new(AnyRenderer::cpu()),
        cache: TruthCache::new(run.options.truth_folder.clone()),
    };
    // One step to prepare the first frame.
    for subject in run.subjects(1)? {
        measure_sequence(run, &mut runners, &subject, &variants)?;
    }
    Ok(())
}

fn measure_sequence(
    run: &mut Run<'_>,
    runners: &mut Runners,
    subject: &Subject<'_>,
    variants: &[Settings],
) -> Result<(), BenchError> {
    let scenes = match Scenes::new(run, &runners.cache, subject)? {
        Ok(scenes) => scenes,
        Err(reason) => return Run::check_measured(subject, &[], Some(reason)),
    };
    let kinds = SceneKind::of(subject);
    run.add_steps(kinds.len() * (1 + variants.len()));
    let mut rows = Vec::new();
    for kind in kinds {
        run.begin_step(format!("{}: {}", subject.name, kind.name()))?;
        let pictures = scenes.pictures(run, kind)?;
        if pictures.views.iter().all(Vec::is_empty) {
            run.note(format!("{}: {}: skipped", subject.name, kind.name()));
            continue;
        }
        for way in variants {
            run.begin_step(format!("{}: {}: {}", subject.name, kind.name(), label(way)))?;
            let mut samples = Samples::default();
            for view in &pictures.views {
                samples.measure(run, &mut runners.processor, subject, view, &way.decided())?;
            }
            rows.push(samples.row([subject.name, kind.name(), pictures.truth], way));
        }
    }
    run.finish(subject, &[scenes.point_count() as f64], &[], rows);
    Ok(())
}

impl Samples {
    /// Draws the images of one view and compares each with the one before it.
    fn measure(
        &mut self,
        run: &mut Run<'_>,
        processor: &mut Runner,
        subject: &Subject<'_>,
        pictures: &[Picture],
        way: &Style,
    ) -> Result<(), BenchError> {
        let progress = run.progress();
        let viewport_px = run.options.viewport_px;
        let runner = if way.drawing.renderer == RendererChoice::Gpu {
            &mut run.runner
        } else {
            processor
        };
        // One scene: it remembers the same state of the previous image as in a window.
        let mut scene = Scene::default();
        let mut before: Option<(RgbaImage, &Picture)> = None;
        for picture in pictures {
            BenchError::check_cancelled(progress)?;
            let frame = complete(&picture.frame, &Scene::needs(way), &PrepareCounters::default());
            let packet = subject.packet(&mut scene, &frame, &picture.camera, way, viewport_px);
            let image = runner.image(&packet)?;
            self.points.push(frame.points.len() as f64);
            if let Some((image_before, picture_before)) = &before {
                self.errors.push(of_change(
                    [image_before, &image],
                    [picture_before, picture].map(|picture| picture.truth.as_ref()),
                )?);
            }
            before = Some((image, picture));
        }
        Ok(())
    }

    fn row(&self, [sequence, scene, truth]: [&str; 3], way: &Settings) -> Row {
        let mean_of = |value: fn(&TemporalError) -> f64| mean(&self.errors.iter().map(value).collect::<Vec<_>>());
        let squared = mean_of(|error| error.difference_rms.powi(2));
        let largest = self.errors.iter().map(|error| error.flip).fold(0.0, f64::max);
        Row::new(vec![
            Cell::Text(sequence.to_owned()),
            Cell::Text(scene.to_owned()),
            Cell::Text(label(way)),
            Cell::Text(way.decided().drawing.renderer.to_string()),
            Cell::Text(truth.to_owned()),
            Cell::Number(mean(&self.points)),
            Cell::Number(mean_of(|error| error.flip)),
            Cell::Number(squared.sqrt()),
            Cell::Number(largest),
            Cell::Number(self.errors.len() as f64),
        ])
    }
}
