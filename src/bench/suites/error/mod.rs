//! The error lab: the time *and the error* of each render mode.
//!
//! How it works: each frame is seen from viewpoints around it. The ground truth of a view has 8×8 samples per pixel
//! (`render/truth`). It shows the shape that the points were sampled from, of the triangles of the file, of its
//! ellipses, or of the disks of all points (`truths.rs`). Each mode draws the same views; its time is from the camera
//! to the finished image, including traversal and uploads of the chosen records, as a user who orbits the object waits
//! for them. Its errors are means over all images. For each sequence the modes that no other beats in both form its
//! front.
//!
//! The camera then turns by half a degree, and the change to that image is compared with the change of the truth: the
//! temporal error, with its own front. The suite `temporal` has more kinds of change.
//!
//! A mode is compared with the truth under its own light, points are lit by their normals like everything else, and a
//! front has modes of one light.
//!
//! Depths, which distinguish surfaces, are drawn by the software renderer for the adapter's modes too: both draw the
//! same surfaces, which `tests/pictures/cpu_renderer.rs` checks.

pub(super) mod truths;
pub(super) mod variants;
pub(super) mod view;

use crate::bench::lab::{LabError, LabPoint, mark_fronts};
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::small_picture::small;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::bench::truth_cache::TruthCache;
use crate::bench::{BenchError, Quantiles};
use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::measure::{SurfaceError, psnr_db};
use crate::render::cpu::CpuRenderer;
use crate::render::{AnyRenderer, Renderer};
use crate::scene::describe::Conditions as _;
use crate::scene::{
    BackFaces, Background, Camera, FirstLook, Lighting, PhysicalLight, Primitive, RendererChoice, Scene, ScenePacket,
    Settings, Style,
};
use crate::sequence::{PrepareCounters, PreparedFrame, PreparedMesh, complete, prepare};
use crate::stopwatch::milliseconds_since;
use image::RgbaImage;
use std::sync::Arc;
use std::time::Instant;
use truths::{FrameTruth, TruthKind, TruthLight};
use view::{DrawnWay, LitTruth, PictureError, View};

/// Columns, in the order in which [`ErrorSamples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("way", "way"),
    Column::text("front", "front"),
    Column::text("front_over_time", "steady front"),
    Column::text("truth", "truth"),
    Column::text("renderer", "renderer").hidden(),
    Column::text("primitive", "primitive").hidden(),
    Column::text("splatting", "splatting").hidden(),
    Column::text("strategy", "strategy").hidden(),
    Column::text("lighting", "lighting").hidden(),
    Column::number("lod_px", "τ px", 1).hidden(),
    Column::number("delta", "δ", 2).hidden(),
    Column::number("splat_scale", "splat scale", 2).hidden(),
    Column::number("point_size_px", "point px", 1).hidden(),
    Column::number("drawn_width_px", "width", 0).hidden(),
    Column::number("drawn_height_px", "height", 0).hidden(),
    Column::number("draw_ms_median", "ms", 2),
    Column::number("draw_ms_q1", "25 %", 2).hidden(),
    Column::number("draw_ms_q3", "75 %", 2).hidden(),
    Column::number("flip_object_mean", "FLIP of object", 4),
    Column::number("flip_mean", "FLIP", 4),
    Column::number("flip_over_time", "FLIP over time", 4),
    Column::number("psnr_db", "PSNR dB", 2),
    Column::number("ssim", "SSIM", 4),
    Column::percent("hole_share", "holes", 3),
    Column::percent("wrong_surface_share", "wrong surface", 3),
    Column::percent("extra_share", "too much", 3),
    Column::number("uploaded_bytes", "bytes", 0),
    Column::number("drawn_records", "drawn", 0),
    Column::number("visited_nodes", "visited", 0),
    Column::number("pictures", "pictures", 0).hidden(),
];

