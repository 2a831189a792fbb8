//! Visible points, their normals and their image, compared with Table 1 and Fig. 4 of Hofer et al. 2018.
//!
//! How it works: clouds of the paper's sizes are made by merging views of one scene, as many as needed, each from
//! another position and with its own noise: more and more points of the same surface, up to the resolution of an image.
//! All stages are timed from memory to memory, in turns with the search of `AutoSplats` for the same visible points.
//! Where a GPU creates these surfels, an image of a new view is drawn as well, whose passes are timed by its own clock.

use super::made::{MADE_PX, SCENE_CENTER, made_cloud, pinhole};
use crate::analysis::screen::{ScreenCloud, ScreenEstimator, Search};
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::{BenchError, Quantiles};
use crate::cloud::Frame;
use crate::composition::{PictureView, packet};
use crate::render::PassTimes;
use crate::scene::{Camera, FirstLook, NormalSource, Primitive, Scene, Style, UpAxis, screen_view};
use crate::sequence::{PrepareCounters, PreparedFrame, prepare};
use crate::stopwatch::milliseconds_since;
use glam::{DAffine3, DVec3};
use std::sync::Arc;
use std::time::Instant;

/// Points of the clouds of the paper's Table 1, and its milliseconds for all stages (GTX 1060).
const PAPER: [(usize, f64); 4] = [(36_000, 3.92), (307_000, 7.56), (3_600_000, 19.92), (5_000_000, 28.90)];

/// Number of clouds in addition to the sequences'.
pub(super) const CLOUDS: usize = PAPER.len();

const TABLE: &str = "Visible points, their normals and their picture";

/// Columns between the name of a stage and the number of threads, which are of filters.
const FILTER_COLUMNS: usize = 9;

/// Measurements of one cloud.
#[expect(clippy::struct_field_names, reason = "names have their unit")]
#[derive(Default)]
struct Samples {
    cull_ms: Vec<f64>,
    normals_ms: Vec<f64>,
    bisected_ms: Vec<f64>,
    draw_ms: Vec<f64>,
    card_cull_ms: Vec<f64>,
    card_normals_ms: Vec<f64>,
}

/// A cloud, and where it is seen from.
struct ViewedCloud<'a> {
    name: &'a str,
    image: &'a str,
    frame: &'a PreparedFrame,
    origin: DVec3,
    camera: Camera,
    paper_ms: Option<f64>,
}

/// Clouds of the paper's sizes.
pub(super) fn measure_made(run: &mut Run<'_>) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    for (points, paper_ms) in PAPER {
        run.begin_step(format!("{points} points merged"))?;
        let Ok(frame) = Frame::from_raw(made_cloud(points), DVec3::ZERO) else {
            continue;
        };
        let frame = prepared(frame);
        // Seen like the sensor of the first view.
        let camera = Camera {
            target_in_world: SCENE_CENTER,
            ..Camera::of_pinhole(&pinhole(MADE_PX)?, DAffine3::IDENTITY, SCENE_CENTER.z, UpAxis::NegY)
        };
        rows.push(measure(
            run,
            &ViewedCloud {
                name: "made",
                image: "merged",
                frame: &frame,
                origin: DVec3::ZERO,
                camera,
                paper_ms: Some(paper_ms),
            },
        )?);
    }
    Ok(rows)
}

/// A frame of a sequence, from where its sensor stood if that is known.
pub(super) fn measure_frame(run: &mut Run<'_>, subject: &Subject<'_>, index: usize) -> Result<Option<Row>, BenchError> {
    run.begin_step(format!("{}: visible points", subject.named(index)))?;
    let Some(frame) = subject.sequence.frame(index).ok().filter(|frame| !frame.is_empty()) else {
        return Ok(None);
    };
    let origin = subject.sequence.origin();
    let frame = prepared(frame);
    let camera = match subject.sequence.source().sensor(index) {
        Some(sensor) => {
            let look = FirstLook::of(&[&frame.frame], origin);
            look.camera_of_pinhole(&sensor.rig.depth, DAffine3::IDENTITY, origin)
        }
        None => subject.framing(&frame),
    };
    measure(
        run,
        &ViewedCloud {
            name: subject.name,
            image: "recorded",
            frame: &frame,
            origin,
            camera,
            paper_ms: None,
        },
    )
    .map(Some)
}

