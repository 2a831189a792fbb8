//! Depth images: decoding and each filter, on one thread, on all, and on a GPU; then the stages from their points to an
//! image (`screen.rs`).
//!
//! How it works: the frames of a recording are decoded as they are played, without filters. Each filter is then applied
//! to the output of the preceding ones, as often as requested; the two numbers of threads take turns, so that a
//! slowdown of the machine affects both. Where a GPU creates points from depth images, all of its passes over the image
//! are timed by its own clock, equally often. Sequences that are not depth images are measured with a synthetic image:
//! a ball before a wall, with the noise, the steps, the outliers and the holes of a sensor (`made.rs`).

mod made;
mod screen;

use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::cloud::RawCloud;
use crate::render::PassTimes;
use crate::rgbd::{DepthFrame, DepthImage, DepthSamples, Filters, RayTable, Temporal, TemporalFilter, cloud};
use crate::stopwatch::milliseconds_since;
use made::{made, pinhole};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// In the order in which [`Stage::row`] and `screen.rs` fill them.
const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    Column::text("sequence", "sequence"),
    Column::text("image", "image"),
    Column::text("stage", "stage"),
    Column::number("pixels", "pixels", 0),
    Column::number("valid", "measured", 0),
    Column::number("valid_after", "kept", 0),
    Column::number("one_thread_ms_median", "ms, 1 thread", 3),
    Column::number("one_thread_ms_q3", "75 %", 3).hidden(),
    Column::number("all_threads_ms_median", "ms, all threads", 3),
    Column::number("all_threads_ms_q3", "75 %", 3).hidden(),
    Column::number("mpixels_per_s", "M pixels/s, 1 thread", 1),
    Column::number("card_ms_median", "ms, card", 3),
    Column::text("card", "card").hidden(),
    Column::number("threads", "threads", 0).hidden(),
    Column::number("points", "points", 0),
    Column::number("visible", "visible", 0),
    Column::number("cull_ms_median", "cull ms", 2),
    Column::number("normals_ms_median", "normals ms", 2),
    Column::number("draw_ms_median", "draw ms", 2),
    Column::number("total_ms", "all ms", 2),
    Column::number("bisected_ms_median", "normals by bisection ms", 2),
    Column::number("card_cull_ms_median", "cull ms, card", 3),
    Column::number("card_normals_ms_median", "normals ms, card", 3),
    Column::number("paper_ms", "paper, all ms", 2),
];

/// The name of the table of filters.
const FILTER_TABLE: &str = "Depth images";

/// Columns after the number of threads, which filters leave empty.
const SCREEN_COLUMNS: usize = 10;

/// Decoding and filters of depth images.
pub const RGBD: &Suite = &Suite {
    name: "rgbd",
    brief: "depth images",
    title: "Depth images",
    hint: "Times of decoding depth images, of each of their filters, and of images with screen-space normals",
    description: "decoding recordings of depth images, their filters, and images with screen-space normals",
    measured: "files in the cache of the system to a cloud (decode); each filter of the image that those before it \
        made, from memory to memory; visible points, their normals and radii, and the image of them on all threads; \
        passes of a GPU by its own clock, where it computes points and normals; medians",
    not_measured: "disks, Morton order, uploads, showing; the paper's times are those of its GPU",
    covered_by: "points",
    defaults: Defaults {
        viewport_px: [1920, 1080],
        viewpoints: 1,
        frames: 3,
    },
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "one_thread_ms_median",
    bars_title: "Time on one thread, median ms",
    bar_labels: 3,
};

/// Decoding, each filter, the usual filters together, and points.
const STEPS_PER_FRAME: usize = 3 + Filters::COUNT;

/// The filters that look at one image alone: their collective name, and their individual keys.
const USUAL_STAGE: &str = "usual filters";
const USUAL: [&str; 4] = ["near", "median", "bilateral", "flying"];

/// Points of the pixels.
const POINTS_STAGE: &str = "reproject";

/// The first frame of a sequence is drawn, too.
const STEPS_PER_SEQUENCE: usize = 1;

