//! View-dependent texturing (Yang et al. 2006): rendered images at the viewpoints of held-out images, compared with
//! these.
//!
//! How it works: some images of each set are held out, all at once, and their viewpoints are rendered from the others.
//! The held-out images are the ground truth. They are compared where something was drawn: a hole says nothing about
//! colours, and the fraction of holes is reported separately. Points of held-out depth images are held out as well
//! (`--leave-out`), and the surface for images without depths is built from the remaining points.
//!
//! For sequences without images, images are generated (`made.rs`), and a tree is added to them (`tree.rs`). For these
//! the ground truth is known, and so there are the paper's tables: bytes and errors (`sizes.rs`), clipping
//! (`clipped.rs`), and the rendering of a checkerboard (`checker.rs`).

mod backgrounds;
mod checker;
mod clipped;
mod columns;
mod made;
mod multiview;
mod sizes;
mod tree;

use crate::bench::report::{Cell, Row};
use crate::bench::run::{COVERAGE_BACKGROUNDS, Run};
use crate::bench::runner::Runner;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::bench::truth_cache::TruthCache;
use crate::bench::{BenchError, Quantiles};
use crate::composition::{PHOTO_BYTES, PictureView, packet};
use crate::measure::{SizeMismatch, flip, mean_squared_error, psnr_db};
use crate::photos::{LoadedPhotos, PosedImage, PosedImages};
use crate::render::AnyRenderer;
use crate::scene::{Background, EyeDome, FirstLook, Lighting, PhotoMode, Primitive, Scene, ScenePacket, Settings};
use crate::sequence::PreparedFrame;
use crate::stereo::photo_surface;
use backgrounds::is_covered;
use columns::{COLUMNS, SKIPPED};
use image::{Rgba, RgbaImage};
use multiview::{MultiView, TrueView};
use std::sync::Arc;

/// Points of the subsampled cloud, and of the tree: the paper's numbers for the Buddha and its tree (Yang et al. 2006,
/// Table 2).
const POINTS: usize = 5_000;
const POINTS_OF_TREE: usize = 145_000;

/// Suite of held-out images, rendered from the others.
pub const VDTS: &Suite = &Suite {
    name: "vdts",
    brief: "view-dependent texturing",
    title: "View-dependent texturing",
    hint: "Error of rendered views against held-out images",
    description: "held-out images, rendered from the others: view-dependent, from the nearest one, and in the colours \
        of the points (Yang et al. 2006); effects of bytes, clipping and filtering (Table 2, Figs. 5 and 10)",
    measured: "error against the held-out image, undistorted and exposure-compensated, over the pixels in which \
        something is drawn; `covered` is their share. ms: one image of the software renderer, depth maps of the input \
        images known. Sizes, clipping: errors against all points as disks in f64, over the pixels that show something \
        in either; ms at the requested image size; bytes of points as a sequence file and of images as JPEG files of \
        quality 90. Filtering: against 8×8 rays per pixel",
    not_measured: "reading images, depth maps, uploads. For sequences without images, 58 of 512×512 are rendered from \
        all their points, and used on 5,000 of them (145,000 for the tree, which is generated as well); clipping has \
        the depths of all points. Masks are not in the bytes",
    covered_by: "points",
    defaults: Defaults {
        viewport_px: [1280, 720],
        viewpoints: 1,
        frames: 1,
    },
    takes: &[OptionGroup::Photos],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "psnr_db",
    bars_title: "PSNR against the held-out image, dB",
    bar_labels: 3,
};

const MODES: [PhotoMode; 3] = [PhotoMode::Vdts, PhotoMode::Colored, PhotoMode::Single];

/// Rendered image with the held-out image that it is compared with.
struct Compared<'a> {
    posed_image: &'a PosedImage,
    mode: PhotoMode,
    covered: f64,
    psnr_db: f64,
    flip: f64,
    times_ms: Vec<f64>,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let mut runner = Runner::new(AnyRenderer::cpu());
    let mut has_made = false;
    for subject in run.subjects(1)? {
        has_made |= measure_sequence(run, &mut runner, &subject, POINTS)?;
    }
    if has_made {
        run.add_steps(1 + checker::STEPS);
        let tree = Subject {
            name: "tree",
            sequence: &Arc::new(tree::tree()),
            shape: None,
            chosen: vec![0],
        };
        measure_sequence(run, &mut runner, &tree, POINTS_OF_TREE)?;
        let rows = checker::measure(run, &mut runner, &settings())?;
        run.add_rows(rows);
    }
    Ok(())
}

