//! Depth from images: a pair of 1.4 megapixels, one of 128 × 128 pixels, and a plane sweep.
//!
//! *aloe* is a pair of Middlebury's 2006 sets (1282 × 1110), if `../shared/data` is there: its range found, and matched
//! in the range that was found by semi-global matching and by the local winner. *128* is a slanted plane of random
//! texture, 64 disparities; *sweep* five views of it, 256 × 192 pixels. Each on one thread and on one per core,
//! everything allocated, from grey (aloe, 128) or coloured images (sweep) in memory. *128* is matched by the GPU as
//! well (or by a software adapter: the name of the adapter is in the label), from images in memory to disparities in
//! memory.
//!
//! Before, errors of aloe are printed: over all pixels whose truth is known, and over those that OpenCV's SGBM answers
//! where `target/opencv_sgbm.f32` is there (`scripts/opencv_sgbm.py` writes it and prints OpenCV's times and errors).
//! The truth is in whole pixels, and the median of signed errors is not 0 for any matcher, OpenCV's included. So the
//! median is printed as it is, in steps of 1/16 px (OpenCV's answers have no finer ones), and less the signed median.
//!
//! Not measured: decoding, rectification.

#![expect(clippy::print_stdout, reason = "a bench prints")]

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DAffine3, DVec2, DVec3};
use pointreel::render::gpu::{CardMatcher, Context, ContextOptions};
use pointreel::rgbd::{Camera, ColorImage, Distortion};
use pointreel::stereo::{Between, DisparityMap, DisparityRange, GrayImage, Matching, PairMatcher, PlaneSweep, View};
use std::path::Path;

#[path = "shapes/threads.rs"]
mod threads;

use threads::bench_on_threads;

const ALOE: &str = "../shared/data/stereo/aloe";

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A texture without order, smooth between knots 3 px apart.
fn texture(x: f64, y: f64) -> f64 {
    let knot = |x: f64, y: f64| {
        let mut bits = (x as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as i64 as u64).rotate_left(32);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits >> 56) & 255) as f64
    };
    let (x, y) = (x / 3.0, y / 3.0);
    let (s, t) = (x - x.floor(), y - y.floor());
    let line = |y: f64| knot(x.floor(), y) * (1.0 - s) + knot(x.floor() + 1.0, y) * s;
    line(y.floor()) * (1.0 - t) + line(y.floor() + 1.0) * t
}

fn image([width, height]: [u32; 2], place: impl Fn(f64, f64) -> [f64; 2]) -> ColorImage {
    let pixels = (0..width * height).map(|at| {
        let [x, y] = place(f64::from(at % width), f64::from(at / width));
        [texture(x, y) as u8; 3]
    });
    ColorImage::new([width, height], pixels.collect()).expect("as many pixels")
}

fn small_pair() -> [GrayImage; 2] {
    let left = image([128, 128], |x, y| [x, y]);
    let right = image([128, 128], |x, y| [(x + 10.0 - 0.03 * y) / 0.95, y]);
    [left, right].map(|image| GrayImage::of_colors(&image))
}

struct Sweep {
    camera: Camera,
    posed_images: Vec<(ColorImage, DAffine3)>,
}

impl Sweep {
    /// Five cameras in a row before the plane z = 2 + 0.1 x.
    fn new() -> Self {
        let size = [256, 192];
        let (focal, center) = (220.0, DVec2::new(127.5, 95.5));
        let camera = Camera::new(size, DVec2::splat(focal), center, Distortion::None).expect("a pinhole");
        let posed_images = [0.0, -0.2, -0.1, 0.1, 0.2].map(|place: f64| {
            let posed_image = image(size, |u, v| {
                let (x, y) = ((u - center.x) / focal, (v - center.y) / focal);
                let depth = (2.0 + 0.1 * place) / (1.0 - 0.1 * x);
                [(place + x * depth) * 110.0, y * depth * 110.0]
            });
            (posed_image, DAffine3::from_translation(DVec3::new(-place, 0.0, 0.0)))
        });
        Self {
            camera,
            posed_images: posed_images.into(),
        }
    }

    fn views(&self) -> Vec<View<'_>> {
        let posed_images = self.posed_images.iter();
        let views = posed_images.map(|(image, camera_from_world)| View {
            image,
            camera: &self.camera,
            camera_from_world: *camera_from_world,
        });
        views.collect()
    }
}

fn small(criterion: &mut Criterion) {
    let [left, right] = small_pair();
    let range = DisparityRange::new(0, 63).expect("a range");
    let matched = |matching: Matching| {
        let map = matching.disparities(&left, &right, range).expect("a pair");
        map.found_count()
    };
    let mut group = criterion.benchmark_group("stereo/128");
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 2] = [
        ("local", &|| matched(Matching::fast())),
        ("semi-global", &|| matched(Matching::default())),
    ];
    bench_on_threads(&mut group, [1, cores()], &functions);
    by_card(&mut group, [&left, &right], range);
    group.finish();

    let sweep = Sweep::new();
    let views = sweep.views();
    let mut group = criterion.benchmark_group("stereo/sweep");
    group.sample_size(10);
    let depths = || {
        PlaneSweep::between(1.0, 4.0)
            .depths(&views[0], &views[1..])
            .expect("views")
    };
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 1] = [("5 views of 256 × 192", &|| depths().valid_count())];
    bench_on_threads(&mut group, [1, cores()], &functions);
    group.finish();
}

