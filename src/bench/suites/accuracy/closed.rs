//! Voxels compared with surfels: the surface that both close, the excess of voxels, and the similarity of images.
//!
//! How it works: each frame is drawn from around it as surfels, from both sides, and as voxels: with the paper's δ,
//! whose cells are smaller than the spacing of the points, and with leaves as large as the spacing, lit by their faces
//! and by normals. Surfels are the reference, since they are made to close the surface.

use super::columns::{CLOSED, row};
use super::pictures::{DrawnView, draw, parts};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suites::paper_style::voxel_style;
use crate::levels::octree::StopCriterion;
use crate::scene::{BackFaces, Scene, Style, VoxelLight};
use crate::sequence::{PrepareCounters, PreparedFrame, complete};

/// Returns the render modes for voxels, and the words for them.
fn variants() -> [(&'static str, Style); 3] {
    let paper = voxel_style();
    let stop = StopCriterion::Spacing;
    let faces = paper.with(|style| style.levels.stop = stop);
    let voxel_light = VoxelLight::Normals;
    let normals = faces.with(|style| style.voxels.light = voxel_light);
    [("δ 5 %", paper), ("spacing", faces), ("spacing, normals", normals)]
}

/// Measurements of one sequence, for each of [`variants`].
#[derive(Default)]
pub(super) struct ClosedSamples([WaySamples; 3]);

/// One number for each image.
#[derive(Default)]
struct WaySamples {
    drawn: Vec<f64>,
    covered: Vec<f64>,
    outside: Vec<f64>,
    flip: Vec<f64>,
}

impl ClosedSamples {
    pub(super) fn measure(
        &mut self,
        run: &mut Run<'_>,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
    ) -> Result<(), BenchError> {
        let surfels = Style::default().with(|style| style.surfels.back_faces = BackFaces::Drawn);
        let variants = variants().map(|(_, style)| {
            let needs = Scene::needs(&style);
            let frame = complete(frame, &needs, &PrepareCounters::default());
            (frame, style)
        });
        for camera in subject.views(frame, run.options.viewpoints, 1.0) {
            let mut drawings: Vec<DrawnView> = vec![draw(run, subject, frame, &camera, surfels)?];
            for (frame, style) in &variants {
                drawings.push(draw(run, subject, frame, &camera, *style)?);
            }
            let mut pictures = parts(&drawings);
            let Some(surfels) = pictures.next() else {
                continue;
            };
            for ((picture, samples), (frame, style)) in pictures.zip(&mut self.0).zip(&variants) {
                let [covered, outside] = picture.shares_of(&surfels);
                samples.covered.push(covered);
                samples.outside.push(outside);
                samples.flip.push(picture.compare(&surfels)?.flip_object_mean);
                let viewport_px = run.options.viewport_px;
                let packet = subject.packet(&mut Scene::default(), frame, &camera, style, viewport_px);
                samples.drawn.push(packet.content.record_count() as f64);
            }
        }
        Ok(())
    }

    pub(super) fn rows(&self, sequence: &str) -> impl Iterator<Item = Row> {
        variants().into_iter().zip(&self.0).map(move |((way, _), samples)| {
            row(
                CLOSED,
                &[
                    ("sequence", Cell::Text(sequence.to_owned())),
                    ("way", Cell::Text(way.to_owned())),
                    ("drawn_voxels", Cell::Number(mean(&samples.drawn))),
                    ("covered", Cell::Number(mean(&samples.covered))),
                    ("outside", Cell::Number(mean(&samples.outside))),
                    ("flip_surfels_mean", Cell::Number(mean(&samples.flip))),
                    ("pictures", Cell::Number(samples.flip.len() as f64)),
                ],
            )
        })
    }
}