/// Measurements of one stage.
struct Stage {
    name: &'static str,
    frames: usize,
    pixels: usize,
    valid: usize,
    valid_after: usize,
    one_thread_ms: Vec<f64>,
    all_threads_ms: Vec<f64>,
    card_ms: Vec<f64>,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let one_thread = ThreadPoolBuilder::new().num_threads(1).build()?;
    let subjects = run.subjects(STEPS_PER_FRAME)?;
    run.add_steps(subjects.len() * STEPS_PER_SEQUENCE + screen::CLOUDS);
    for subject in subjects {
        let mut stages: Vec<Stage> = Vec::new();
        let (mut image_kind, mut pixels) = ("made", Vec::new());
        for &index in &subject.chosen {
            let label = |stage: &str| format!("{}: {stage}", subject.named(index));
            run.begin_step(label("decode"))?;
            let recorded = subject.sequence.decode(index).ok().and_then(|cloud| depth_of(&cloud));
            if let Some(image) = &recorded {
                image_kind = "recorded";
                decode(run, &subject, index, image, &one_thread, &mut stages)?;
            }
            let Some(image) = recorded.or_else(made) else {
                continue;
            };
            pixels.push(image.metres().len() as f64);
            let sensor = subject.sequence.source().sensor(index);
            let rays = match sensor.filter(|sensor| sensor.rig.depth.size_px() == image.size_px()) {
                Some(sensor) => RayTable::of(&sensor.rig.depth),
                None => RayTable::of(&pinhole(image.size_px())?),
            };
            let rays = Arc::new(rays);
            let on_card = on_card(run, &image, &rays)?;
            filter(run, image, &rays, &label, &one_thread, &mut stages)?;
            for stage in &mut stages {
                stage
                    .card_ms
                    .extend(on_card.iter().filter_map(|times| times.of(stage.name)));
            }
        }
        let card = run.runner.summary();
        let row = |stage: &Stage| stage.row(subject.name, image_kind, &card);
        let mut rows: Vec<Row> = stages.iter().map(row).collect();
        if let Some(&index) = subject.chosen.first() {
            rows.extend(screen::measure_frame(run, &subject, index)?);
        }
        run.finish(&subject, &pixels, &[], rows);
    }
    let rows = screen::measure_made(run)?;
    run.add_rows(rows);
    Ok(())
}

/// The depths of an organised cloud in the frame of a camera.
fn depth_of(cloud: &RawCloud) -> Option<DepthImage> {
    let grid = cloud.grid?;
    let depths = (0..cloud.positions.len()).map(|index| cloud.positions.get(index).z as f32);
    let image = DepthImage::new([grid.width(), grid.height()], depths.collect())?;
    (image.valid_count() > 0).then_some(image)
}

fn decode(
    run: &Run<'_>,
    subject: &Subject<'_>,
    index: usize,
    image: &DepthImage,
    one_thread: &ThreadPool,
    stages: &mut Vec<Stage>,
) -> Result<(), BenchError> {
    let stage = stage_of(stages, "decode", image);
    stage.valid_after += image.valid_count();
    time(run, stage, one_thread, || {
        drop(black_box(subject.sequence.decode(index)));
    })
}

/// Each filter after those before it, then all of them together, and points.
fn filter(
    run: &mut Run<'_>,
    mut image: DepthImage,
    rays: &RayTable,
    label: &dyn Fn(&str) -> String,
    one_thread: &ThreadPool,
    stages: &mut Vec<Stage>,
) -> Result<(), BenchError> {
    let raw = image.clone();
    for name in Filters::kinds().iter().map(|kind| kind.name) {
        run.begin_step(label(name))?;
        let filters: Filters = name.parse().unwrap_or_default();
        let apply = |image: &DepthImage| match filters.temporal {
            // The second of two images: the first has no predecessor.
            Some(temporal) => {
                let mut filter = TemporalFilter::new(temporal);
                filter.next(image.clone());
                filter.next(image.clone())
            }
            None => filters.apply(image.clone()),
        };
        let filtered = apply(&image);
        let stage = stage_of(stages, name, &image);
        stage.valid_after += filtered.valid_count();
        time(run, stage, one_thread, || drop(black_box(apply(&image))))?;
        image = filtered;
    }
    run.begin_step(label(USUAL_STAGE))?;
    let apply = || Filters::USUAL.apply(raw.clone());
    let stage = stage_of(stages, USUAL_STAGE, &raw);
    stage.valid_after += apply().valid_count();
    time(run, stage, one_thread, || drop(black_box(apply())))?;
    run.begin_step(label(POINTS_STAGE))?;
    let stage = stage_of(stages, POINTS_STAGE, &image);
    stage.valid_after += image.valid_count();
    time(run, stage, one_thread, || drop(black_box(cloud(&image, rays, None))))
}