/// The same by the adapter that the program would take.
fn by_card(group: &mut BenchmarkGroup<'_, WallTime>, [left, right]: [&GrayImage; 2], range: DisparityRange) {
    let context = match Context::headless(&ContextOptions::default()) {
        Ok(context) => context,
        Err(error) => {
            println!("no adapter: passed over ({error})");
            return;
        }
    };
    let adapter = context.info.name.clone();
    let card = CardMatcher::new(context);
    for (name, matching) in [("local", Matching::fast()), ("semi-global", Matching::default())] {
        let matched = || {
            let map = card.disparities(&matching, left, right, range).expect("a pair");
            map.found_count()
        };
        group.bench_function(BenchmarkId::new(name, &adapter), |bencher| bencher.iter(matched));
    }
}

fn posed_image(path: &Path) -> Option<GrayImage> {
    let image = image::open(path).ok()?.into_rgb8();
    let size = [image.width(), image.height()];
    let colors = ColorImage::new(size, image.pixels().map(|pixel| pixel.0).collect())?;
    Some(GrayImage::of_colors(&colors))
}

fn aloe(criterion: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(ALOE);
    let images = ["aloeL.jpg", "aloeR.jpg"].map(|name| posed_image(&folder.join(name)));
    let ([Some(left), Some(right)], Ok(truth)) = (images, image::open(folder.join("aloeGT.png"))) else {
        println!("no aloe in {ALOE}: passed over");
        return;
    };
    let default = Matching::default();
    let parabola = Matching {
        between: Between::Parabola,
        ..Matching::default()
    };
    let range = default.range(&left, &right).expect("a range");
    println!("aloe: {range:?} found");
    let matched = |matching: &Matching| matching.disparities(&left, &right, range).expect("a pair");
    let rows = [
        ("default", &default),
        ("parabola", &parabola),
        ("local", &Matching::fast()),
    ];
    for (name, matching) in rows {
        print_errors(name, &matched(matching), truth.to_luma8().as_raw());
    }
    let mut group = criterion.benchmark_group("stereo/aloe");
    group.sample_size(10);
    let functions: [(&str, &(dyn Fn() -> usize + Sync)); 3] = [
        ("semi-global", &|| matched(&default).found_count()),
        ("local", &|| matched(&Matching::fast()).found_count()),
        ("range", &|| {
            default.range(&left, &right).map_or(0, DisparityRange::count)
        }),
    ];
    bench_on_threads(&mut group, [1, cores()], &functions);
    group.finish();
}

/// Disparities of OpenCV, below 0 where it has none.
fn answers_of_opencv(count: usize) -> Option<Vec<f32>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/opencv_sgbm.f32");
    let bytes = std::fs::read(path).ok()?;
    let numbers = bytes
        .chunks_exact(4)
        .map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    Some(numbers.collect()).filter(|answers: &Vec<f32>| answers.len() == count)
}

fn print_errors(name: &str, map: &DisparityMap, truth: &[u8]) {
    print_errors_over(name, "all pixels", map, truth, |_| true);
    if let Some(answers) = answers_of_opencv(truth.len()) {
        print_errors_over(name, "OpenCV's pixels", map, truth, |at| answers[at] >= 0.0);
    }
}

fn print_errors_over(name: &str, pixels: &str, map: &DisparityMap, truth: &[u8], is_asked: impl Fn(usize) -> bool) {
    let asked: Vec<usize> = (0..truth.len()).filter(|&at| truth[at] > 0 && is_asked(at)).collect();
    let found = asked.iter().filter(|&&at| !map.pixels()[at].is_nan());
    let errors: Vec<f32> = found.map(|&at| map.pixels()[at] - f32::from(truth[at])).collect();
    let median = |error: &dyn Fn(f32) -> f32| {
        let mut errors: Vec<f32> = errors.iter().map(|&signed| error(signed)).collect();
        errors.sort_by(f32::total_cmp);
        errors.get(errors.len() / 2).copied().unwrap_or(f32::NAN)
    };
    let signed = median(&|error| error);
    let beyond = errors.iter().filter(|error| error.abs() > 2.0).count();
    let percent = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
    println!(
        "aloe, {name}, {pixels}: {:.1} % answered, {:.2} % of them beyond 2 px; median error {:.3} px, in steps of \
         1/16 {:.3}, less the signed median ({signed:.3}) {:.3}",
        percent(errors.len(), asked.len()),
        percent(beyond, errors.len()),
        median(&f32::abs),
        median(&|error| (error * 16.0).round().abs() / 16.0),
        median(&|error| (error - signed).abs()),
    );
}

criterion_group!(benches, small, aloe);
criterion_main!(benches);
