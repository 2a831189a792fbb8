//! Surfels from the byte code of an octree against exact disks and points:
//! `cargo bench --bench coded_render`.
//!
//! Measured, at 1920×1080 of a bumpy torus on one thread, from the packet until the image is finished in memory:
//! 100,000 surfels as exact disks; their byte code as masks with normals of 13 and 17 bits, with light per normal and
//! per splat; as one pixel per cell; and the same records as plain points of a pixel. From ten times as far, where
//! cells below a pixel are not divided; as large as the image; and from within, where most is culled.
//!
//! First a table of medians of rounds in which all take turns, so that other load on the machine affects all alike:
//! milliseconds, millions of points drawn per second, and decibels compared with the exact disks. Above it, the bits of
//! code per leaf: of a tree with δ = 5 %, and of one whose cells are as large as the spacing of the points, for which
//! the paper's bound of 2.67 bits holds. Criterion then measures the same by itself.
//!
//! Not measured: making the code (once a frame: printed as well), showing.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::levels::octree::{CodedCloud, Octree, StopCriterion};
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{
    Camera, Footprint, Lighting, NormalBits, Primitive, RendererChoice, Scene, ScenePacket, Style, UpAxis,
};
use pointreel::sequence::{PrepareCounters, PreparedFrame, prepare};
use std::sync::Arc;
use std::time::{Duration, Instant};

mod shapes;

use shapes::threads;

const SIZE_PX: [u32; 2] = [1920, 1080];
const COUNT: usize = 100_000;
const ROUNDS: usize = 15;

/// The torus, prepared for all settings that are measured.
fn frame() -> PreparedFrame {
    let (positions, colors) = shapes::bumpy_torus(COUNT);
    let mut raw = RawCloud::from_positions(Positions::F32(positions.iter().map(Vec3::to_array).collect()));
    raw.attributes.colors = Some(colors);
    let normals = shapes::bumpy_torus_normals(COUNT);
    raw.attributes.normals = Some(normals.iter().map(Vec3::to_array).collect());
    // The torus has an area of about 16; disks whose radius is the spacing cover it except for a few holes between
    // random points.
    raw.attributes.radii = Some(vec![(16.0 / COUNT as f32).sqrt(); COUNT]);
    let frame = Frame::from_raw(raw, DVec3::ZERO).expect("finite numbers");
    let needs = Scene::needs(&style(Footprint::Masks, NormalBits::Thirteen));
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

fn style(footprint: Footprint, normal_bits: NormalBits) -> Style {
    Style::default().with(|style| {
        style.codes.footprint = footprint;
        style.codes.normal_bits = normal_bits;
        style.drawing.renderer = RendererChoice::Cpu;
    })
}

fn contenders() -> [(&'static str, Style); 6] {
    let masks = style(Footprint::Masks, NormalBits::Thirteen);
    [
        ("exact disks", style(Footprint::Disks, NormalBits::Thirteen)),
        ("masks", masks),
        (
            "masks, light once a normal",
            masks.with(|style| style.light.lighting = Lighting::PerSurfel),
        ),
        ("masks, 17 bits", style(Footprint::Masks, NormalBits::Seventeen)),
        ("coded pixels", style(Footprint::Pixels, NormalBits::Thirteen)),
        (
            "plain points",
            Style {
                primitive: Primitive::Point,
                ..masks
            },
        ),
    ]
}

fn packet(frame: &PreparedFrame, distance: f64, style: &Style) -> ScenePacket {
    let mut camera = Camera::framing(&frame.frame.bounds(), DVec3::ZERO, UpAxis::Z);
    camera.elevation_deg = 40.0;
    camera.distance = distance;
    Scene::default().packet(frame, DVec3::ZERO, &camera, style, SIZE_PX)
}

fn draw(renderer: &mut CpuRenderer, packet: &ScenePacket) -> Duration {
    renderer.invalidate();
    let start = Instant::now();
    renderer.prepare(packet).expect("the packet can be drawn");
    renderer.render().expect("the packet can be drawn");
    start.elapsed()
}

#[expect(clippy::print_stdout, reason = "what is measured beside times")]
fn print_bits(frame: &PreparedFrame) {
    let (Some(octree), Some(shapes)) = (frame.levels.octree(), &frame.shapes) else {
        return;
    };
    for (what, stop) in [
        ("loss 5 %", StopCriterion::PAPER),
        ("cells as large as samples are far apart", StopCriterion::Depth(7)),
    ] {
        let tree: Arc<Octree> = Arc::new(octree.with_stop(stop));
        let start = Instant::now();
        let coded = CodedCloud::new(&tree, &frame.points, shapes);
        let made_ms = start.elapsed().as_secs_f64() * 1e3;
        let (depth, leaves) = (coded.depth(), coded.level(coded.depth()).len());
        println!("{what}: depth {depth}, {leaves} leaves of {COUNT} points, made in {made_ms:.1} ms");
        println!("  bits a leaf: {:.2?}", coded.bits_per_leaf());
    }
}

#[expect(clippy::print_stdout, reason = "what is measured beside times")]
fn print_table(frame: &PreparedFrame, place: &str, distance: f64) {
    let mut entries: Vec<_> = contenders()
        .into_iter()
        .map(|(name, style)| {
            let packet = packet(frame, distance, &style);
            (name, packet, CpuRenderer::new(), Vec::new())
        })
        .collect();
    for _ in 0..=ROUNDS {
        for (_, packet, renderer, times) in &mut entries {
            times.push(draw(renderer, packet).as_secs_f64() * 1e3);
        }
    }
    let truth = entries[0].2.image().clone();
    println!("{place}: ms, millions a second, dB beside exact disks");
    for (name, _, renderer, times) in &mut entries {
        // The first frame creates boxes and tables.
        times.remove(0);
        times.sort_by(f64::total_cmp);
        let median_ms = times[times.len() / 2];
        let drawn = renderer.stats().drawn_instances;
        let per_second = drawn as f64 / median_ms / 1e3;
        let error = mean_squared_error(&truth, renderer.image()).map_or(f64::NAN, psnr_db);
        println!("  {name:28} {median_ms:8.2} {per_second:8.2} {error:6.1}   ({drawn} records or nodes)");
    }
}

fn pictures(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let frame = frame();
    let (_, pool) = threads::pools([1, 1]).next().expect("a pool");
    pool.install(|| print_bits(&frame));
    let places = [("far", 34.0), ("full", 3.4), ("near", 1.0)];
    for (place, distance) in places {
        pool.install(|| print_table(&frame, place, distance));
    }
    for (place, distance) in places {
        let mut group = criterion.benchmark_group(format!("coded/{COUNT}/{place}"));
        group
            .throughput(Throughput::Elements(COUNT as u64))
            .sample_size(10)
            .warm_up_time(Duration::from_millis(200))
            .measurement_time(Duration::from_secs(1));
        for (name, style) in contenders() {
            let packet = packet(&frame, distance, &style);
            let mut renderer = CpuRenderer::new();
            group.bench_function(name, |bencher| {
                bencher.iter(|| pool.install(|| draw(&mut renderer, &packet)));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, pictures);
criterion_main!(benches);
