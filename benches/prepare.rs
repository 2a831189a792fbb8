//! Time until a sequence is ready to be drawn: files → decoded → completed → records, through the real [`Loader`]
//! with one worker a core.
//!
//! Measured: the wall time from opening to the last (or first) frame with points and shapes; files are in the system's
//! cache, as when a sequence loops. *opened and read once* fills an empty cache, whose memory is fresh; *played on*
//! goes five times through the sequence with a cache that holds a fifth of it, so every frame is prepared again, in the
//! memory of a dropped one. Not measured: a cold disk, octrees, uploads, drawing.
//!
//! Targets on two cores: 100,000 points with normals in the file at 60 fps, without at 15; the first image of 100
//! frames within 0.5 s of opening. Criterion's `thrpt` is frames per second.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pointreel::analysis::{SurfaceOptions, fake_color};
use pointreel::cloud::{Frame, PointRecord, Positions, RawCloud, ScalarField};
use pointreel::memory::Allocator;
use pointreel::sequence::{
    ColorHints, ColorSource, Coloring, HeightAxis, Loader, LoaderOptions, Needs, PrepareCounters, PreparedFrame,
    Sequence, complete, prepare,
};
use pointreel::timeline::Direction;
use std::f32::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

// As in the program.
#[global_allocator]
static ALLOCATOR: Allocator = Allocator::new();

const POINTS: usize = 100_000;
const ROUNDS: usize = 5;
/// Size of a prepared frame: position, index, normal and colour, a point and a shape.
const FRAME_BYTES: usize = POINTS * (32 + 16 + 16);
const SURFELS: Needs = Needs {
    shapes: true,
    ellipses: false,
    mesh: false,
    levels: None,
    colors: Coloring::of(ColorSource::Auto),
    surface: SurfaceOptions::AUTO,
    smoothing: 0.0,
    hints: ColorHints::NONE,
};

/// Attributes of a scanner's file in addition to positions and colours.
#[derive(Clone, Copy)]
enum Attributes {
    None,
    Normals,
    NormalsAndRadii,
}

/// Writes a breathing, dented sphere: binary little-endian PLY, points on a spiral.
fn write_frame(path: &Path, time: f32, attributes: Attributes) {
    let mut header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {POINTS}\n\
         property float x\nproperty float y\nproperty float z\n"
    );
    let (with_normals, with_radii) = match attributes {
        Attributes::None => (false, false),
        Attributes::Normals => (true, false),
        Attributes::NormalsAndRadii => (true, true),
    };
    if with_normals {
        header += "property float nx\nproperty float ny\nproperty float nz\n";
    }
    if with_radii {
        header += "property float radius\n";
    }
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    let mut bytes = header.into_bytes();
    for i in 0..POINTS {
        let z = 1.0 - 2.0 * (i as f32 + 0.5) / POINTS as f32;
        // The golden angle spreads points evenly over a sphere.
        let angle = (i as f64 * 0.618_033_988_749_895).fract() as f32 * TAU;
        let ring = (1.0 - z * z).sqrt();
        let normal = [ring * angle.cos(), ring * angle.sin(), z];
        let distance = 1.0 + 0.05 * (6.0 * angle + time).sin() * ring;
        for component in normal {
            bytes.extend((component * distance).to_le_bytes());
        }
        if with_normals {
            for component in normal {
                bytes.extend(component.to_le_bytes());
            }
        }
        if with_radii {
            bytes.extend(0.006f32.to_le_bytes());
        }
        bytes.extend(normal.map(|component| (127.0 * (component + 1.0)) as u8));
    }
    std::fs::write(path, bytes).expect("the temporary folder takes files");
}

fn write_sequence(frames: usize, attributes: Attributes) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for index in 0..frames {
        let path = folder.path().join(format!("frame_{index}.ply"));
        write_frame(&path, index as f32 * 0.1, attributes);
    }
    folder
}

fn open(folder: &Path, options: LoaderOptions) -> Loader {
    let inputs: [PathBuf; 1] = [folder.to_path_buf()];
    let sequence = Sequence::discover(&inputs).expect("frames were written");
    Loader::new(Arc::new(sequence), options).expect("threads start")
}

/// Opens the sequence and takes every frame in order, some times over.
fn play(folder: &Path, options: LoaderOptions, rounds: usize) -> usize {
    let loader = open(folder, options);
    let mut points = 0;
    for index in (0..rounds).flat_map(|_| 0..loader.sequence().len()) {
        loader.request(index, Direction::Forward, &SURFELS);
        points += loader.wait(index, &SURFELS).expect("a good frame").points.len();
    }
    points
}

