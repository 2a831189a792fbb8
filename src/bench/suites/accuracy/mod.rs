//! Accuracy of the stages against the ground truth, together with their cost: normals, octrees and levels of detail.
//!
//! | table | truth | error |
//! |---|---|---|
//! | [`normals`] | shapes with known normals, noise and outliers | angle, by number of neighbours and fitting method |
//! | [`leaves`] | the points of each sequence | distance of a point to the centre of its leaf, by δ |
//! | [`lod`] | images of all leaves, τ = 0, and of surfels | PSNR and FLIP, by LOD threshold τ |
//! | [`closed`] | images of surfels | coverage by voxels inside and outside of them, and FLIP, by δ and light |

mod closed;
mod columns;
mod leaves;
mod lod;
mod normals;
mod pictures;

use super::paper_style::voxel_style_at;
use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::scene::Scene;
use crate::sequence::Needs;

/// Errors of normals, octrees and levels of detail.
pub const ACCURACY: &Suite = &Suite {
    name: "accuracy",
    brief: "error and time of each stage",
    title: "Accuracy",
    hint: "Errors and times: normals of known shapes, octree leaves by δ, images by LOD threshold",
    description: "errors and times of normals, octree leaves and levels of detail",
    measured: "normals: angle to the truth on sampled shapes, either sign; noise is the standard deviation along each \
        axis as a part of the diameter, outliers are 3 % of it off; tree, neighbours and planes on all threads, by \
        least squares and robust, from k neighbours, given or chosen automatically by the noise found. leaves: from \
        points to the centres of their leaves, scene units and cell edges. lod: images of voxels, the whole object in \
        view and from 4 times as far, against those of all leaves, τ = 0 (– is the truth itself, or a PSNR of equal \
        images): PSNR and FLIP over the image, FLIP over the pixels that show the object; over time: mean difference \
        between the FLIP of two images of a camera that turns by half a degree and that of all leaves; to surfels: the \
        same against surfels",
    not_measured: "decoding, orientation of normals, radii, building octrees, drawing",
    covered_by: "surfels",
    defaults: Defaults::PROTOCOL,
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: columns::COLUMNS,
    headline: "flip_object_mean",
    bars_title: "FLIP of the object by LOD threshold in pixels and distance, 0 to 1",
    bar_labels: 3,
};

/// Number of steps per frame: one to prepare a frame, one for its leaves, one for its levels of detail at each
/// distance, one for voxels compared with surfels.
const STEPS_PER_FRAME: usize = 3 + lod::DISTANCES.len();

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let subjects = run.subjects(STEPS_PER_FRAME)?;
    run.add_steps(normals::STEPS);
    normals::measure(run)?;
    for subject in &subjects {
        measure_sequence(run, subject)?;
    }
    Ok(())
}

fn measure_sequence(run: &mut Run<'_>, subject: &Subject<'_>) -> Result<(), BenchError> {
    let needs = Needs {
        shapes: true,
        ..Scene::needs(&voxel_style_at(0.0))
    };
    let mut leaves = leaves::LeafSamples::default();
    let mut lod: [lod::LodSamples; lod::DISTANCES.len()] = Default::default();
    let mut closed = closed::ClosedSamples::default();
    let mut point_counts = Vec::new();
    let mut first_failure = None;
    for &index in &subject.chosen {
        let frame = match run.load(subject, index, STEPS_PER_FRAME, &needs)? {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        run.begin_step(format!("{}: leaves", subject.named(index)))?;
        leaves.measure(run, &frame)?;
        for (distance, samples) in lod::DISTANCES.into_iter().zip(&mut lod) {
            run.begin_step(format!(
                "{}: levels of detail from {distance} times the distance",
                subject.named(index)
            ))?;
            samples.measure(run, subject, &frame, distance)?;
        }
        run.begin_step(format!("{}: voxels compared with surfels", subject.named(index)))?;
        closed.measure(run, subject, &frame)?;
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let lod_rows = lod::DISTANCES
        .into_iter()
        .zip(&lod)
        .flat_map(|(distance, samples)| samples.rows(subject.name, distance));
    let rows = leaves.rows(subject.name).chain(lod_rows);
    let rows = rows.chain(closed.rows(subject.name));
    run.finish(subject, &point_counts, &[], rows.collect::<Vec<_>>());
    Ok(())
}
