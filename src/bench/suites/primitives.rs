//! Fig. 5 and Table 1 of Sainz and Pajarola 2004: the speed of each primitive, and the work of its shaders.
//!
//! **How it works.** Clouds of a torus with the requested numbers of points are drawn in addition to the inputs, all of
//! their points as each primitive, from three distances; each image turns the object by 2°. They are compared with
//! triangles: those of the file, or of a mesh with as many vertices as the torus has points. CPU and adapter draw the
//! same images in turn. As in the paper, a rate is the sum of all points over the sum of all times. Points of a size in
//! the scene are about as large as the disks of surfels, so that all but single pixels cover the same area. Splats are
//! drawn with each geometry that the adapter has for them; the CPU needs none: there its times are equal.
//!
//! The second table has the time of each pass on the adapter's clock. The third counts what the shaders of each pass
//! do, in naga's intermediate representation, next to the instruction counts of the paper.

use super::pass_samples::PassSamples;
use super::torus_mesh::with_mesh;
use super::turning::{VIEWS, cameras};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::levels::Lod;
use crate::render::AnyRenderer;
use crate::render::gpu::complexity::{PassComplexity, StageComplexity, passes_of};
use crate::scene::{
    Lighting, PointLight, PointShape, PointSizing, Primitive, Scene, ScenePacket, SplatFilter, SplatGeometry,
    Splatting, Style,
};
use crate::sequence::{Needs, PreparedFrame};

/// Names of the tables.
const SPEED: &str = "speed";
const PASSES: &str = "passes";
const COMPLEXITY: &str = "complexity";

/// Columns of all tables; the first names the table of a row.
const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    Column::text("sequence", "sequence"),
    Column::text("primitive", "primitive"),
    // Speed.
    Column::text("view", "view"),
    Column::number("points", "points", 0).hidden(),
    Column::number("records", "drawn", 0),
    Column::number("processor_ms_mean", "processor ms", 2),
    Column::number("processor_mpoints_per_s", "M points/s", 1),
    Column::number("adapter_ms_mean", "adapter ms", 2),
    Column::number("adapter_mpoints_per_s", "M points/s", 1),
    Column::number("samples", "pictures", 0).hidden(),
    // Passes and complexity.
    Column::text("pass", "pass"),
    Column::number("pass_gpu_ms_median", "GPU ms", 3),
    Column::number("vertex_operations", "vertex operations", 0),
    Column::number("vertex_buffer_reads", "buffer reads", 0),
    Column::number("vertex_texture_reads", "texture reads", 0),
    Column::number("fragment_operations", "fragment operations", 0),
    Column::number("fragment_buffer_reads", "buffer reads", 0),
    Column::number("fragment_texture_reads", "texture reads", 0),
    Column::number("paper_vertex_instructions", "paper: vertex", 0),
    Column::number("paper_fragment_instructions", "paper: fragment", 0),
];

/// Drawing each primitive, from three distances.
pub const PRIMITIVES: &Suite = &Suite {
    name: "primitives",
    brief: "render primitives: Fig. 5 and Table 1 of Sainz and Pajarola 2004",
    title: "Primitives",
    hint: "Points per second of each primitive, from three distances, and the complexity of its shaders (Sainz and \
           Pajarola 2004, Fig. 5 and Table 1)",
    description: "drawing all points as each primitive, from three distances, turning by 2° a picture",
    measured: "CPU wall time from packet to finished image, CPU and adapter in turn; points per second are all points \
        over all times; of voxels, leaves, of meshes, triangles; passes are timed by timestamps of the adapter, \
        median; operations and reads of shaders are counted in naga's intermediate representation, with all branches \
        and the storage strategy",
    not_measured: "decoding, normals, radii, ellipses, octrees, uploads, reading back, showing; the paper's are \
        instructions of the Cg compiler for a GeForce 5900, with lights for each vertex",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [640, 480],
        viewpoints: 4,
        frames: 1,
    },
    takes: &[OptionGroup::Clouds],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "processor_mpoints_per_s",
    bars_title: "Millions of points per second on the CPU",
    bar_labels: 3,
};

