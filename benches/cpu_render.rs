//! Images by the CPU renderer compared with those by the graphics library: `cargo bench --bench cpu_render`.
//!
//! Measured, at 1920×1080 of a bumpy torus in Morton order that fills the image: 1,000,000 points (one pixel each),
//! 100,000 surfels (two-pass-enlarged, 2×) and voxels (τ 1 px), and a plain torus of 100,000 vertices and twice as many
//! triangles, from the packet until the image is finished in memory, by the CPU renderer on one and on two
//! threads, and by the adapter that the program would take (no read back), whose name is printed first. Also from ten
//! times as far, where the image costs less, and from within, where most is culled.
//!
//! Eye-dome lighting and the grid at 1280×720, two threads: the time of the passes over the whole image, as the
//! renderer states it, of points that fill the image, next to one read of the same number of depths; and whole images
//! with and without it, since tiles have to keep their depths as well.
//!
//! Light at 1280×720 with eye-dome lighting, two threads: whole images of the same surfels in each lighting mode; the
//! cost of deferred shading is their difference to `none`. Then, of Lambert's light of three lamps, each further pass
//! compared with the image without one. A shadow map is drawn once: the light stays.
//!
//! `plain fill` is the time to write the memory of the image.
//!
//! Not measured: decoding, normals, octrees, boxes around blocks of records (once a frame: `prepare`), showing.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use pointreel::analysis::splat_ellipses;
use pointreel::cloud::{
    Mesh, MeshRecords, PointRecord, Positions, RawCloud, ShapeRecord, VertexRecord, encode_ellipse, oct_encode,
};
use pointreel::levels::octree::{Octree, StopCriterion};
use pointreel::math::{Aabb, Cube, order_of_codes};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::scene::{
    Antialiasing, Camera, Content, EyeDome, GroundPlane, LightRig, Lighting, OnOff, PacketParams, Primitive,
    ScenePacket, SplatFilter, Style, Surfels, UpAxis, Voxels,
};
use rayon::prelude::*;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

#[path = "shapes/gpu.rs"]
mod gpu;
mod shapes;

use shapes::threads;

const SIZE_PX: [u32; 2] = [1920, 1080];

/// The torus as seen from a distance of this many units from its centre.
fn packet(count: usize, primitive: Primitive, distance: f64) -> ScenePacket {
    let (positions, colors) = shapes::bumpy_torus(count);
    let normals = shapes::bumpy_torus_normals(count);
    let cube = Cube::around(&positions).expect("there are points");
    let order = order_of_codes(&cube.codes(&positions));
    let order = order.iter().map(|&index| index as usize);
    let points: Vec<PointRecord> = order
        .clone()
        .map(|index| PointRecord {
            position: positions[index].to_array(),
            color: colors[index],
        })
        .collect();
    // The torus has an area of about 16.
    let spacing = (16.0 / count as f32).sqrt();
    let ellipses = match primitive {
        Primitive::Ellipse => splat_ellipses(&positions, &normals),
        _ => vec![None; count],
    };
    let shapes = order.map(|index| {
        let normal = oct_encode(normals[index]);
        ShapeRecord {
            normal,
            radius: spacing,
            ellipse: ellipses[index].map_or(0, |ellipse| encode_ellipse(normal, ellipse)),
            scalar: 0.0,
        }
    });
    let bounds = Aabb::from_points(&positions);
    let mut camera = Camera::framing(&bounds, DVec3::ZERO, UpAxis::Z);
    camera.elevation_deg = 40.0;
    camera.distance = distance;
    let view = camera.transform(DVec3::ZERO, SIZE_PX);
    let voxels = || {
        let sorted: Vec<Vec3> = points.iter().map(|point| point.position.into()).collect();
        let colors: Vec<[u8; 4]> = points.iter().map(|point| point.color).collect();
        let octree = Octree::build(&sorted, &colors, StopCriterion::PAPER);
        let mut records = Vec::new();
        octree.select(&view.select_view(1.0), &mut records);
        Voxels {
            records: Arc::new(records),
            normals: None,
            cube_edge: octree.cube().edge,
        }
    };
    let content = match primitive {
        Primitive::Voxel => Content::Voxels(voxels()),
        Primitive::Surfel | Primitive::Sprite | Primitive::Ellipse => Content::Surfels(Surfels {
            points: Arc::new(points),
            shapes: Arc::new(shapes.collect()),
        }),
        Primitive::Point => Content::Points(Arc::new(points)),
        Primitive::Mesh => Content::Mesh(Arc::new(torus_mesh(count))),
    };
    ScenePacket {
        viewport_px: SIZE_PX,
        view,
        style: Style {
            primitive,
            ..Style::default()
        }
        .painted(),
        content,
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds,
    }
}

