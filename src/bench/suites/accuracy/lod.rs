//! Levels of detail by projected size: what a LOD threshold τ saves, and what it does to the picture.
//!
//! How it works: each frame is drawn as voxels from around it, as a whole and from farther away, once with all its leaves
//! (τ = 0, the truth) and once for each τ. PSNR is that of the mean squared error over all pictures. Most of a picture is
//! background, which is always right, so FLIP is given over the picture and over the pixels of the object: those that show it
//! in either picture, found by drawing on two backgrounds, so that no colour passes for background.
//!
//! All leaves are the truth about what the threshold leaves out, not about the surface: at a small δ nearly every point has a
//! leaf of its own, smaller than its share of the surface, and coarser cells close the gaps. So each picture is also compared
//! with that of surfels, which close the surface; part of that error is that cubes are shaded as cubes.

use super::{LOD, row, voxel_settings};
use crate::bench::report::{Cell, Row};
use crate::bench::runner::milliseconds_since;
use crate::bench::scenario;
use crate::bench::suites::{Run, Subject, mean, surfel_settings};
use crate::bench::{BenchError, Quantiles};
use crate::measure::{PIXELS_PER_DEGREE, Perceived, mean_squared_error, psnr_db};
use crate::octree::SelectView;
use crate::render::RenderError;
use crate::scene::{Background, Camera, Scene, Settings, UpAxis};
use crate::sequence::PreparedFrame;
use image::RgbaImage;
use std::hint::black_box;
use std::time::Instant;

/// LOD thresholds, pixels; the first is the truth.
const LOD_PX: [f32; 5] = [0.0, 1.0, 2.0, 4.0, 8.0];

/// Pictures are compared on the first, a grey of medium lightness; the second tells the object from it.
const BACKGROUNDS: [[u8; 3]; 2] = [[119; 3], [255; 3]];

/// How far the eye is, in distances from which the picture just holds the object.
pub(super) const DISTANCES: [f64; 2] = [1.0, 4.0];

/// What was measured of one sequence from one distance, for each of [`LOD_PX`].
#[derive(Default)]
pub(super) struct Samples([ThresholdSamples; LOD_PX.len()]);

/// One number for each picture, or for each traversal.
#[derive(Default)]
struct ThresholdSamples {
    drawn_voxels: Vec<f64>,
    visited_nodes: Vec<f64>,
    traverse_ms: Vec<f64>,
    object_share: Vec<f64>,
    squared_error: Vec<f64>,
    flip: Vec<f64>,
    flip_object: Vec<f64>,
    flip_max: f64,
    flip_surfels: Vec<f64>,
}

/// One view of a frame.
struct Picture {
    image: RgbaImage,
    perceived: Perceived,
    /// Which pixels show the object, row by row.
    shows_object: Vec<bool>,
}

impl Samples {
    pub(super) fn measure(
        &mut self,
        run: &mut Run<'_>,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        distance: f64,
    ) -> Result<(), BenchError> {
        let origin = subject.sequence.origin();
        let framing = Camera::framing(&frame.frame.bounds(), origin, UpAxis::guess(&frame.frame));
        let cameras: Vec<Camera> = scenario::directions(run.options.viewpoints)
            .map(|(azimuth_deg, elevation_deg)| Camera {
                azimuth_deg,
                elevation_deg,
                distance: distance * framing.distance,
                ..framing
            })
            .collect();
        for camera in &cameras {
            let mut draw = |settings| draw(run, subject, frame, camera, settings);
            let surfels = draw(surfel_settings())?;
            let truth = draw(voxel_settings(LOD_PX[0]))?;
            self.0[0].add(&truth, &surfels)?;
            for (lod_px, samples) in LOD_PX.into_iter().zip(&mut self.0).skip(1) {
                let picture = draw(voxel_settings(lod_px))?;
                samples.add(&picture, &surfels)?;
                samples.compare(&picture, &truth)?;
            }
        }
        for (lod_px, samples) in LOD_PX.into_iter().zip(&mut self.0) {
            samples.time_traversals(run, subject, frame, &cameras, lod_px)?;
        }
        Ok(())
    }

    pub(super) fn rows(&self, sequence: &str, distance: f64) -> impl Iterator<Item = Row> {
        let rows = LOD_PX.into_iter().zip(&self.0);
        rows.map(move |(lod_px, samples)| samples.row(sequence, distance, lod_px))
    }
}

