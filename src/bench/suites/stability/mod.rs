//! Stability: clouds and cameras that break numerics, as every primitive, on both renderers.
//!
//! How it works: each case of `cases.rs` is a cloud and a camera with the image that it must give, generated here; each
//! chosen frame of the inputs is a case as it is. A cloud takes the path of files: origin, validation, estimation,
//! levels of detail. The image is compared with its reference, ray-traced where the surface is known, elsewhere an
//! image of the same cloud without the difficulty; and the GPU's image with the CPU's. Without an adapter, the CPU
//! renderer is tested alone.
//!
//! A row is red if its image is empty and the reference is not (or the other way round), if the images of CPU and GPU,
//! or of equal scenes, have a PSNR below 40 dB, if splats leave holes in a closed surface, or if
//! nothing could be drawn.

mod cases;
mod judged;

use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::composition::{PictureView, packet};
use crate::render::AnyRenderer;
use crate::render::truth::{Disks, RayTraced, Truth, TruthView};
use crate::scene::{Background, Camera, Lighting, Primitive, Scene, ScenePacket, Style, UpAxis};
use crate::sequence::{FrameEntry, PrepareCounters, PreparedFrame, Sequence, complete, prepare};
use crate::source::FrameList;
use cases::{CASES, Case, Expected, Scenery};
use glam::DVec3;
use image::RgbaImage;
use judged::{BACKGROUND, Judged, Reference};
use std::sync::Arc;

/// Columns, in the order in which [`Measured::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("case", "case"),
    Column::text("primitive", "primitive"),
    Column::text("renderer", "renderer"),
    Column::text("result", "result"),
    Column::number("points", "points", 0).hidden(),
    Column::number("flip", "FLIP", 4),
    Column::number("psnr_db", "PSNR dB", 1),
    Column::number("between_db", "CPU to GPU dB", 1),
    Column::percent("hole_share", "holes", 2),
    Column::percent("covered_share", "covered", 1),
    Column::number("draw_ms_median", "draw ms", 2),
    Column::number("draw_ms_max", "most ms", 2).hidden(),
    Column::text("reference", "reference"),
    Column::text("message", "message").hidden(),
];

/// Cases that break numerics.
pub const STABILITY: &Suite = &Suite {
    name: "stability",
    brief: "cases that break numerics, on both renderers",
    title: "Stability",
    hint: "Clouds and cameras that break numerics, as every primitive on both renderers: errors, times and a result",
    description: "clouds and cameras that break numerics, as every primitive, on both renderers",
    measured: "FLIP and PSNR against the reference: a shape or disks ray-traced in f64, or the CPU's image of an equal \
        scene without the difficulty; PSNR between CPU and GPU (99 where equal); background where the reference shows \
        a surface (holes); CPU wall time of a resident image; red where an image is empty, CPU and GPU or equal \
        scenes have a PSNR below 40 dB, splats leave more than 5 % holes, or nothing could be drawn",
    not_measured: "decoding, normals, octrees, uploads, showing",
    covered_by: "the primitive",
    defaults: Defaults {
        viewport_px: [320, 240],
        viewpoints: 1,
        frames: 1,
    },
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "flip",
    bars_title: "FLIP against the reference, 0 to 1",
    bar_labels: 3,
};

/// One step to prepare a frame, and one to draw it.
const STEPS: usize = 2;

/// Results of one primitive on one renderer.
struct Measured {
    case: String,
    primitive: Option<Primitive>,
    renderer: &'static str,
    points: usize,
    draw_ms: Vec<f64>,
    judged: Judged,
}

/// A frame and where it is seen from.
struct Seen {
    frame: PreparedFrame,
    origin: DVec3,
    camera: Camera,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let mut processor = Runner::new(AnyRenderer::cpu());
    run.add_steps(STEPS * CASES.len());
    let subjects = run.subjects(STEPS)?;
    for case in CASES {
        run.begin_step(format!("{}: preparing", case.name))?;
        let rows = measure_case(run, &mut processor, case)?;
        run.add_rows(rows);
    }
    for subject in subjects {
        measure_input(run, &mut processor, &subject)?;
    }
    Ok(())
}

