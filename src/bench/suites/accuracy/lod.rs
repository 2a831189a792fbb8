//! Levels of detail by projected size: the savings of a LOD threshold τ, and its effect on the image.
//!
//! How it works: each frame is drawn as voxels from around it, as a whole and from farther away, once with all its
//! leaves (τ = 0, the ground truth) and once for each τ. PSNR is computed from the mean squared error over all images.
//! Most of an image is background, which is always right, so FLIP is given over the image and over the pixels that show
//! the object in either image. The camera then turns by half a degree: how much the change from one image to the next
//! differs from that of all leaves is the error over time.
//!
//! All leaves are the ground truth for the omissions of the threshold, not for the surface: at a small δ nearly every
//! point has its own leaf, smaller than its share of the surface, and coarser cells close the gaps. So each image is
//! also compared with an image of surfels, which close the surface; part of that error is that cubes are shaded as
//! cubes.

use super::columns::{LOD, row};
use super::pictures::{DrawnView, ObjectPart, draw, parts};
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suites::error::turned;
use crate::bench::suites::error::view::of_change;
use crate::bench::suites::paper_style::{surfel_style, voxel_style_at};
use crate::bench::suites::traversals::Traversals;
use crate::bench::{BenchError, Quantiles};
use crate::measure::psnr_db;
use crate::sequence::PreparedFrame;

/// LOD thresholds, pixels; the first is the truth.
const LOD_PX: [f32; 5] = [0.0, 1.0, 2.0, 4.0, 8.0];

/// Eye distances, as multiples of the distance from which the object just fits the image.
pub(super) const DISTANCES: [f64; 2] = [1.0, 4.0];

/// Measurements of one sequence from one distance, for each of [`LOD_PX`].
#[derive(Default)]
pub(super) struct LodSamples([ThresholdSamples; LOD_PX.len()]);

/// One number for each image, or for each traversal.
#[derive(Default)]
struct ThresholdSamples {
    traversals: Traversals,
    object_share: Vec<f64>,
    squared_error: Vec<f64>,
    flip: Vec<f64>,
    flip_object: Vec<f64>,
    flip_max: f64,
    flip_over_time: Vec<f64>,
    flip_surfels: Vec<f64>,
}

impl LodSamples {
    pub(super) fn measure(
        &mut self,
        run: &mut Run<'_>,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        distance: f64,
    ) -> Result<(), BenchError> {
        let cameras = subject.views(frame, run.options.viewpoints, distance);
        for camera in &cameras {
            let next_camera = turned(*camera, 1);
            let of_next = LOD_PX.map(|lod_px| (&next_camera, voxel_style_at(lod_px)));
            let of_this = LOD_PX.map(|lod_px| (camera, voxel_style_at(lod_px)));
            let drawings: Vec<DrawnView> = std::iter::once((camera, surfel_style()))
                .chain(of_this)
                .chain(of_next)
                .map(|(camera, style)| draw(run, subject, frame, camera, style))
                .collect::<Result<_, _>>()?;
            let pictures: Vec<ObjectPart> = parts(&drawings).collect();
            let (surfels, pictures) = (&pictures[0], &pictures[1..]);
            let (pictures, next) = pictures.split_at(LOD_PX.len());
            for (index, samples) in self.0.iter_mut().enumerate() {
                samples.add(&pictures[index], surfels)?;
                if index > 0 {
                    samples.compare([&pictures[index], &next[index]], [&pictures[0], &next[0]])?;
                }
            }
        }
        for (lod_px, samples) in LOD_PX.into_iter().zip(&mut self.0) {
            if let Some(octree) = frame.levels.octree() {
                let traversals = &mut samples.traversals;
                traversals.measure(run, subject, octree, &cameras, lod_px, None)?;
            }
        }
        Ok(())
    }

    pub(super) fn rows(&self, sequence: &str, distance: f64) -> impl Iterator<Item = Row> {
        let rows = LOD_PX.into_iter().zip(&self.0);
        rows.map(move |(lod_px, samples)| samples.row(sequence, distance, lod_px))
    }
}

impl ThresholdSamples {
    fn add(&mut self, picture: &ObjectPart, surfels: &ObjectPart) -> Result<(), BenchError> {
        self.object_share.push(picture.object_share());
        let error = picture.compare(surfels)?;
        self.flip_surfels.push(error.flip_object_mean);
        Ok(())
    }

    /// Compares two consecutive images with the truth of both.
    fn compare(&mut self, pictures: [&ObjectPart; 2], truths: [&ObjectPart; 2]) -> Result<(), BenchError> {
        let change = of_change(pictures.map(ObjectPart::image), truths.map(|truth| Some(truth.image())))?;
        self.flip_over_time.push(change.flip);
        let error = pictures[0].compare(truths[0])?;
        self.squared_error.push(error.squared);
        self.flip.push(error.flip_mean);
        self.flip_object.push(error.flip_object_mean);
        self.flip_max = self.flip_max.max(error.flip_max);
        Ok(())
    }

    fn row(&self, sequence: &str, distance: f64, lod_px: f32) -> Row {
        let traverse = Quantiles::of(&self.traversals.times_ms);
        let is_compared = !self.flip.is_empty();
        let if_compared = |error: f64| Cell::maybe(is_compared.then_some(error));
        // For identical images it is infinite, which JSON cannot represent.
        let ratio_db = Some(psnr_db(mean(&self.squared_error))).filter(|ratio| ratio.is_finite());
        row(
            LOD,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("lod_px", Cell::Number(f64::from(lod_px))),
                ("distance", Cell::Number(distance)),
                ("drawn_voxels", Cell::Number(mean(&self.traversals.emitted_voxels))),
                ("visited_nodes", Cell::Number(mean(&self.traversals.visited_nodes))),
                ("traverse_ms_median", Cell::maybe(traverse.map(|q| q.median))),
                ("traverse_ms_q1", Cell::maybe(traverse.map(|q| q.q1))),
                ("traverse_ms_q3", Cell::maybe(traverse.map(|q| q.q3))),
                ("object_share", Cell::Number(mean(&self.object_share))),
                ("psnr_db", Cell::maybe(ratio_db)),
                ("flip_mean", if_compared(mean(&self.flip))),
                ("flip_object_mean", if_compared(mean(&self.flip_object))),
                ("flip_max", if_compared(self.flip_max)),
                ("flip_over_time", if_compared(mean(&self.flip_over_time))),
                ("flip_surfels_mean", Cell::Number(mean(&self.flip_surfels))),
                ("pictures", Cell::Number(self.object_share.len() as f64)),
            ],
        )
    }
}
