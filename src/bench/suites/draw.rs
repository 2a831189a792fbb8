//! Tables II and IV: time of an image by each instancing strategy, for surfels and for voxels; without an adapter, on
//! the CPU.
//!
//! All strategies see the same frames from the same viewpoints, in turn for each frame, so that a slowdown of the
//! machine affects all of them. For each: one record is drawn (which compiles pipelines), the streams are uploaded and
//! timed, warm-up rounds are drawn, then the rounds that count.

use super::paper_style::{surfel_style, voxel_style};
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::scene::{Scene, ScenePacket, Strategy, Style};
use crate::sequence::PreparedFrame;
use std::sync::Arc;

/// Returns the render modes that are compared: the strategies, none of which the CPU has.
fn variants(run: &Run<'_>) -> Vec<Option<Strategy>> {
    if run.runner.is_processor() {
        return vec![None];
    }
    Strategy::ALL.iter().copied().map(Some).collect()
}

/// The name of a strategy in a report.
fn name_of(way: Option<Strategy>) -> &'static str {
    way.map_or("processor", Strategy::name)
}

/// Columns of both suites, in the order in which [`DrawSamples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("strategy", "strategy"),
    Column::number("points", "points", 0),
    Column::number("octree_depth", "depth", 1),
    Column::number("instances", "instances", 0),
    Column::number("draw_calls", "draws", 0).hidden(),
    Column::number("draw_ms_median", "draw ms", 3),
    Column::number("draw_ms_q1", "25 %", 3),
    Column::number("draw_ms_q3", "75 %", 3),
    Column::number("draw_ms_min", "least ms", 3).hidden(),
    Column::number("draw_ms_max", "most ms", 3).hidden(),
    Column::number("draw_ms_mean", "mean ms", 3),
    Column::number("gpu_ms_median", "GPU ms", 3),
    Column::number("gpu_ms_q1", "GPU 25 %", 3).hidden(),
    Column::number("gpu_ms_q3", "GPU 75 %", 3).hidden(),
    Column::number("upload_ms_median", "upload ms", 3),
    Column::number("upload_and_draw_ms", "upload + draw ms", 3),
    Column::number("upload_bytes", "bytes", 0),
    Column::number("samples", "pictures", 0),
    Column::number("timed_uploads", "uploads in draw ms", 0).hidden(),
];

/// Drawing surfels by each instancing strategy.
pub const SURFELS: &Suite = &Suite {
    name: "surfels",
    brief: "surfel rendering: Table II of the paper",
    title: "Surfels × strategies",
    hint: "Time a frame of each instancing strategy drawing surfels (paper, Table II)",
    description: "drawing surfels, two-pass-enlarged (2x), by instancing strategy",
    measured: "CPU wall time from packet to finished picture (draw ms); GPU time of its passes (GPU ms); copying the \
        records to the adapter (upload ms)",
    not_measured: "decoding, normals, octrees and traversal, reading back, showing; uploads are not in draw ms; \
        upload + draw ms, the sum of both medians, is a frame that is drawn for the first time",
    covered_by: "surfels",
    defaults: Defaults::PROTOCOL,
    takes: &[],
    is_of_paper: true,
    has_paper_layout: true,
    columns: COLUMNS,
    headline: "draw_ms_median",
    bars_title: "CPU wall time of a picture, median ms",
    bar_labels: 2,
};

/// Drawing voxels by each instancing strategy.
pub const VOXELS: &Suite = &Suite {
    name: "voxels",
    brief: "voxel rendering: Table IV of the paper",
    title: "Voxels × strategies",
    hint: "Time a frame of each instancing strategy drawing voxels (paper, Table IV)",
    description: "drawing voxels of the visible set by instancing strategy",
    covered_by: "voxels",
    ..*SURFELS
};

/// Measurements of one sequence with one strategy.
#[derive(Default)]
struct DrawSamples {
    draw_ms: Vec<f64>,
    gpu_ms: Vec<f64>,
    upload_ms: Vec<f64>,
    upload_bytes: Vec<f64>,
    instances: Vec<f64>,
    draw_calls: Vec<f64>,
    timed_uploads: u64,
}

pub(super) fn measure_surfels(run: &mut Run<'_>) -> Result<(), BenchError> {
    measure(run, &surfel_style())
}

pub(super) fn measure_voxels(run: &mut Run<'_>) -> Result<(), BenchError> {
    measure(run, &voxel_style())
}

fn measure(run: &mut Run<'_>, style: &Style) -> Result<(), BenchError> {
    let variants = variants(run);
    // One step to prepare a frame, one to place its viewpoints, one per variant.
    let steps_per_frame = 2 + variants.len();
    for subject in run.subjects(steps_per_frame)? {
        measure_sequence(run, &subject, style, &variants, steps_per_frame)?;
    }
    Ok(())
}