fn first_frame(folder: &Path) -> (Loader, Arc<PreparedFrame>) {
    let loader = open(folder, LoaderOptions::default());
    loader.request(0, Direction::Forward, &SURFELS);
    let frame = loader.wait(0, &SURFELS).expect("a good frame");
    (loader, frame)
}

fn bench(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let mut group = criterion.benchmark_group("prepare 100k");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(5));
    let cases = [
        ("normals and radii in the file", 40, Attributes::NormalsAndRadii),
        ("normals in the file", 40, Attributes::Normals),
        ("no normals", 16, Attributes::None),
    ];
    for (name, frames, attributes) in cases {
        let folder = write_sequence(frames, attributes);
        group.throughput(Throughput::Elements(frames as u64));
        group.bench_function(BenchmarkId::new(name, "opened and read once"), |bencher| {
            bencher.iter(|| play(folder.path(), LoaderOptions::default(), 1));
        });
        group.throughput(Throughput::Elements((ROUNDS * frames) as u64));
        group.bench_function(BenchmarkId::new(name, "played on"), |bencher| {
            bencher.iter(|| {
                let options = LoaderOptions {
                    budget_bytes: frames / ROUNDS * FRAME_BYTES,
                    ..LoaderOptions::default()
                };
                play(folder.path(), options, ROUNDS)
            });
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("first of 100 frames");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(5));
    for (name, attributes) in [
        ("normals in the file", Attributes::Normals),
        ("no normals", Attributes::None),
    ] {
        let folder = write_sequence(100, attributes);
        group.bench_function(name, |bencher| {
            // Dropping the loader waits for its workers and is not part of the measured time.
            bencher.iter_batched(|| (), |()| first_frame(folder.path()), BatchSize::PerIteration);
        });
    }
    group.finish();
}

/// A million points on a spiral, whose height is also a scalar field.
fn spiral() -> Frame {
    const COUNT: usize = 1_000_000;
    let height = |index: usize| index as f32 / COUNT as f32;
    let position = |index: usize| {
        let angle = height(index) * 400.0 * TAU;
        [angle.cos(), angle.sin(), height(index)]
    };
    let mut raw = RawCloud::from_positions(Positions::F32((0..COUNT).map(position).collect()));
    raw.attributes.normals = Some((0..COUNT).map(|index| position(index).map(|x| -x)).collect());
    let field =
        |name, value: fn(f32) -> f32| ScalarField::new(name, (0..COUNT).map(|index| value(height(index))).collect());
    raw.attributes.scalars = vec![
        field("intensity", |height| 300.0 * height),
        field("classification", |height| (20.0 * height).floor()),
    ];
    Frame::from_raw(raw, glam::DVec3::ZERO).expect("a good cloud")
}

/// The cost of another colouring, compared with a pass over the same points that writes records of one colour.
fn recolor(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let frame = Arc::new(spiral());
    let counters = PrepareCounters::default();
    let needs = |colors: Coloring| Needs {
        colors,
        ..Needs::default()
    };
    let before = needs(Coloring::of(ColorSource::Uniform));
    let before = prepare(0, Arc::clone(&frame), 0.0, &before, &counters);
    let mut group = criterion.benchmark_group("recolour 1M");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(4))
        .throughput(Throughput::Elements(frame.len() as u64));
    group.bench_function("plain pass", |bencher| {
        let color = fake_color(glam::Vec3::X);
        bencher.iter(|| {
            let positions = frame.positions().iter();
            let record = |position: &glam::Vec3| PointRecord {
                position: position.to_array(),
                color,
            };
            positions.map(record).collect::<Vec<_>>()
        });
    });
    let intensity = Coloring::of(ColorSource::Scalar(None));
    let logarithmic = Coloring {
        is_logarithmic: true,
        ..intensity
    };
    for (name, colors) in [
        ("scalar", intensity),
        ("scalar by logarithms", logarithmic),
        ("height", Coloring::of(ColorSource::Height(HeightAxis::Auto))),
        ("class", Coloring::of(ColorSource::Class)),
        ("normal", Coloring::of(ColorSource::Normal)),
    ] {
        let needs = needs(colors);
        group.bench_function(name, |bencher| {
            bencher.iter(|| complete(&before, &needs, &counters));
        });
    }
    group.finish();
}

criterion_group!(benches, bench, recolor);
criterion_main!(benches);