fn draw(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    camera: &Camera,
    settings: Settings,
) -> Result<Picture, BenchError> {
    run.check_cancelled()?;
    // One traversal for both backgrounds.
    let mut scene = Scene::default();
    let mut on_background = |background| -> Result<RgbaImage, RenderError> {
        let settings = Settings {
            background: Background::solid(background),
            ..settings
        };
        let origin = subject.sequence.origin();
        let packet = scene.packet(frame, origin, camera, &settings, run.options.viewport_px);
        run.runner.image(&packet)
    };
    let [first, second] = BACKGROUNDS;
    let [image, on_second] = [on_background(first)?, on_background(second)?];
    let shows_object = image
        .pixels()
        .zip(on_second.pixels())
        .map(|(on_first, on_second)| on_first.0[..3] != first || on_second.0[..3] != second)
        .collect();
    Ok(Picture {
        perceived: Perceived::of(&image, PIXELS_PER_DEGREE),
        image,
        shows_object,
    })
}

impl Picture {
    /// FLIP of this picture where `truth` is right: over all pixels, over those that show the object in either, and the
    /// largest.
    fn flip(&self, truth: &Self) -> Result<[f64; 3], BenchError> {
        let map = truth.perceived.flip(&self.perceived)?;
        let is_object = |pixel: usize| truth.shows_object[pixel] || self.shows_object[pixel];
        Ok([map.mean(), map.mean_where(is_object), f64::from(map.max())])
    }
}

impl ThresholdSamples {
    fn add(&mut self, picture: &Picture, surfels: &Picture) -> Result<(), BenchError> {
        let shows_object = &picture.shows_object;
        let covered = shows_object.iter().filter(|&&shows| shows).count();
        self.object_share
            .push(covered as f64 / shows_object.len().max(1) as f64);
        let [_, object, _] = picture.flip(surfels)?;
        self.flip_surfels.push(object);
        Ok(())
    }

    fn compare(&mut self, picture: &Picture, truth: &Picture) -> Result<(), BenchError> {
        self.squared_error
            .push(mean_squared_error(&truth.image, &picture.image)?);
        let [whole, object, largest] = picture.flip(truth)?;
        self.flip.push(whole);
        self.flip_object.push(object);
        self.flip_max = self.flip_max.max(largest);
        Ok(())
    }

    /// Each traversal fills memory that the one before it left, as playing does.
    fn time_traversals(
        &mut self,
        run: &Run<'_>,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        cameras: &[Camera],
        lod_px: f32,
    ) -> Result<(), BenchError> {
        let Some(octree) = &frame.octree else {
            return Ok(());
        };
        let mut voxels = Vec::new();
        for round in 0..run.options.warmup + run.options.repeat {
            for camera in cameras {
                run.check_cancelled()?;
                let view = camera.transform(subject.sequence.origin(), run.options.viewport_px);
                let start = Instant::now();
                let select_view = SelectView {
                    frustum: view.frustum_in_frame(),
                    eye: view.eye_high,
                    pixels_per_unit_at_1: view.pixels_per_unit_at_1,
                    lod_px,
                };
                let selected = octree.select(&select_view, black_box(&mut voxels));
                let traverse_ms = milliseconds_since(start);
                if round >= run.options.warmup {
                    self.traverse_ms.push(traverse_ms);
                    self.visited_nodes.push(selected.visited_nodes as f64);
                    self.drawn_voxels.push(selected.emitted as f64);
                }
            }
        }
        Ok(())
    }

    fn row(&self, sequence: &str, distance: f64, lod_px: f32) -> Row {
        let traverse = Quantiles::of(&self.traverse_ms);
        let is_compared = !self.flip.is_empty();
        let if_compared = |error: f64| Cell::maybe(is_compared.then_some(error));
        // Of equal pictures it is infinite, which JSON cannot say.
        let ratio_db = Some(psnr_db(mean(&self.squared_error))).filter(|ratio| ratio.is_finite());
        row(
            LOD,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("lod_px", Cell::Number(f64::from(lod_px))),
                ("distance", Cell::Number(distance)),
                ("drawn_voxels", Cell::Number(mean(&self.drawn_voxels))),
                ("visited_nodes", Cell::Number(mean(&self.visited_nodes))),
                (
                    "traverse_ms_median",
                    Cell::maybe(traverse.map(|q| q.median)),
                ),
                ("traverse_ms_q1", Cell::maybe(traverse.map(|q| q.q1))),
                ("traverse_ms_q3", Cell::maybe(traverse.map(|q| q.q3))),
                ("object_share", Cell::Number(mean(&self.object_share))),
                ("psnr_db", Cell::maybe(ratio_db)),
                ("flip_mean", if_compared(mean(&self.flip))),
                ("flip_object_mean", if_compared(mean(&self.flip_object))),
                ("flip_max", if_compared(self.flip_max)),
                ("flip_surfels_mean", Cell::Number(mean(&self.flip_surfels))),
                ("pictures", Cell::Number(self.object_share.len() as f64)),
            ],
        )
    }
}