fn measure_sequence(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    style: &Style,
    variants: &[Option<Strategy>],
    steps_per_frame: usize,
) -> Result<(), BenchError> {
    let needs = Scene::needs(style);
    let mut samples: Vec<DrawSamples> = variants.iter().map(|_| DrawSamples::default()).collect();
    let (mut point_counts, mut depths) = (Vec::new(), Vec::new());
    let mut coverages = Vec::new();
    let mut first_failure = None;
    for &index in &subject.chosen {
        let loaded = run.load(subject, index, steps_per_frame, &needs)?;
        let mut frame = match loaded {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        depths.extend(frame.levels.octree().map(|octree| f64::from(octree.depth())));
        run.begin_step(format!("{}: placing viewpoints", subject.named(index)))?;
        let viewpoints = run.viewpoints(subject, &frame, style)?;
        coverages.extend(viewpoints.iter().map(|viewpoint| viewpoint.coverage));
        // Measuring the coverage left the streams on the adapter; a renderer takes a copy for a different cloud, so
        // that its upload can be measured.
        frame.points = Arc::new(frame.points.to_vec());
        frame.shapes = frame.shapes.map(|shapes| Arc::new(shapes.to_vec()));
        let packets: Vec<ScenePacket> = viewpoints
            .iter()
            .map(|viewpoint| packet(run, subject, &frame, &viewpoint.camera, style))
            .collect();
        for (&way, samples) in variants.iter().zip(&mut samples) {
            run.begin_step(format!("{}: {}", subject.named(index), name_of(way)))?;
            measure_way(run, &packets, way, samples)?;
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let depth = (!depths.is_empty()).then(|| mean(&depths));
    let rows = variants
        .iter()
        .zip(&samples)
        .map(|(&way, samples)| samples.row(subject.name, way, mean(&point_counts), depth));
    run.finish(subject, &point_counts, &coverages, rows);
    Ok(())
}

/// A packet with its own visible set: each viewpoint keeps its voxels resident.
fn packet(
    run: &Run<'_>,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    camera: &crate::scene::Camera,
    style: &Style,
) -> ScenePacket {
    subject.packet(&mut Scene::default(), frame, camera, style, run.options.viewport_px)
}

fn measure_way(
    run: &mut Run<'_>,
    packets: &[ScenePacket],
    way: Option<Strategy>,
    samples: &mut DrawSamples,
) -> Result<(), BenchError> {
    let packets: Vec<ScenePacket> = packets
        .iter()
        .map(|packet| ScenePacket {
            style: packet
                .style
                .with(|style| style.drawing.strategy = way.unwrap_or(packet.style.drawing.strategy)),
            ..packet.clone()
        })
        .collect();
    if let Some(first) = packets.first() {
        run.runner.warm_up(first)?;
    }
    for packet in &packets {
        run.check_cancelled()?;
        let upload = run.runner.upload(packet)?;
        // Surfels are uploaded once per frame, voxels once per viewpoint.
        if upload.bytes > 0 {
            samples.upload_ms.push(upload.wall_ms);
            samples.upload_bytes.push(upload.bytes as f64);
        }
    }
    for _ in 0..run.options.warmup {
        for packet in &packets {
            run.check_cancelled()?;
            run.runner.draw(packet)?;
        }
    }
    let uploads_before = run.runner.stats().uploads;
    for _ in 0..run.options.repeat {
        for packet in &packets {
            run.check_cancelled()?;
            let time = run.runner.draw(packet)?;
            let stats = run.runner.stats();
            samples.draw_ms.push(time.wall_ms);
            samples.gpu_ms.extend(time.gpu_ms);
            samples.instances.push(stats.drawn_instances as f64);
            samples.draw_calls.push(f64::from(stats.draw_calls));
        }
    }
    samples.timed_uploads += run.runner.stats().uploads - uploads_before;
    Ok(())
}

impl DrawSamples {
    fn row(&self, sequence: &str, way: Option<Strategy>, points: f64, depth: Option<f64>) -> Row {
        let draw = Quantiles::of(&self.draw_ms);
        let gpu = Quantiles::of(&self.gpu_ms);
        let upload = Quantiles::of(&self.upload_ms);
        Row::new(vec![
            Cell::Text(sequence.to_owned()),
            Cell::Text(name_of(way).to_owned()),
            Cell::Number(points),
            Cell::maybe(depth),
            Cell::Number(mean(&self.instances)),
            Cell::Number(mean(&self.draw_calls)),
            Cell::maybe(draw.map(|q| q.median)),
            Cell::maybe(draw.map(|q| q.q1)),
            Cell::maybe(draw.map(|q| q.q3)),
            Cell::maybe(draw.map(|q| q.min)),
            Cell::maybe(draw.map(|q| q.max)),
            Cell::maybe(draw.map(|q| q.mean)),
            Cell::maybe(gpu.map(|q| q.median)),
            Cell::maybe(gpu.map(|q| q.q1)),
            Cell::maybe(gpu.map(|q| q.q3)),
            Cell::maybe(upload.map(|q| q.median)),
            Cell::maybe(draw.map(|draw| draw.median + upload.map_or(0.0, |upload| upload.median))),
            Cell::Number(mean(&self.upload_bytes)),
            Cell::Number(self.draw_ms.len() as f64),
            Cell::Number(self.timed_uploads as f64),
        ])
    }
}