/// A torus of the same surface area with `count` vertices, and twice as many triangles, in the order of frames.
fn torus_mesh(count: usize) -> MeshRecords {
    let columns = ((count as f64 * 2.5).sqrt()) as u32;
    let rows = count as u32 / columns;
    let turn = |index: u32, of: u32| (std::f32::consts::TAU * index as f32 / of as f32).sin_cos();
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (turn(row, rows), turn(column, columns))));
    let normals = places.clone().map(|((up, out), (y, x))| [out * x, out * y, up]);
    let positions = places.map(|((up, out), (y, x))| [(1.0 + 0.4 * out) * x, (1.0 + 0.4 * out) * y, 0.4 * up]);
    let mut raw = RawCloud::from_positions(Positions::F32(positions.collect()));
    raw.attributes.normals = Some(normals.collect());
    for row in 0..rows {
        for column in 0..columns {
            let at = |row: u32, column: u32| row % rows * columns + column % columns;
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            raw.faces.extend([[a, b, c], [c, b, d]]);
        }
    }
    let mesh = Mesh::from_raw(raw, DVec3::ZERO).expect("there are few vertices");
    let normals = mesh.vertices().normals().expect("it has normals");
    let vertex = |(position, normal): (&Vec3, &Vec3)| VertexRecord {
        position: position.to_array(),
        color: [190, 180, 160, 255],
        texture_place: [0.0; 2],
        normal: oct_encode(*normal),
        texture: VertexRecord::NO_TEXTURE,
    };
    let vertices = mesh.vertices().positions().iter().zip(normals).map(vertex);
    MeshRecords::new(Arc::new(vertices.collect()), Arc::new(mesh.records()))
}

fn draw_on_cpu(renderer: &mut CpuRenderer, packet: &ScenePacket) {
    renderer.invalidate();
    renderer.prepare(packet).expect("the packet can be drawn");
    renderer.render().expect("the packet can be drawn");
}

#[expect(clippy::print_stdout, reason = "a time means nothing without its adapter")]
fn pictures(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let context = Context::headless(&ContextOptions::default()).expect("an adapter");
    println!("adapter: {}", context.adapter_summary());
    for (primitive, count) in [
        (Primitive::Point, 1_000_000),
        (Primitive::Surfel, 100_000),
        (Primitive::Ellipse, 100_000),
        (Primitive::Voxel, 100_000),
        (Primitive::Mesh, 100_000),
    ] {
        for (place, distance) in [("whole", 3.4), ("far", 34.0), ("within", 1.0)] {
            let packet = packet(count, primitive, distance);
            let mut group = criterion.benchmark_group(format!("{primitive}/{count}/{place}"));
            group
                .throughput(Throughput::Elements(count as u64))
                .sample_size(20)
                .warm_up_time(Duration::from_millis(500))
                .measurement_time(Duration::from_secs(2));
            let mut renderer = GpuRenderer::new(Arc::clone(&context)).expect("a renderer");
            group.bench_function("adapter", |bencher| {
                bencher.iter(|| gpu::draw(&mut renderer, &packet));
            });
            for (threads, pool) in threads::pools([1, 2]) {
                let mut renderer = CpuRenderer::new();
                group.bench_function(format!("software, {threads} threads"), |bencher| {
                    bencher.iter(|| pool.install(|| draw_on_cpu(&mut renderer, &packet)));
                });
            }
            group.finish();
        }
    }
    let mut picture = vec![0u8; (4 * SIZE_PX[0] * SIZE_PX[1]) as usize];
    criterion.bench_function("plain fill", |bencher| {
        bencher.iter(|| black_box(&mut picture).fill(black_box(7)));
    });
}

/// Disks compared with ellipses and with both filtered to the pixels: the same cloud, by turns.
fn splats(criterion: &mut Criterion) {
    let (_, pool) = threads::pools([1, 2]).last().expect("two pools");
    for count in [100_000, 1_000_000] {
        for (place, distance) in [("whole", 3.4), ("far", 34.0), ("within", 1.0)] {
            let mut group = criterion.benchmark_group(format!("splats/{count}/{place}/2 threads"));
            group
                .sample_size(20)
                .warm_up_time(Duration::from_millis(500))
                .measurement_time(Duration::from_secs(2));
            for primitive in [Primitive::Surfel, Primitive::Ellipse] {
                let mut packet = packet(count, primitive, distance);
                for &filter in SplatFilter::ALL {
                    packet.style.surfels.filter = filter;
                    let mut renderer = CpuRenderer::new();
                    group.bench_function(format!("{primitive}, filter {filter}"), |bencher| {
                        bencher.iter(|| pool.install(|| draw_on_cpu(&mut renderer, &packet)));
                    });
                }
            }
            group.finish();
        }
    }
}