fn measure_case(run: &mut Run<'_>, processor: &mut Runner, case: &Case) -> Result<Vec<Row>, BenchError> {
    let seen = Seen::of(case.seen);
    run.begin_step(case.name.to_owned())?;
    let seen = match (seen, case.expected) {
        (Ok(_), Expected::Refusal) => return Ok(vec![row_without_image(case.name, Judged::drawn_anyway())]),
        (Err(message), Expected::Refusal) => return Ok(vec![row_without_image(case.name, Judged::refused(message))]),
        (Err(message), _) => return Ok(vec![row_without_image(case.name, Judged::failed(message))]),
        (Ok(seen), _) => seen,
    };
    let shared = seen.reference(run, case.expected);
    let mut references = Vec::new();
    for &primitive in case.primitives {
        let reference = match (&shared, case.expected) {
            (None, Expected::Of(scenery)) => {
                let equal = Seen::of(scenery).map_err(BenchError::Nothing)?;
                Reference::drawn(processor.image(&equal.packet(run, primitive, true))?)
            }
            (Some(shared), _) => shared.clone(),
            (None, _) => Reference::empty(run.options.viewport_px),
        };
        references.push((primitive, reference));
    }
    measure_seen(run, processor, case.name, &seen, &references)
}

/// Each chosen frame of an input, as it is.
fn measure_input(run: &mut Run<'_>, processor: &mut Runner, subject: &Subject<'_>) -> Result<(), BenchError> {
    let mut point_counts = Vec::new();
    let mut first_failure = None;
    for &index in &subject.chosen {
        let frame = match run.load(subject, index, STEPS, &Scene::needs(&style(Primitive::Surfel, true)))? {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        run.begin_step(subject.named(index))?;
        let seen = Seen {
            camera: subject.framing(&frame),
            origin: subject.sequence.origin(),
            frame,
        };
        let reference = seen.disks(run);
        let references: Vec<(Primitive, Reference)> = cases::ALL
            .iter()
            .map(|&primitive| (primitive, reference.clone()))
            .collect();
        let rows = measure_seen(run, processor, &subject.named(index), &seen, &references)?;
        run.add_rows(rows);
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    run.finish(subject, &point_counts, &[], []);
    Ok(())
}

/// Every primitive on both renderers.
fn measure_seen(
    run: &mut Run<'_>,
    processor: &mut Runner,
    case: &str,
    seen: &Seen,
    references: &[(Primitive, Reference)],
) -> Result<Vec<Row>, BenchError> {
    let has_adapter = !run.runner.is_processor();
    let mut rows = Vec::new();
    for (primitive, reference) in references {
        let on_cpu = seen.packet(run, *primitive, true);
        let (cpu_image, cpu_ms) = image_and_times(run, Some(&mut *processor), &on_cpu)?;
        let adapter = if has_adapter {
            let on_gpu = seen.packet(run, *primitive, false);
            Some(image_and_times(run, None, &on_gpu)?)
        } else {
            None
        };
        let gpu_image = adapter.as_ref().map(|(image, _)| image);
        let mut add = |renderer, image: &RgbaImage, other: Option<&RgbaImage>, draw_ms| {
            let judged = Judged::of(reference, image, other, is_closed(*primitive))?;
            let measured = Measured {
                case: case.to_owned(),
                primitive: Some(*primitive),
                renderer,
                points: seen.frame.points.len(),
                draw_ms,
                judged,
            };
            rows.push(measured.row());
            Ok::<(), BenchError>(())
        };
        add("cpu", &cpu_image, gpu_image, cpu_ms)?;
        if let Some((image, gpu_ms)) = &adapter {
            add("gpu", image, Some(&cpu_image), gpu_ms.clone())?;
        }
    }
    Ok(rows)
}

/// The image of a packet and the times of the rounds that count; on the adapter unless there is a CPU renderer.
fn image_and_times(
    run: &mut Run<'_>,
    processor: Option<&mut Runner>,
    packet: &ScenePacket,
) -> Result<(RgbaImage, Vec<f64>), BenchError> {
    let progress = run.progress();
    let (warmup, repeat) = (run.options.warmup, run.options.repeat);
    let runner = processor.unwrap_or(&mut run.runner);
    let image = runner.image(packet)?;
    let mut draw_ms = Vec::new();
    for round in 0..warmup + repeat {
        BenchError::check_cancelled(progress)?;
        let time = runner.draw(packet)?;
        if round >= warmup {
            draw_ms.push(time.wall_ms);
        }
    }
    Ok((image, draw_ms))
}

/// Returns true for primitives that leave no holes in a surface: not for points, which are as large as they are.
fn is_closed(primitive: Primitive) -> bool {
    primitive != Primitive::Point
}

fn style(primitive: Primitive, is_processor: bool) -> Style {
    let usual = Style::default().with(|style| {
        style.primitive = primitive;
        style.backdrop.background = Background::solid(BACKGROUND);
    });
    usual.drawn_by(is_processor)
}

impl Seen {
    /// A cloud processed like a file, or the reason for failure.
    fn of(scenery: Scenery) -> Result<Self, String> {
        let make = scenery.cloud;
        let source = FrameList::new(vec![FrameEntry::file("generated")], move |_, _| Ok(make()));
        let sequence = Sequence::of(source);
        let frame = sequence.frame(0).map_err(|error| error.to_string())?;
        let needs = Scene::needs(&style(Primitive::Surfel, true));
        let frame = prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default());
        let origin = sequence.origin();
        let framing = Camera::framing(&frame.frame.bounds(), origin, UpAxis::Y);
        Ok(Self {
            frame,
            origin,
            camera: (scenery.camera)(framing),
        })
    }

    fn packet(&self, run: &Run<'_>, primitive: Primitive, is_processor: bool) -> ScenePacket {
        let style = style(primitive, is_processor);
        let frame = complete(&self.frame, &Scene::needs(&style), &PrepareCounters::default());
        let view = PictureView {
            camera: &self.camera,
            origin: self.origin,
            size_px: run.options.viewport_px,
        };
        packet(&mut Scene::default(), &frame, &view, &style)
    }

    fn truth_view(&self, run: &Run<'_>) -> TruthView {
        let background = Background::solid(BACKGROUND);
        TruthView::new(
            &self.camera,
            self.origin,
            run.options.viewport_px,
            Lighting::PerFragment,
            background,
        )
    }

    /// The reference image of all primitives, ray-traced once; `None` where each has its own, or nothing is seen.
    fn reference(&self, run: &Run<'_>, expected: Expected) -> Option<Reference> {
        match expected {
            Expected::Shape(shape) => {
                let traced = RayTraced {
                    shape,
                    cull_back_faces: true,
                };
                Some(Reference::traced(&Truth::of_shape(traced, &self.truth_view(run), 0.0)))
            }
            Expected::Disks => Some(self.disks(run)),
            Expected::Of(_) | Expected::Background | Expected::Refusal => None,
        }
    }

    /// The ray-traced image of the disks of all points.
    fn disks(&self, run: &Run<'_>) -> Reference {
        let disks = Disks {
            points: &self.frame.points,
            shapes: self.frame.shapes.as_deref().map_or(&[][..], Vec::as_slice),
            are_ellipses: self.frame.has_ellipses,
            // Sheets seen from behind are drawn.
            cull_back_faces: false,
        };
        Reference::traced(&Truth::of_disks(&disks, &self.truth_view(run)))
    }
}

/// The row of a case without an image.
fn row_without_image(case: &str, judged: Judged) -> Row {
    let measured = Measured {
        case: case.to_owned(),
        primitive: None,
        renderer: "",
        points: 0,
        draw_ms: Vec::new(),
        judged,
    };
    measured.row()
}

impl Measured {
    fn row(self) -> Row {
        let times = Quantiles::of(&self.draw_ms);
        let judged = self.judged;
        let text = |text: Option<String>| text.map_or(Cell::Missing, Cell::Text);
        Row::new(vec![
            Cell::Text(self.case),
            text(self.primitive.map(|primitive| primitive.to_string())),
            text(Some(self.renderer.to_owned()).filter(|name| !name.is_empty())),
            Cell::Text(judged.result),
            Cell::Number(self.points as f64),
            Cell::maybe(judged.flip),
            Cell::maybe(judged.psnr_db),
            Cell::maybe(judged.between_db),
            Cell::maybe(judged.hole_share),
            Cell::maybe(judged.covered_share),
            Cell::maybe(times.map(|times| times.median)),
            Cell::maybe(times.map(|times| times.max)),
            Cell::Text(judged.reference.to_owned()),
            text(judged.message),
        ])
    }
}
