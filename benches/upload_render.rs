//! Upload and drawing of 100,000 points by each instancing strategy: `cargo bench --bench upload_render`.
//!
//! Measured: `upload` is making the records resident (allocation, one copy per chunk, and the wait until it has
//! arrived); `draw` is an image of resident records from the packet until the GPU has finished, for points (one pixel)
//! and for surfels (two-pass-enlarged, 2x), 640×480, a sphere that covers about half of it. All by the CPU's clock, on
//! the adapter that the program would take, which is printed first; `WGPU_BACKEND` and `VK_DRIVER_FILES` choose
//! another.
//!
//! `draw in order` is an image of 1,000,000 points, and of 100,000 surfels, in Morton order, in which frames keep
//! them, and in random order.
//!
//! Not measured: decoding, normals, compiling pipelines, reading back, showing. GPU time, voxels, real scans and the
//! image size of the paper are left to `pointreel bench`.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use pointreel::cloud::{PointRecord, ShapeRecord, oct_encode};
use pointreel::math::{Aabb, Cube, order_of_codes};
use pointreel::render::Renderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::scene::{Camera, Content, PacketParams, Primitive, ScenePacket, Strategy, Style, Surfels, UpAxis};
use std::sync::Arc;
use std::time::Duration;

#[path = "shapes/gpu.rs"]
mod gpu;

use gpu::draw;

const POINTS: usize = 100_000;
/// For the order of points: more than caches hold.
const MANY_POINTS: usize = 1_000_000;
const SIZE_PX: [u32; 2] = [640, 480];

/// A sphere of radius 1 with this many evenly spread surfels that close its surface.
fn sphere(count: usize, primitive: Primitive, strategy: Strategy) -> ScenePacket {
    let golden_angle = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let directions = (0..count).map(move |index| {
        let y = 1.0 - 2.0 * (index as f32 + 0.5) / count as f32;
        let (sin, cos) = (golden_angle * index as f32).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        Vec3::new(cos * radius, y, sin * radius)
    });
    let points = directions.clone().map(|direction| PointRecord {
        position: direction.to_array(),
        color: ((direction + 1.0) * 127.5)
            .extend(255.0)
            .to_array()
            .map(|channel| channel as u8),
    });
    let spacing = (4.0 * std::f32::consts::PI / count as f32).sqrt();
    let shapes = directions.map(|direction| ShapeRecord {
        normal: oct_encode(direction),
        radius: spacing,
        ellipse: 0,
        scalar: 0.0,
    });
    let bounds = Aabb {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };
    let mut camera = Camera::framing(&bounds, DVec3::ZERO, UpAxis::Y);
    camera.distance = 2.7;
    ScenePacket {
        viewport_px: SIZE_PX,
        view: camera.transform(DVec3::ZERO, SIZE_PX),
        style: Style::default()
            .with(|style| {
                style.primitive = primitive;
                style.drawing.strategy = strategy;
            })
            .painted(),
        content: {
            let points = Arc::new(points.collect());
            if primitive == Primitive::Surfel {
                let shapes = Arc::new(shapes.collect());
                Content::Surfels(Surfels { points, shapes })
            } else {
                Content::Points(points)
            }
        },
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds,
    }
}

/// The same cloud in other memory: a renderer has to upload it again.
fn copy(packet: &ScenePacket) -> ScenePacket {
    let order: Vec<u32> = (0..packet.content.record_count() as u32).collect();
    reordered(packet, &order)
}

/// The same cloud in the order of these indices.
fn reordered(packet: &ScenePacket, order: &[u32]) -> ScenePacket {
    let order = order.iter().map(|&index| index as usize);
    let points = packet.content.points().expect("points or surfels");
    let points = Arc::new(order.clone().map(|index| points[index]).collect());
    ScenePacket {
        content: match packet.content.shapes() {
            Some(shapes) => Content::Surfels(Surfels {
                points,
                shapes: Arc::new(order.map(|index| shapes[index]).collect()),
            }),
            None => Content::Points(points),
        },
        ..packet.clone()
    }
}

fn upload(renderer: &mut GpuRenderer, packet: &ScenePacket) {
    renderer.prepare(packet).expect("the packet can be uploaded");
    // Copies from mapped memory are executed with the next submission.
    renderer.context().queue.submit([]);
    renderer.context().wait().expect("the adapter answers");
}

#[expect(clippy::print_stdout, reason = "a time means nothing without its adapter")]
fn strategies(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let context = Context::headless(&ContextOptions::default()).expect("an adapter");
    println!("adapter: {}", context.adapter_summary());
    for primitive in [Primitive::Point, Primitive::Surfel] {
        for what in ["upload", "draw"] {
            let mut group = criterion.benchmark_group(format!("{what}/{primitive}"));
            group.throughput(Throughput::Elements(POINTS as u64));
            group
                .sample_size(20)
                .warm_up_time(Duration::from_secs(1))
                .measurement_time(Duration::from_secs(3));
            for &strategy in Strategy::ALL {
                let packet = sphere(POINTS, primitive, strategy);
                let mut renderer = GpuRenderer::new(Arc::clone(&context)).expect("a renderer");
                draw(&mut renderer, &packet);
                group.bench_function(BenchmarkId::from_parameter(strategy), |bencher| match what {
                    "upload" => bencher.iter_batched_ref(
                        || copy(&packet),
                        |fresh| upload(&mut renderer, fresh),
                        BatchSize::PerIteration,
                    ),
                    _ => bencher.iter(|| draw(&mut renderer, &packet)),
                });
            }
            group.finish();
        }
    }
}

/// The effect of the order of points on drawing: the order of frames, and a random one.
fn order(criterion: &mut Criterion) {
    let context = Context::headless(&ContextOptions::default()).expect("an adapter");
    for (primitive, count) in [(Primitive::Point, MANY_POINTS), (Primitive::Surfel, POINTS)] {
        let in_rows = sphere(count, primitive, Strategy::Storage);
        let points = in_rows.content.points().expect("points or surfels");
        let positions: Vec<Vec3> = points.iter().map(|point| point.position.into()).collect();
        let cube = Cube::around(&positions).expect("there are points");
        let morton = order_of_codes(&cube.codes(&positions));
        let mut random: Vec<u32> = (0..count as u32).collect();
        random.sort_unstable_by_key(|&index| index.wrapping_mul(0x9e37_79b9).rotate_left(16));
        let mut group = criterion.benchmark_group(format!("draw in order/{primitive}/{count}"));
        group
            .throughput(Throughput::Elements(count as u64))
            .sample_size(20)
            .warm_up_time(Duration::from_secs(1))
            .measurement_time(Duration::from_secs(3));
        for (name, order) in [("Morton", &morton), ("random", &random)] {
            let packet = reordered(&in_rows, order);
            let mut renderer = GpuRenderer::new(Arc::clone(&context)).expect("a renderer");
            group.bench_function(name, |bencher| {
                bencher.iter(|| draw(&mut renderer, &packet));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, strategies, order);
criterion_main!(benches);