/// Surfels that fill the image, in each lighting mode.
fn light(criterion: &mut Criterion) {
    let mut packet = packet(100_000, Primitive::Surfel, 1.9);
    packet.style.light.eye_dome = EyeDome::On;
    seen_at_720p(&mut packet);
    let (_, pool) = threads::pools([1, 2]).last().expect("two pools");
    let mut group = criterion.benchmark_group("light/1280x720/2 threads");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    for &lighting in Lighting::ALL {
        let rigs: &[LightRig] = if lighting.is_deferred() {
            LightRig::ALL
        } else {
            &[LightRig::Head]
        };
        for &rig in rigs {
            packet.style.light.lighting = lighting;
            packet.style.light.rig = rig;
            let mut renderer = CpuRenderer::new();
            group.bench_function(format!("{lighting}, {rig}"), |bencher| {
                bencher.iter(|| pool.install(|| draw_on_cpu(&mut renderer, &packet)));
            });
        }
    }
    packet.style.light.lighting = Lighting::Lambert;
    packet.style.light.rig = LightRig::ThreePoint;
    let style = packet.style;
    let passes = [
        ("no further pass", style),
        ("ambient occlusion", style.with(|style| style.light.ao = OnOff::On)),
        ("shadows", style.with(|style| style.light.shadows = OnOff::On)),
        (
            "fxaa",
            style.with(|style| style.drawing.antialiasing = Antialiasing::Fxaa),
        ),
        (
            "supersample",
            style.with(|style| style.drawing.antialiasing = Antialiasing::Supersample),
        ),
    ];
    for (name, style) in passes {
        packet.style = style;
        let mut renderer = CpuRenderer::new();
        group.bench_function(name, |bencher| {
            bencher.iter(|| pool.install(|| draw_on_cpu(&mut renderer, &packet)));
        });
    }
    group.finish();
}

/// From near enough that the object fills an image of 1280×720.
fn seen_at_720p(packet: &mut ScenePacket) {
    packet.viewport_px = [1280, 720];
    let mut camera = Camera::framing(&packet.bounds, DVec3::ZERO, UpAxis::Z);
    (camera.elevation_deg, camera.distance) = (40.0, 1.9);
    packet.view = camera.transform(DVec3::ZERO, packet.viewport_px);
}

/// Passes over the whole image.
fn screen(criterion: &mut Criterion) {
    let mut packet = packet(1_000_000, Primitive::Point, 1.9);
    seen_at_720p(&mut packet);
    packet.style.points.size_px = 3.0;
    let (_, pool) = threads::pools([1, 2]).last().expect("two pools");
    let mut group = criterion.benchmark_group("screen/1280x720/2 threads");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    let background = packet.style.backdrop.background;
    let ground = GroundPlane::under(&packet.bounds, DVec3::ZERO, UpAxis::Z, background);
    for (name, eye_dome, ground) in [
        ("neither", EyeDome::Off, None),
        ("eye-dome lighting", EyeDome::On, None),
        ("grid", EyeDome::Off, Some(ground)),
    ] {
        packet.style.light.eye_dome = eye_dome;
        packet.ground = ground;
        let mut renderer = CpuRenderer::new();
        group.bench_function(format!("{name}, picture"), |bencher| {
            bencher.iter(|| pool.install(|| draw_on_cpu(&mut renderer, &packet)));
        });
        if name == "neither" {
            continue;
        }
        group.bench_function(format!("{name}, alone"), |bencher| {
            bencher.iter_custom(|count| {
                let once = |_| {
                    pool.install(|| draw_on_cpu(&mut renderer, &packet));
                    renderer.stats().screen_ms / 1e3
                };
                Duration::from_secs_f64((0..count).map(once).sum())
            });
        });
    }
    let depths = vec![0.5f32; packet.viewport_px.iter().product::<u32>() as usize];
    group.bench_function("a read of the depths", |bencher| {
        let sum = |row: &[f32]| row.iter().map(|depth| depth.to_bits()).fold(0, u32::max);
        bencher.iter(|| pool.install(|| black_box(&depths).par_chunks(32 * 1280).map(sum).max()));
    });
    group.finish();
}

criterion_group!(benches, splats, light, screen, pictures);
criterion_main!(benches);