/// Image errors together with draw times, for every render mode.
pub const ERROR: &Suite = &Suite {
    name: "error",
    brief: "image error and time of every render mode",
    title: "Time × error",
    hint: "Time and error of every render mode, against the truth; a click on a point selects its mode",
    description: "image errors against the truth and times, for every render mode",
    measured: "CPU wall time from camera to finished image, including traversal and uploads of what it chose; errors \
        against the truth in the same light (the formula of a sampled shape, else the triangles of the file, its \
        ellipses, or disks of all points, of which --subsample draws a part: a dense twin; 8x8 samples per pixel in \
        f64): FLIP over the pixels that show the object and over all, PSNR, SSIM, \
        background where the surface is (holes), another surface than a splat's diameter away (wrong surface), surface \
        where the background is (too much); bytes uploaded for a first image; mean absolute difference between the \
        FLIP of two consecutive images, between which the camera turns by half a degree, and that of the truth (FLIP \
        over time); on the front is what no other mode beats in the same light in time and FLIP of the object, on the \
        steady front in time and FLIP over time",
    not_measured: "decoding, normals, octrees, reading back, showing",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [1280, 720],
        viewpoints: 2,
        frames: 1,
    },
    takes: &[OptionGroup::Modes],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "flip_object_mean",
    bars_title: "FLIP of the object, 0 to 1",
    bar_labels: 2,
};

/// Measurements of one mode on one sequence.
#[derive(Default)]
struct ErrorSamples {
    draw_ms: Vec<f64>,
    flip_object: Vec<f64>,
    flip: Vec<f64>,
    flip_over_time: Vec<f64>,
    squared: Vec<f64>,
    ssim: Vec<f64>,
    surface: SurfaceError,
    uploaded_bytes: Vec<f64>,
    drawn_records: Vec<f64>,
    visited_nodes: Vec<f64>,
    drawn_px: [u32; 2],
    /// Kinds of truth that the frames had.
    truths: Vec<TruthKind>,
    /// Thumbnails of the first view.
    thumbnails: Option<[RgbaImage; 2]>,
}

/// Turn of the camera from image to image, degrees.
const TURN_DEG: f64 = 0.5;

/// Renderers: always the CPU, and an adapter if there is one.
struct Runners {
    processor: Runner,
    /// Draws depths, so that the CPU renderer's clocks are not disturbed.
    depths: CpuRenderer,
    cache: TruthCache,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let variants = variants::selected(run, variants::variants(!run.runner.is_processor()))?;
    let mut runners = Runners {
        processor: Runner::new(AnyRenderer::cpu()),
        depths: CpuRenderer::new(),
        cache: TruthCache::new(run.options.truth_folder.clone()),
    };
    // One step to prepare a frame, one for its ground truth, one per variant.
    let steps_per_frame = 2 + variants.len();
    for subject in run.subjects(steps_per_frame)? {
        measure_sequence(run, &mut runners, &subject, &variants, steps_per_frame)?;
    }
    Ok(())
}