/// A primitive, and the change to the default style that selects it.
type Kind = (&'static str, fn(&mut Style));

/// In the order of the paper: simple ones first.
const KINDS: [Kind; 17] = [
    ("pixel", |style| {
        style.primitive = Primitive::Point;
        style.points.size_px = 1.0;
    }),
    ("square point", |style| points_of_scene(style, PointShape::Square)),
    ("round point", |style| points_of_scene(style, PointShape::Disk)),
    ("gaussian point", |style| points_of_scene(style, PointShape::Gaussian)),
    ("square point, lit", |style| {
        points_of_scene(style, PointShape::Square);
        style.points.light = PointLight::Normals;
    }),
    ("disk, opaque", |style| style.surfels.splatting = Splatting::Opaque),
    ("disk, opaque, triangle", |style| {
        style.surfels.splatting = Splatting::Opaque;
        style.surfels.geometry = SplatGeometry::Triangle;
    }),
    ("disk, two-pass", |_| {}),
    ("disk, two-pass, triangle", |style| {
        style.surfels.geometry = SplatGeometry::Triangle;
    }),
    ("disk, two-pass, filtered", |style| {
        style.surfels.filter = SplatFilter::Ewa;
    }),
    ("disk, two-pass, clamped", |style| {
        style.surfels.filter = SplatFilter::Clamp;
    }),
    ("sprite, opaque", |style| {
        style.primitive = Primitive::Sprite;
        style.surfels.splatting = Splatting::Opaque;
    }),
    ("sprite, two-pass", |style| style.primitive = Primitive::Sprite),
    ("ellipse, two-pass", |style| style.primitive = Primitive::Ellipse),
    ("ellipse, two-pass, triangle", |style| {
        style.primitive = Primitive::Ellipse;
        style.surfels.geometry = SplatGeometry::Triangle;
    }),
    ("voxel", |style| {
        style.primitive = Primitive::Voxel;
        style.levels.lod = Lod::ThresholdPx(0.0);
    }),
    // Drawn as triangles, where there are some.
    ("mesh", |style| style.primitive = Primitive::Mesh),
];

fn points_of_scene(style: &mut Style, shape: PointShape) {
    style.primitive = Primitive::Point;
    style.points.sizing = PointSizing::Projected;
    style.points.shape = shape;
}

/// Light for each vertex, as in the paper.
fn style(change: fn(&mut Style)) -> Style {
    let usual = Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.light.lighting = Lighting::PerVertex;
    });
    usual.with(change)
}

/// Table 1 of Sainz and Pajarola 2004, where it has the pass of a primitive: instructions for a vertex and for a
/// fragment.
fn of_paper(primitive: &str, pass: &str) -> [Option<f64>; 2] {
    match (primitive, pass) {
        ("square point", "point") => [Some(14.0), None],
        ("square point, lit", "solid") => [Some(55.0), None],
        ("sprite, two-pass", "visibility") => [Some(20.0), Some(21.0)],
        ("sprite, two-pass", "attribute") => [Some(60.0), Some(24.0)],
        ("sprite, two-pass" | "ellipse, two-pass, triangle", "resolve") => [None, Some(6.0)],
        // Its ellipses are textures on triangles, which discard nothing in the first pass.
        ("ellipse, two-pass, triangle", "visibility") => [Some(13.0), None],
        ("ellipse, two-pass, triangle", "attribute") => [Some(51.0), None],
        _ => [None; 2],
    }
}

/// One step to prepare a frame, one for each primitive.
const STEPS_PER_FRAME: usize = 1 + KINDS.len();

/// Measurements of one primitive from one distance: sums over images.
#[derive(Default)]
struct Samples {
    records: Vec<f64>,
    processor_ms: Vec<f64>,
    adapter_ms: Vec<f64>,
    passes: PassSamples,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let mut processor = Runner::new(AnyRenderer::cpu());
    let mut complexities = None;
    for subject in run.subjects(STEPS_PER_FRAME)? {
        complexities = Some(measure_sequence(run, &mut processor, &subject)?);
    }
    run.add_rows(complexities.into_iter().flatten());
    Ok(())
}