fn prepared(frame: Frame) -> PreparedFrame {
    let needs = Scene::needs(&style());
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

/// Returns a style of surfels with screen-space normals.
fn style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.surfels.normals = NormalSource::Screen;
    })
}

fn measure(run: &mut Run<'_>, seen: &ViewedCloud<'_>) -> Result<Row, BenchError> {
    let viewport_px = run.options.viewport_px;
    let style = style().drawn_by(run.runner.is_processor());
    let picture_view = PictureView {
        camera: &seen.camera,
        origin: seen.origin,
        size_px: viewport_px,
    };
    let new_packet = || packet(&mut Scene::default(), seen.frame, &picture_view, &style);
    let packet = new_packet();
    let view = screen_view(&packet.view, packet.viewport_px);
    let cloud = ScreenCloud {
        spacing: packet.params.point_spacing,
        closing: 1.0,
        sensor: seen.frame.frame.sensor(),
    };
    let points = &seen.frame.points;
    let mut estimator = ScreenEstimator::default();
    let mut samples = Samples::default();
    let mut visible_count = 0;
    for round in 0..run.options.warmup + run.options.repeat {
        run.check_cancelled()?;
        let start = Instant::now();
        let visible = estimator.cull(&view, points, &cloud);
        let cull_ms = milliseconds_since(start);
        let start = Instant::now();
        estimator.surface(&visible, &cloud, Search::Fixed);
        let normals_ms = milliseconds_since(start);
        let start = Instant::now();
        estimator.surface(&visible, &cloud, Search::Bisected);
        let bisected_ms = milliseconds_since(start);
        let mut passes = PassTimes::default();
        if !run.runner.is_processor() {
            // Surfels of a packet are computed once, so a new, equal packet makes them computed again.
            passes = run.runner.draw(&new_packet())?.gpu_passes;
            run.runner.draw(&packet)?;
        }
        let on_card = |name| {
            let time = passes.iter().find(|time| time.pass == name);
            time.and_then(|time| time.gpu_ms)
        };
        let draw_ms = run.runner.draw(&packet)?.wall_ms;
        visible_count = visible.len();
        if round >= run.options.warmup {
            samples.cull_ms.push(cull_ms);
            samples.normals_ms.push(normals_ms);
            samples.bisected_ms.push(bisected_ms);
            samples.draw_ms.push(draw_ms);
            samples.card_cull_ms.extend(on_card("cull"));
            samples.card_normals_ms.extend(on_card("normals"));
        }
    }
    let has_card = !samples.card_cull_ms.is_empty();
    let card = has_card.then(|| run.runner.summary());
    Ok(row(seen, visible_count, card, &samples))
}

/// In the order of the suite's columns: columns of filters are missing.
fn row(seen: &ViewedCloud<'_>, visible: usize, card: Option<String>, samples: &Samples) -> Row {
    let median = |times: &[f64]| Quantiles::of(times).map(|times| times.median);
    let stages = [&samples.cull_ms, &samples.normals_ms, &samples.draw_ms].map(|times| median(times));
    let total = stages.iter().copied().sum::<Option<f64>>();
    let [cull, normals, draw] = stages;
    let mut cells = vec![
        Cell::Text(TABLE.to_owned()),
        Cell::Text(seen.name.to_owned()),
        Cell::Text(seen.image.to_owned()),
        Cell::Text("visible points to picture".to_owned()),
    ];
    cells.extend((0..FILTER_COLUMNS).map(|_| Cell::Missing));
    cells.push(card.map_or(Cell::Missing, Cell::Text));
    cells.push(Cell::Number(rayon::current_num_threads() as f64));
    cells.push(Cell::Number(seen.frame.points.len() as f64));
    cells.push(Cell::Number(visible as f64));
    let bisected = median(&samples.bisected_ms);
    let [card_cull, card_normals] = [&samples.card_cull_ms, &samples.card_normals_ms].map(|times| median(times));
    cells.extend(
        [
            cull,
            normals,
            draw,
            total,
            bisected,
            card_cull,
            card_normals,
            seen.paper_ms,
        ]
        .map(Cell::maybe),
    );
    Row::new(cells)
}
