//! The software renderer compared with the adapter: the same images in the same minute, from three distances.
//!
//! How it works: the object as a whole in view, from four times as far, and from so near that most of it is outside.
//! Both draw each view in turn, so that a slowdown of the machine affects both. Records are selected before the clocks
//! start, and are resident.
//!
//! Result: costs that follow the visible cells and pixels, not their total.

use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::statistics::mean;
use crate::bench::subject::{Subject, mean_position};
use crate::bench::suite::{Defaults, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::render::AnyRenderer;
use crate::scene::{Camera, Primitive, Scene, ScenePacket, Style};
use crate::sequence::PreparedFrame;

/// Columns, in the order in which [`RenderSamples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("primitive", "primitive"),
    Column::text("view", "view"),
    Column::number("records", "records", 0),
    Column::number("processor_ms_median", "processor ms", 3),
    Column::number("processor_ms_q1", "25 %", 3),
    Column::number("processor_ms_q3", "75 %", 3),
    Column::number("processor_mrecords_per_s", "M records/s", 1),
    Column::number("adapter_ms_median", "adapter ms", 3),
    Column::number("adapter_ms_q1", "25 %", 3),
    Column::number("adapter_ms_q3", "75 %", 3),
    Column::number("adapter_per_processor", "adapter / processor", 2),
    Column::number("samples", "pictures", 0).hidden(),
];

/// Drawing on the CPU and on the adapter, from three distances.
pub const RENDER: &Suite = &Suite {
    name: "render",
    brief: "CPU compared with GPU",
    title: "CPU × GPU",
    hint: "Time per image of the software renderer and of the GPU, from three distances",
    description: "drawing on the CPU and on the adapter, from three distances",
    measured: "CPU wall time from packet to finished image, CPU and adapter in turn: the whole object in view, from 4 \
        times as far (afar), from 0.3 times (near)",
    not_measured: "decoding, normals, octrees, traversal, uploads, reading back, showing",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [1920, 1080],
        viewpoints: 2,
        frames: 1,
    },
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "processor_ms_median",
    bars_title: "Time per image on the CPU, median ms",
    bar_labels: 3,
};

/// Distances as parts of the one that shows the whole object.
const VIEWS: [(&str, f64); 3] = [("whole", 1.0), ("afar", 4.0), ("near", 0.3)];

const PRIMITIVES: [Primitive; 3] = [Primitive::Point, Primitive::Surfel, Primitive::Voxel];

/// One step to prepare a frame, one for each primitive.
const STEPS_PER_FRAME: usize = 1 + PRIMITIVES.len();

/// Measurements of one sequence, one primitive and one distance.
#[derive(Default)]
struct RenderSamples {
    records: Vec<f64>,
    processor_ms: Vec<f64>,
    adapter_ms: Vec<f64>,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let mut processor = Runner::new(AnyRenderer::cpu());
    for subject in run.subjects(STEPS_PER_FRAME)? {
        measure_sequence(run, &mut processor, &subject)?;
    }
    Ok(())
}

fn measure_sequence(run: &mut Run<'_>, processor: &mut Runner, subject: &Subject<'_>) -> Result<(), BenchError> {
    let mut needs = Scene::needs(&style(Primitive::Voxel));
    needs.shapes = true;
    let mut samples: [[RenderSamples; VIEWS.len()]; PRIMITIVES.len()] = Default::default();
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
        for (primitive, samples) in PRIMITIVES.into_iter().zip(&mut samples) {
            run.begin_step(format!("{}: {primitive}", subject.named(index)))?;
            for ((_, distance), samples) in VIEWS.into_iter().zip(samples) {
                let packets = packets(run, subject, &frame, primitive, distance);
                samples.measure(run, processor, &packets)?;
            }
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let rows = PRIMITIVES.into_iter().zip(&samples).flat_map(|(primitive, samples)| {
        let views = VIEWS.into_iter().zip(samples);
        views.map(move |((view, _), samples)| samples.row(subject.name, primitive, view))
    });
    run.finish(subject, &point_counts, &[], rows);
    Ok(())
}

fn style(primitive: Primitive) -> Style {
    Style {
        primitive,
        ..Style::default()
    }
}

/// Builds the scene packets drawn from each viewpoint.
fn packets(
    run: &Run<'_>,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    primitive: Primitive,
    distance: f64,
) -> Vec<ScenePacket> {
    let origin = subject.sequence.origin();
    let target_in_world = origin + mean_position(frame.frame.positions());
    let packet = |view| {
        let camera = Camera {
            target_in_world,
            ..view
        };
        let viewport_px = run.options.viewport_px;
        subject.packet(&mut Scene::default(), frame, &camera, &style(primitive), viewport_px)
    };
    let views = subject.views(frame, run.options.viewpoints, distance);
    views.into_iter().map(packet).collect()
}

impl RenderSamples {
    fn measure(
        &mut self,
        run: &mut Run<'_>,
        processor: &mut Runner,
        packets: &[ScenePacket],
    ) -> Result<(), BenchError> {
        for round in 0..run.options.warmup + run.options.repeat {
            for packet in packets {
                run.check_cancelled()?;
                // The data that an image is selected from may have changed: it is prepared before the clock starts.
                processor.upload(packet)?;
                let processor_ms = processor.draw(packet)?.wall_ms;
                let adapter_ms = if run.runner.is_processor() {
                    None
                } else {
                    run.runner.upload(packet)?;
                    Some(run.runner.draw(packet)?.wall_ms)
                };
                if round >= run.options.warmup {
                    self.records.push(packet.content.record_count() as f64);
                    self.processor_ms.push(processor_ms);
                    self.adapter_ms.extend(adapter_ms);
                }
            }
        }
        Ok(())
    }

    fn row(&self, sequence: &str, primitive: Primitive, view: &str) -> Row {
        let processor = Quantiles::of(&self.processor_ms);
        let adapter = Quantiles::of(&self.adapter_ms);
        let records = mean(&self.records);
        let rate = processor.map(|q| records / (1e3 * q.median));
        let ratio = adapter
            .zip(processor)
            .map(|(adapter, processor)| adapter.median / processor.median);
        Row::new(vec![
            Cell::Text(sequence.to_owned()),
            Cell::Text(primitive.to_string()),
            Cell::Text(view.to_owned()),
            Cell::Number(records),
            Cell::maybe(processor.map(|q| q.median)),
            Cell::maybe(processor.map(|q| q.q1)),
            Cell::maybe(processor.map(|q| q.q3)),
            Cell::maybe(rate),
            Cell::maybe(adapter.map(|q| q.median)),
            Cell::maybe(adapter.map(|q| q.q1)),
            Cell::maybe(adapter.map(|q| q.q3)),
            Cell::maybe(ratio),
            Cell::Number(self.processor_ms.len() as f64),
        ])
    }
}