fn measure_sequence(
    run: &mut Run<'_>,
    runners: &mut Runners,
    subject: &Subject<'_>,
    variants: &[Settings],
    steps_per_frame: usize,
) -> Result<(), BenchError> {
    // Viewpoints are placed by surfels.
    let needs = Scene::needs(&Style::default());
    let mut samples: Vec<ErrorSamples> = variants.iter().map(|_| ErrorSamples::default()).collect();
    let (mut point_counts, mut coverages) = (Vec::new(), Vec::new());
    let mut first_failure = None;
    for &index in &subject.chosen {
        let whole = match run.load(subject, index, steps_per_frame, &needs)? {
            Ok(frame) => with_triangles(run, subject, frame)?,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        let frame = subsampled(run, subject, &whole)?;
        point_counts.push(frame.points.len() as f64);
        run.begin_step(format!("{}: the truth", subject.named(index)))?;
        let viewpoints = run.viewpoints(subject, &whole, &Style::default())?;
        let truth = FrameTruth::new(subject.shape, &whole, &frame);
        coverages.extend(viewpoints.iter().map(|viewpoint| viewpoint.coverage));
        let mut views = Vec::new();
        for viewpoint in viewpoints {
            views.push(view(
                run,
                &runners.cache,
                subject,
                &truth,
                &frame,
                viewpoint.camera,
                variants,
            )?);
        }
        let back_faces = back_faces(subject, &whole, truth.kind());
        for (way, samples) in variants.iter().zip(&mut samples) {
            let label = variants::label(way);
            run.begin_step(format!("{}: {label}", subject.named(index)))?;
            if way.primitive == Primitive::Mesh && frame.triangles().is_none() {
                continue;
            }
            let style = way.decided().with(|style| style.surfels.back_faces = back_faces);
            measure_way(run, runners, subject, &frame, &views, &style, samples)?;
            if !samples.truths.contains(&truth.kind()) {
                samples.truths.push(truth.kind());
            }
            run.say_measured(samples.point(subject.name, way));
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let measured = || {
        let all = variants.iter().zip(&samples);
        all.filter(|(_, samples)| !samples.flip.is_empty())
    };
    let mut points: Vec<LabPoint> = measured()
        .map(|(way, samples)| samples.point(subject.name, way))
        .collect();
    mark_fronts(&mut points);
    let rows: Vec<Row> = points
        .iter()
        .zip(measured())
        .map(|(point, (_, samples))| samples.row(point))
        .collect();
    for kind in samples.first().map_or(&[][..], |samples| samples.truths.as_slice()) {
        run.note(format!("{}: the truth is {}", subject.name, kind.described()));
    }
    run.finish(subject, &point_counts, &coverages, rows);
    run.add_points(points);
    Ok(())
}

/// The frame with the triangles of its file, if it has some that can be read.
pub(super) fn with_triangles(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    mut frame: PreparedFrame,
) -> Result<PreparedFrame, BenchError> {
    if !frame.frame.has_faces() {
        return Ok(frame);
    }
    let mesh = subject.sequence.load_mesh(frame.index, run.progress());
    run.check_cancelled()?;
    match mesh {
        Ok(mesh) => frame.mesh = Some(PreparedMesh::new(Arc::new(mesh), frame.paint())),
        Err(reason) => run.note(format!(
            "{}: drawn without its triangles: {reason}",
            subject.named(frame.index)
        )),
    }
    Ok(frame)
}

/// The part of a frame that is drawn, prepared as if the others had never been scanned; the frame itself unless a part
/// was requested.
fn subsampled(run: &mut Run<'_>, subject: &Subject<'_>, whole: &PreparedFrame) -> Result<PreparedFrame, BenchError> {
    let Some(share) = run.options.subsample else {
        return Ok(whole.clone());
    };
    let named = subject.named(whole.index);
    let failure = |reason: crate::cloud::CloudError| BenchError::NoFrame {
        sequence: named.clone(),
        reason: reason.to_string(),
    };
    let (part, _) = whole.frame.sample(share.of(whole.points.len())).map_err(failure)?;
    run.note(format!(
        "{named}: {} of {} points are drawn",
        part.len(),
        whole.points.len()
    ));
    let needs = Scene::needs(&Style::default());
    let mut part = prepare(whole.index, Arc::new(part), 0.0, &needs, &PrepareCounters::default());
    part.mesh.clone_from(&whole.mesh);
    Ok(part)
}

/// The view from `camera`, with the truth in each light that a mode has.
fn view(
    run: &Run<'_>,
    cache: &TruthCache,
    subject: &Subject<'_>,
    truth: &FrameTruth,
    frame: &PreparedFrame,
    camera: Camera,
    variants: &[Settings],
) -> Result<View, BenchError> {
    let (origin, size_px) = (subject.sequence.origin(), run.options.viewport_px);
    let next_camera = turned(camera, 1);
    let mut truths: Vec<LitTruth> = Vec::new();
    let mut seen: Vec<Lighting> = Vec::new();
    for way in variants {
        let way = way.decided();
        let lighting = way.light.lighting.at_each_pixel();
        if seen.contains(&lighting) {
            continue;
        }
        run.check_cancelled()?;
        seen.push(lighting);
        let physical = (lighting == Lighting::Physical)
            .then(|| subject.packet(&mut Scene::default(), frame, &camera, &way, size_px))
            .and_then(|packet| PhysicalLight::of(&packet));
        let light = TruthLight { lighting, physical };
        let [now, next] = [camera, next_camera].map(|camera| truth.seen(cache, origin, &camera, size_px, &light));
        truths.push(LitTruth::new(lighting, now, next.image));
    }
    Ok(View {
        camera,
        next_camera,
        truths,
    })
}

/// The camera some images later, turning about its target.
pub(super) fn turned(camera: Camera, images: u32) -> Camera {
    Camera {
        azimuth_deg: camera.azimuth_deg + TURN_DEG * f64::from(images),
        ..camera
    }
}

/// Back-face setting of surfels: as in their truth. Disks and shapes are culled there. A mesh has two sides, and the
/// inside of an open surface is drawn; not darker, as in the truth.
fn back_faces(subject: &Subject<'_>, frame: &PreparedFrame, kind: TruthKind) -> BackFaces {
    let is_closed = || FirstLook::of(&[&frame.frame], subject.sequence.origin()).is_closed;
    if kind == TruthKind::Mesh && !is_closed() {
        BackFaces::Drawn
    } else {
        BackFaces::Culled
    }
}

fn measure_way(
    run: &mut Run<'_>,
    runners: &mut Runners,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    views: &[View],
    way: &Style,
    samples: &mut ErrorSamples,
) -> Result<(), BenchError> {
    let mut frame = complete(frame, &Scene::needs(way), &PrepareCounters::default());
    // A renderer takes a copy for a different cloud, so that its upload is counted.
    frame.points = Arc::new(frame.points.to_vec());
    frame.shapes = frame.shapes.map(|shapes| Arc::new(shapes.to_vec()));
    let viewport_px = run.options.viewport_px;
    let packet = |scene: &mut Scene, camera: &Camera| subject.packet(scene, &frame, camera, way, viewport_px);
    let (options, progress) = (run.options, run.progress);
    let runner = if way.drawing.renderer == RendererChoice::Gpu {
        &mut run.runner
    } else {
        &mut runners.processor
    };
    for view in views {
        BenchError::check_cancelled(progress)?;
        let uploaded_before = runner.stats().uploaded_bytes;
        let mut scene = Scene::default();
        let drawn_packet = packet(&mut scene, &view.camera);
        let visited_nodes = scene.stats().visited_nodes;
        let image = runner.image(&drawn_packet)?;
        let uploaded_bytes = runner.stats().uploaded_bytes - uploaded_before;
        let on_white = runner.image(&on_white(&drawn_packet))?;
        let depth = depths(&mut runners.depths, &drawn_packet)?;
        // The scene remembers the same state of the previous image in a window.
        let next_packet = packet(&mut scene, &view.next_camera);
        let drawn = DrawnWay {
            image,
            on_white,
            next: runner.image(&next_packet)?,
            depth,
        };
        let (error, image) = view.truth_in(way.light.lighting)?.compare(drawn)?;
        samples.add(&drawn_packet, visited_nodes, uploaded_bytes, &error);
        if samples.thumbnails.is_none() {
            samples.thumbnails = Some([small(&image), small(&error.map.to_heatmap())]);
        }
    }
    for round in 0..options.warmup + options.repeat {
        for view in views {
            BenchError::check_cancelled(progress)?;
            let start = Instant::now();
            // As after a camera move: cells are selected again.
            runner.draw(&packet(&mut Scene::default(), &view.camera))?;
            if round >= options.warmup {
                samples.draw_ms.push(milliseconds_since(start));
            }
        }
    }
    Ok(())
}

/// Packet of the image on white. The packet's own settings, since composition decides some by the scene: points as wide
/// as their spacing are drawn as single pixels otherwise, with holes all over.
fn on_white(drawn: &ScenePacket) -> ScenePacket {
    let mut packet = drawn.clone();
    packet.style.backdrop.background = Background::solid([255; 3]);
    packet
}

/// Returns true if depths can be drawn for a mode: not for splats without depth, nor for byte codes.
fn shows_known_surface<C: Copy>(way: &Style<C>) -> bool {
    way.leaves_depths() && !way.draws_codes()
}

/// Renders the depth image of a packet, if it shows one surface.
fn depths(renderer: &mut CpuRenderer, packet: &ScenePacket) -> Result<Option<crate::measure::DepthImage>, BenchError> {
    if !shows_known_surface(&packet.style) {
        return Ok(None);
    }
    renderer.prepare(packet)?;
    Ok(Some(renderer.draw_depths()?))
}

impl ErrorSamples {
    fn add(&mut self, packet: &ScenePacket, visited_nodes: usize, uploaded_bytes: u64, error: &PictureError) {
        self.drawn_px = packet.viewport_px;
        self.drawn_records.push(packet.content.record_count() as f64);
        self.visited_nodes.push(visited_nodes as f64);
        self.uploaded_bytes.push(uploaded_bytes as f64);
        self.flip.push(error.map.mean());
        self.flip_object.push(error.flip_object);
        self.flip_over_time.push(error.temporal.flip);
        self.squared.push(error.squared);
        self.ssim.push(error.ssim);
        self.surface += error.surface;
    }

    fn point(&self, sequence: &str, way: &Settings) -> LabPoint {
        let [picture, error_map] = self.thumbnails.clone().unwrap_or_default();
        LabPoint {
            sequence: sequence.to_owned(),
            style: *way,
            label: variants::label(way),
            draw_ms: Quantiles::of(&self.draw_ms).map_or(0.0, |q| q.median),
            flip: mean(&self.flip_object),
            flip_over_time: mean(&self.flip_over_time),
            on_fronts: [false; LabError::ALL.len()],
            picture,
            error_map,
        }
    }

    fn row(&self, point: &LabPoint) -> Row {
        let way = point.style.decided();
        let draw = Quantiles::of(&self.draw_ms);
        let psnr = psnr_db(mean(&self.squared));
        let is_surfel = way.draws_surfels();
        let is_gpu = way.drawing.renderer == RendererChoice::Gpu;
        let text_if = |is_there: bool, text: &str| {
            if is_there {
                Cell::Text(text.to_owned())
            } else {
                Cell::Missing
            }
        };
        let number_if = |is_there: bool, number: f32| Cell::maybe(is_there.then_some(f64::from(number)));
        let has_depth = shows_known_surface(&way);
        let threshold = match way.levels.lod {
            Lod::ThresholdPx(threshold) if way.draws_cells() || way.draws_codes() => Some(f64::from(threshold)),
            _ => None,
        };
        let delta = match way.octree_stop() {
            StopCriterion::Loss(delta) if way.draws_cells() => Some(f64::from(delta)),
            _ => None,
        };
        Row::new(vec![
            Cell::Text(point.sequence.clone()),
            Cell::Text(point.label.clone()),
            text_if(point.is_on_front(LabError::Image), "yes"),
            text_if(point.is_on_front(LabError::OverTime), "yes"),
            Cell::Text(
                self.truths
                    .iter()
                    .map(|kind| kind.name())
                    .collect::<Vec<_>>()
                    .join(", "),
            ),
            Cell::Text(way.drawing.renderer.to_string()),
            Cell::Text(way.primitive.to_string()),
            text_if(is_surfel, way.surfels.splatting.name()),
            text_if(is_gpu, way.drawing.strategy.name()),
            text_if(way.is_lit(), point.style.light.lighting.name()),
            Cell::maybe(threshold),
            Cell::maybe(delta),
            number_if(is_surfel, way.surfels.splat_scale),
            number_if(way.has_points_of_pixels(), way.points.size_px),
            Cell::Number(f64::from(self.drawn_px[0])),
            Cell::Number(f64::from(self.drawn_px[1])),
            Cell::maybe(draw.map(|q| q.median)),
            Cell::maybe(draw.map(|q| q.q1)),
            Cell::maybe(draw.map(|q| q.q3)),
            Cell::Number(point.flip),
            Cell::Number(mean(&self.flip)),
            Cell::Number(point.flip_over_time),
            Cell::maybe(psnr.is_finite().then_some(psnr)),
            Cell::Number(mean(&self.ssim)),
            Cell::Number(self.surface.hole_share()),
            Cell::maybe(has_depth.then(|| self.surface.wrong_surface_share())),
            Cell::Number(self.surface.extra_share()),
            Cell::Number(mean(&self.uploaded_bytes)),
            Cell::Number(mean(&self.drawn_records)),
            Cell::maybe(way.draws_cells().then(|| mean(&self.visited_nodes))),
            Cell::Number(self.flip.len() as f64),
        ])
    }
}