/// Measures a sequence. Returns true if images were generated from it.
fn measure_sequence(
    run: &mut Run<'_>,
    runner: &mut Runner,
    subject: &Subject<'_>,
    few_points: usize,
) -> Result<bool, BenchError> {
    let index = subject.chosen.first().copied().unwrap_or(0);
    let settings = settings();
    let style = settings.decided().with(|style| style.of_sequence.has_photos = true);
    let Ok(frame) = run.load(subject, index, 1, &Scene::needs(&style))? else {
        return Ok(false);
    };
    let origin = subject.sequence.origin();
    let look = FirstLook::of_sequence(&frame.frame, subject.sequence);
    let style = settings.resolved(&look).with(|style| {
        style.primitive = Primitive::Surfel;
        style.of_sequence.has_photos = true;
    });
    if let Some(set) = subject.sequence.source().posed_images(index) {
        run.check_cancelled()?;
        let loaded = LoadedPhotos::of(&set, PHOTO_BYTES, run.progress());
        for note in &loaded.notes {
            run.note(format!("{}: {note}", subject.name));
        }
        let all = &loaded.posed_images;
        let used = all.without(&skipped(run, all));
        // Skipped images must not influence the estimated surface.
        let used = used.with_surface(photo_surface(&set, &used, origin, run.progress()));
        let shown = MultiView {
            name: subject.name,
            frame: &frame,
            origin,
            look: &look,
            style,
        };
        let rows = skip(run, runner, &shown, all, &Arc::new(used))?;
        run.finish(subject, &[frame.frame.len() as f64], &[], rows);
        return Ok(false);
    }
    let multiview = MultiView {
        name: subject.name,
        frame: &frame,
        origin,
        look: &look,
        style,
    };
    let Some(with_depths) = made::make(run, runner, &multiview)? else {
        return Ok(false);
    };
    let few = multiview.few(few_points)?;
    let posed_images = made::without_depths(&with_depths);
    let used = Arc::new(posed_images.without(&skipped(run, &posed_images)));
    let shown = MultiView {
        frame: &few,
        ..multiview
    };
    let mut rows = skip(run, runner, &shown, &posed_images, &used)?;
    rows.extend(tables_of_paper(run, runner, &multiview, &few, &with_depths)?);
    run.finish(subject, &[few.frame.len() as f64], &[], rows);
    Ok(true)
}

/// Returns the held-out images, by their numbers.
fn skipped(run: &Run<'_>, posed_images: &PosedImages) -> Vec<usize> {
    let numbers = posed_images.all().iter().map(|posed_image| posed_image.number + 1);
    run.options.leave_out.of(numbers.max().unwrap_or(0))
}

/// Renders the viewpoints of held-out images from those that are used.
fn skip(
    run: &mut Run<'_>,
    runner: &mut Runner,
    shown: &MultiView<'_>,
    posed_images: &PosedImages,
    used: &Arc<PosedImages>,
) -> Result<Vec<Row>, BenchError> {
    let skipped = skipped(run, posed_images);
    let mut rows = Vec::new();
    run.add_steps(skipped.len());
    let all = posed_images.all().iter();
    for posed_image in all.filter(|posed_image| skipped.contains(&posed_image.number)) {
        run.begin_step(format!("{}: {}", shown.name, posed_image.name))?;
        for mode in MODES {
            let compared = compare(run, runner, shown, posed_image, used, mode)?;
            rows.push(compared.row(shown.name, shown.frame.frame.len(), used.all().len()));
        }
    }
    Ok(rows)
}

/// Tables of generated input images, in views with known truth.
fn tables_of_paper(
    run: &mut Run<'_>,
    runner: &mut Runner,
    multiview: &MultiView<'_>,
    few: &PreparedFrame,
    with_depths: &PosedImages,
) -> Result<Vec<Row>, BenchError> {
    let skipped = skipped(run, with_depths);
    let cache = TruthCache::new(run.options.truth_folder.clone());
    run.add_steps(skipped.len() + sizes::STEPS + clipped::steps(multiview.frame.frame.len()));
    let mut views = Vec::new();
    for posed_image in with_depths.all() {
        if skipped.contains(&posed_image.number) {
            run.begin_step(format!("{}: the truth of {}", multiview.name, posed_image.name))?;
            let world_from_camera = posed_image.camera_from_world.inverse();
            let camera = multiview
                .look
                .camera_of_pinhole(&posed_image.pinhole, world_from_camera, multiview.origin);
            let size_px = posed_image.texture.size_px();
            views.push(TrueView::new(&cache, multiview, camera, size_px));
        }
    }
    if views.is_empty() {
        return Ok(Vec::new());
    }
    let with_depths = Arc::new(with_depths.without(&skipped));
    let used = Arc::new(made::without_depths(&with_depths));
    let mut rows = sizes::measure(run, runner, multiview, few, &used, &views)?;
    rows.extend(clipped::measure(run, runner, multiview, &with_depths, &views)?);
    Ok(rows)
}

