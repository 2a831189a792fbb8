//! Table III: what an octree of an acceptable loss δ looks like, and what building and traversing it takes.
//!
//! Builds and traversals run on one thread, the calling one, as the paper's do. Each traversal fills memory that the one before
//! it left, as playing does; the viewpoints are those from which surfels cover 25 to 85 % of the picture.

use super::traversals::Traversals;
use super::{Run, Subject, mean, surfel_settings};
use crate::bench::report::{Cell, Column, Row};
use crate::bench::runner::milliseconds_since;
use crate::bench::{BenchError, Quantiles};
use crate::octree::{Octree, StopCriterion};
use crate::scene::{Camera, Scene};
use crate::sequence::PreparedFrame;
use std::hint::black_box;
use std::time::Instant;

/// The losses of the paper's table.
const DELTAS: [f32; 3] = [0.02, 0.10, 0.50];

/// LOD threshold of the traversals, pixels: the usual one.
const LOD_PX: f32 = 1.0;

/// One step to prepare a frame, one to place its viewpoints, one for each δ.
const STEPS_PER_FRAME: usize = 2 + DELTAS.len();

/// In the order in which [`Samples::row`] fills them.
pub(in crate::bench) const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::percent("delta", "δ", 0),
    Column::number("points", "points", 0),
    Column::percent("loss", "loss", 2),
    Column::number("depth", "depth", 1),
    Column::number("nodes", "nodes", 0),
    Column::number("leaves", "leaves", 0),
    Column::number("build_ms_median", "build ms", 3),
    Column::number("build_ms_q1", "25 %", 3),
    Column::number("build_ms_q3", "75 %", 3),
    Column::number("build_ms_mean", "mean ms", 3).hidden(),
    Column::number("traverse_ms_median", "traverse ms", 3),
    Column::number("traverse_ms_q1", "25 %", 3),
    Column::number("traverse_ms_q3", "75 %", 3),
    Column::number("traverse_ms_mean", "mean ms", 3).hidden(),
    Column::number("visited_nodes", "visited", 0),
    Column::number("emitted_voxels", "emitted", 0),
    Column::number("samples", "samples", 0).hidden(),
];

/// The column that a bar chart shows.
pub(in crate::bench) const HEADLINE: &str = "build_ms_median";

/// What was measured of one sequence at one δ.
#[derive(Default)]
struct Samples {
    loss: Vec<f64>,
    depth: Vec<f64>,
    nodes: Vec<f64>,
    leaves: Vec<f64>,
    build_ms: Vec<f64>,
    traversals: Traversals,
}

pub(in crate::bench) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    for subject in run.subjects(STEPS_PER_FRAME)? {
        measure_sequence(run, &subject)?;
    }
    Ok(())
}

fn measure_sequence(run: &mut Run<'_>, subject: &Subject<'_>) -> Result<(), BenchError> {
    // What placing viewpoints needs; octrees are built by the clock.
    let needs = Scene::needs(&surfel_settings());
    let mut samples: Vec<Samples> = DELTAS.iter().map(|_| Samples::default()).collect();
    let (mut point_counts, mut coverages) = (Vec::new(), Vec::new());
    let mut first_failure = None;
    for &index in &subject.chosen {
        let loaded = run.load(subject, index, STEPS_PER_FRAME, &needs)?;
        let frame = match loaded {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        run.begin_step(format!(
            "{} frame {index}: placing viewpoints",
            subject.name
        ))?;
        let viewpoints = run.viewpoints(subject, &frame, &surfel_settings())?;
        coverages.extend(viewpoints.iter().map(|viewpoint| viewpoint.coverage));
        let cameras: Vec<Camera> = viewpoints
            .iter()
            .map(|viewpoint| viewpoint.camera)
            .collect();
        for (delta, samples) in DELTAS.into_iter().zip(&mut samples) {
            run.begin_step(format!(
                "{} frame {index}: δ {} %",
                subject.name,
                percent(delta)
            ))?;
            let octree = measure_build(run, &frame, delta, samples)?;
            let traversals = &mut samples.traversals;
            traversals.measure(run, subject, &octree, &cameras, LOD_PX)?;
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let rows = DELTAS
        .iter()
        .zip(&samples)
        .map(|(&delta, samples)| samples.row(subject.name, delta, mean(&point_counts)));
    run.finish(subject, &point_counts, &coverages, rows);
    Ok(())
}

/// As many builds as there are traversals.
fn measure_build(
    run: &Run<'_>,
    frame: &PreparedFrame,
    delta: f32,
    samples: &mut Samples,
) -> Result<Octree, BenchError> {
    let positions = frame.frame.positions();
    let colors: Vec<[u8; 4]> = frame.points.iter().map(|point| point.color).collect();
    let build = || {
        Octree::build(
            black_box(positions),
            black_box(&colors),
            StopCriterion::Loss(delta),
        )
    };
    let mut octree = build();
    for round in 0..(run.options.warmup + run.options.repeat) * run.options.viewpoints {
        run.check_cancelled()?;
        let start = Instant::now();
        let built = build();
        let build_ms = milliseconds_since(start);
        if round >= run.options.warmup * run.options.viewpoints {
            samples.build_ms.push(build_ms);
        }
        // Freeing the one before is not part of building.
        octree = built;
    }
    samples.loss.push(f64::from(octree.loss()));
    samples.depth.push(f64::from(octree.depth()));
    samples.nodes.push(octree.internal_count() as f64);
    samples.leaves.push(octree.leaf_count() as f64);
    Ok(octree)
}

/// δ in whole percent, free of the rounding to f32.
fn percent(delta: f32) -> f64 {
    f64::from(delta * 100.0).round()
}

impl Samples {
    fn row(&self, sequence: &str, delta: f32, points: f64) -> Row {
        let build = Quantiles::of(&self.build_ms);
        let traverse = Quantiles::of(&self.traversals.times_ms);
        Row::new(vec![
            Cell::Text(sequence.to_owned()),
            Cell::Number(percent(delta) / 100.0),
            Cell::Number(points),
            Cell::Number(mean(&self.loss)),
            Cell::Number(mean(&self.depth)),
            Cell::Number(mean(&self.nodes)),
            Cell::Number(mean(&self.leaves)),
            Cell::maybe(build.map(|q| q.median)),
            Cell::maybe(build.map(|q| q.q1)),
            Cell::maybe(build.map(|q| q.q3)),
            Cell::maybe(build.map(|q| q.mean)),
            Cell::maybe(traverse.map(|q| q.median)),
            Cell::maybe(traverse.map(|q| q.q1)),
            Cell::maybe(traverse.map(|q| q.q3)),
            Cell::maybe(traverse.map(|q| q.mean)),
            Cell::Number(mean(&self.traversals.visited_nodes)),
            Cell::Number(mean(&self.traversals.emitted_voxels)),
            Cell::Number(self.traversals.times_ms.len() as f64),
        ])
    }
}