/// Returns the rows of [`COMPLEXITY`], which are the same for every sequence.
fn measure_sequence(run: &mut Run<'_>, processor: &mut Runner, subject: &Subject<'_>) -> Result<Vec<Row>, BenchError> {
    let mut samples: [[Samples; VIEWS.len()]; KINDS.len()] = Default::default();
    let mut complexities = Vec::new();
    let mut point_counts = Vec::new();
    let mut first_failure = None;
    for &index in &subject.chosen {
        let frame = match run.load(subject, index, STEPS_PER_FRAME, &needs())? {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        let frame = with_mesh(subject, index, frame);
        complexities.clear();
        for ((primitive, change), samples) in KINDS.into_iter().zip(&mut samples) {
            run.begin_step(format!("{}: {primitive}", subject.named(index)))?;
            if style(change).primitive == Primitive::Mesh && frame.triangles().is_none() {
                continue;
            }
            for ((_, distance), samples) in VIEWS.into_iter().zip(samples) {
                let packets = packets(run, subject, &frame, &style(change), distance);
                samples.measure(run, processor, &packets)?;
                if complexities.last().is_none_or(|&(known, _)| known != primitive) {
                    complexities.push((primitive, packets.first().map(passes_of).unwrap_or_default()));
                }
            }
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let points = mean(&point_counts);
    let rows = KINDS.into_iter().zip(&samples).flat_map(|((primitive, _), samples)| {
        let views = VIEWS.into_iter().zip(samples);
        let views = views.filter(|(_, samples)| !samples.records.is_empty());
        views.map(move |((view, _), samples)| samples.row(subject.name, points, primitive, view))
    });
    run.finish(subject, &point_counts, &[], rows);
    let pass_rows = KINDS.into_iter().zip(&samples).flat_map(|((primitive, _), samples)| {
        let views = VIEWS.into_iter().zip(samples);
        views.flat_map(move |((view, _), samples)| samples.pass_rows(subject.name, primitive, view))
    });
    run.add_rows(pass_rows);
    let of_primitive = |(primitive, passes): (&'static str, Vec<PassComplexity>)| {
        passes.into_iter().map(move |pass| complexity_row(primitive, &pass))
    };
    Ok(complexities.into_iter().flat_map(of_primitive).collect())
}

/// Returns the needs of all primitives.
fn needs() -> Needs {
    let all = KINDS.map(|(_, change)| Scene::needs(&style(change)));
    Needs {
        shapes: all.iter().any(|needs| needs.shapes),
        ellipses: all.iter().any(|needs| needs.ellipses),
        levels: all.iter().find_map(|needs| needs.levels),
        ..Needs::default()
    }
}

/// Builds the scene packets drawn from one distance.
fn packets(
    run: &Run<'_>,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    style: &Style,
    distance: f64,
) -> Vec<ScenePacket> {
    let viewport_px = run.options.viewport_px;
    let mut scene = Scene::default();
    cameras(subject, frame, distance, run.options.viewpoints)
        .iter()
        .map(|camera| subject.packet(&mut scene, frame, camera, style, viewport_px))
        .collect()
}

impl Samples {
    fn measure(
        &mut self,
        run: &mut Run<'_>,
        processor: &mut Runner,
        packets: &[ScenePacket],
    ) -> Result<(), BenchError> {
        let has_adapter = !run.runner.is_processor();
        for round in 0..run.options.warmup + run.options.repeat {
            for packet in packets {
                run.check_cancelled()?;
                let processor_ms = processor.draw(packet)?.wall_ms;
                let of_adapter = if has_adapter {
                    // Uploading is not part of drawing.
                    run.runner.upload(packet)?;
                    Some(run.runner.draw(packet)?)
                } else {
                    None
                };
                if round >= run.options.warmup {
                    self.records.push(packet.content.record_count() as f64);
                    self.processor_ms.push(processor_ms);
                    if let Some(time) = of_adapter {
                        self.adapter_ms.push(time.wall_ms);
                        self.passes.add(&time.gpu_passes);
                    }
                }
            }
        }
        Ok(())
    }

    fn pass_rows(&self, sequence: &str, primitive: &str, view: &str) -> impl Iterator<Item = Row> {
        let medians_ms = self.passes.medians_ms();
        medians_ms.map(move |(pass, gpu_ms)| pass_row(sequence, primitive, view, pass, gpu_ms))
    }

    fn row(&self, sequence: &str, points: f64, primitive: &str, view: &str) -> Row {
        let mean_of = |times_ms: &[f64]| (!times_ms.is_empty()).then(|| mean(times_ms));
        let records: f64 = self.records.iter().sum();
        let rate = |times_ms: &[f64]| {
            let sum_ms: f64 = times_ms.iter().sum();
            (sum_ms > 0.0).then(|| records / sum_ms / 1e3)
        };
        Row::of_table(
            COLUMNS,
            SPEED,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("primitive", Cell::Text(primitive.to_owned())),
                ("view", Cell::Text(view.to_owned())),
                ("points", Cell::Number(points)),
                ("records", Cell::Number(mean(&self.records))),
                ("processor_ms_mean", Cell::maybe(mean_of(&self.processor_ms))),
                ("processor_mpoints_per_s", Cell::maybe(rate(&self.processor_ms))),
                ("adapter_ms_mean", Cell::maybe(mean_of(&self.adapter_ms))),
                ("adapter_mpoints_per_s", Cell::maybe(rate(&self.adapter_ms))),
                ("samples", Cell::Number(self.records.len() as f64)),
            ],
        )
    }
}

fn pass_row(sequence: &str, primitive: &str, view: &str, pass: &str, gpu_ms: f64) -> Row {
    Row::of_table(
        COLUMNS,
        PASSES,
        &[
            ("sequence", Cell::Text(sequence.to_owned())),
            ("primitive", Cell::Text(primitive.to_owned())),
            ("view", Cell::Text(view.to_owned())),
            ("pass", Cell::Text(pass.to_owned())),
            ("pass_gpu_ms_median", Cell::Number(gpu_ms)),
        ],
    )
}

fn complexity_row(primitive: &str, complexity: &PassComplexity) -> Row {
    let count = |count: usize| Cell::Number(count as f64);
    let StageComplexity {
        operations,
        buffer_reads,
        texture_reads,
    } = complexity.vertex;
    let fragment = complexity.fragment;
    let [paper_vertex, paper_fragment] = of_paper(primitive, complexity.pass);
    Row::of_table(
        COLUMNS,
        COMPLEXITY,
        &[
            ("primitive", Cell::Text(primitive.to_owned())),
            ("pass", Cell::Text(complexity.pass.to_owned())),
            ("vertex_operations", count(operations)),
            ("vertex_buffer_reads", count(buffer_reads)),
            ("vertex_texture_reads", count(texture_reads)),
            ("fragment_operations", count(fragment.operations)),
            ("fragment_buffer_reads", count(fragment.buffer_reads)),
            ("fragment_texture_reads", count(fragment.texture_reads)),
            ("paper_vertex_instructions", Cell::maybe(paper_vertex)),
            ("paper_fragment_instructions", Cell::maybe(paper_fragment)),
        ],
    )
}