/// Returns the render settings: unlit, as images have their lighting baked in.
fn settings() -> Settings {
    Settings::default().with(|settings| {
        settings.primitive = Primitive::Surfel.into();
        settings.light.lighting = Lighting::Unlit.into();
        settings.light.eye_dome = EyeDome::Off.into();
    })
}

fn compare<'a>(
    run: &Run<'_>,
    runner: &mut Runner,
    shown: &MultiView<'_>,
    posed_image: &'a PosedImage,
    used: &Arc<PosedImages>,
    mode: PhotoMode,
) -> Result<Compared<'a>, BenchError> {
    let world_from_camera = posed_image.camera_from_world.inverse();
    let view = PictureView {
        camera: &shown
            .look
            .camera_of_pinhole(&posed_image.pinhole, world_from_camera, shown.origin),
        origin: shown.origin,
        size_px: posed_image.texture.size_px(),
    };
    let frame = shown.frame.with_photos(Arc::clone(used));
    let mut scene = Scene::default();
    let mut packet_on = |background: [u8; 3]| -> ScenePacket {
        let style = shown.style.with(|style| {
            style.photos.mode = mode;
            style.backdrop.background = Background::solid(background);
        });
        packet(&mut scene, &frame, &view, &style)
    };
    let packets = COVERAGE_BACKGROUNDS.map(&mut packet_on);
    let mut times_ms = Vec::new();
    for round in 0..run.options.warmup + run.options.repeat {
        run.check_cancelled()?;
        let time = runner.draw(&packets[0])?;
        if round >= run.options.warmup {
            times_ms.push(time.wall_ms);
        }
    }
    let [on_dark, on_bright] = [runner.image(&packets[0])?, runner.image(&packets[1])?];
    let truth = truth_of(posed_image);
    // Pixels of the image that show nothing (outside its lens, or masked out) are not ground truth.
    let pixels = on_dark.pixels().zip(on_bright.pixels()).zip(truth.pixels());
    let compared: Vec<bool> = pixels
        .map(|((dark, bright), truth)| is_covered(*dark, *bright) && truth[3] == u8::MAX)
        .collect();
    let count = compared.iter().filter(|&&is_compared| is_compared).count();
    let mut picture = on_dark;
    // Pixels that are not compared have no error.
    for ((pixel, truth), &is_compared) in picture.pixels_mut().zip(truth.pixels()).zip(&compared) {
        if !is_compared {
            *pixel = *truth;
        }
    }
    let share = count as f64 / compared.len().max(1) as f64;
    let wrong_size = |error: SizeMismatch| BenchError::Nothing(error.to_string());
    let squared_error = mean_squared_error(&truth, &picture).map_err(wrong_size)?;
    let errors = flip(&truth, &picture).map_err(wrong_size)?;
    Ok(Compared {
        posed_image,
        mode,
        covered: share,
        psnr_db: psnr_db(squared_error / share.max(f64::MIN_POSITIVE)),
        flip: errors.mean_where(|pixel| compared[pixel]),
        times_ms,
    })
}

/// Returns the ground truth of an image: its content, adjusted to the brightness of the others.
fn truth_of(posed_image: &PosedImage) -> RgbaImage {
    let picture = &posed_image.texture.levels()[0];
    let [width, height] = picture.size_px();
    let gain = posed_image.gain.to_array();
    RgbaImage::from_fn(width, height, |x, y| {
        let [red, green, blue, alpha] = picture.pixels()[(width * y + x) as usize];
        let [red, green, blue] = [0, 1, 2].map(|at| {
            let value = f32::from([red, green, blue][at]) * gain[at];
            value.min(255.0).round() as u8
        });
        Rgba([red, green, blue, alpha])
    })
}

impl Compared<'_> {
    fn row(&self, sequence: &str, points: usize, posed_images: usize) -> Row {
        let [width, height] = self.posed_image.texture.size_px();
        let times = Quantiles::of(&self.times_ms);
        columns::row(
            SKIPPED,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("photo", Cell::Text(self.posed_image.name.clone())),
                ("number", Cell::Number(self.posed_image.number as f64)),
                ("mode", Cell::Text(self.mode.to_string())),
                ("points", Cell::Number(points as f64)),
                ("photographs", Cell::Number(posed_images as f64)),
                ("width", Cell::Number(f64::from(width))),
                ("height", Cell::Number(f64::from(height))),
                ("covered", Cell::Number(self.covered)),
                ("psnr_db", Cell::Number(self.psnr_db)),
                ("flip", Cell::Number(self.flip)),
                ("ms", Cell::maybe(times.map(|times| times.median))),
                ("ms_q3", Cell::maybe(times.map(|times| times.q3))),
            ],
        )
    }
}