/// GPU times of the passes over one image.
struct CardTimes(PassTimes);

impl CardTimes {
    fn of(&self, stage: &str) -> Option<f64> {
        let sum = |names: &[&str]| {
            let times = self.0.iter().filter(|time| names.contains(&time.pass));
            let times: Option<Vec<f64>> = times.map(|time| time.gpu_ms).collect();
            times.filter(|times| !times.is_empty()).map(|times| times.iter().sum())
        };
        if stage == USUAL_STAGE {
            sum(&USUAL)
        } else {
            sum(&[stage])
        }
    }
}

/// All filters and the points of an image on a GPU, as often as requested; nothing where no GPU creates points.
fn on_card(run: &mut Run<'_>, image: &DepthImage, rays: &Arc<RayTable>) -> Result<Vec<CardTimes>, BenchError> {
    let filters = Filters {
        temporal: Some(Temporal::USUAL),
        ..Filters::USUAL
    };
    let mut all = Vec::new();
    for round in 0..run.options.warmup + run.options.repeat {
        run.check_cancelled()?;
        let samples = || Arc::new(DepthSamples::metres(image.metres().to_vec()));
        // The second of two images, as on the CPU.
        let Some(frame) = DepthFrame::new(vec![samples()], samples(), Arc::clone(rays), None, filters) else {
            break;
        };
        let Some(times) = run.runner.depth_image_times(&Arc::new(frame))? else {
            break;
        };
        if round >= run.options.warmup {
            all.push(CardTimes(times));
        }
    }
    Ok(all)
}

/// The stage of this name, to which `image` is given.
fn stage_of<'a>(stages: &'a mut Vec<Stage>, name: &'static str, image: &DepthImage) -> &'a mut Stage {
    let place = stages.iter().position(|stage| stage.name == name).unwrap_or_else(|| {
        stages.push(Stage {
            name,
            frames: 0,
            pixels: 0,
            valid: 0,
            valid_after: 0,
            one_thread_ms: Vec::new(),
            all_threads_ms: Vec::new(),
            card_ms: Vec::new(),
        });
        stages.len() - 1
    });
    let stage = &mut stages[place];
    stage.frames += 1;
    stage.pixels += image.metres().len();
    stage.valid += image.valid_count();
    stage
}

fn time(
    run: &Run<'_>,
    stage: &mut Stage,
    one_thread: &ThreadPool,
    work: impl Fn() + Send + Sync,
) -> Result<(), BenchError> {
    for round in 0..run.options.warmup + run.options.repeat {
        run.check_cancelled()?;
        let start = Instant::now();
        one_thread.install(&work);
        let one_thread_ms = milliseconds_since(start);
        let start = Instant::now();
        work();
        let all_threads_ms = milliseconds_since(start);
        if round >= run.options.warmup {
            stage.one_thread_ms.push(one_thread_ms);
            stage.all_threads_ms.push(all_threads_ms);
        }
    }
    Ok(())
}

impl Stage {
    fn row(&self, sequence: &str, image: &str, card: &str) -> Row {
        let one = Quantiles::of(&self.one_thread_ms);
        let all = Quantiles::of(&self.all_threads_ms);
        let on_card = Quantiles::of(&self.card_ms);
        // Counts add up over frames; times are per frame.
        let frames = self.frames.max(1) as f64;
        let pixels = self.pixels as f64 / frames;
        let mut cells = vec![
            Cell::Text(FILTER_TABLE.to_owned()),
            Cell::Text(sequence.to_owned()),
            Cell::Text(image.to_owned()),
            Cell::Text(self.name.to_owned()),
            Cell::Number(pixels),
            Cell::Number(self.valid as f64 / frames),
            Cell::Number(self.valid_after as f64 / frames),
            Cell::maybe(one.map(|times| times.median)),
            Cell::maybe(one.map(|times| times.q3)),
            Cell::maybe(all.map(|times| times.median)),
            Cell::maybe(all.map(|times| times.q3)),
            Cell::maybe(one.map(|times| pixels / (1e3 * times.median))),
            Cell::maybe(on_card.map(|times| times.median)),
            on_card.map_or(Cell::Missing, |_| Cell::Text(card.to_owned())),
            Cell::Number(rayon::current_num_threads() as f64),
        ];
        cells.extend((0..SCREEN_COLUMNS).map(|_| Cell::Missing));
        Row::new(cells)
    }
}
