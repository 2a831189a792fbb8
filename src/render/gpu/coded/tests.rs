//! Nodes that the passes find, and their records, compared with the CPU's.

use super::passes::FOUND;
use super::*;
use crate::analysis::test_shapes::Random;
use crate::cloud::{Frame, PointRecord, Positions, RawCloud, ShapeRecord};
use crate::levels::Lod;
use crate::render::Renderer;
use crate::render::gpu::GpuRenderer;
use crate::render::gpu::context::ContextOptions;
use crate::render::gpu::readback::map_and_read;
use crate::scene::{
    BackFaces, Camera, Content, Footprint, NormalBits, RendererChoice, Scene, ScenePacket, Style, UpAxis,
};
use crate::sequence::{PrepareCounters, PreparedFrame, prepare};
use glam::{DVec3, Vec3};
use wgpu::BufferUsages as Usages;

/// Records of a chunk: fewer than there are nodes.
const MAX: usize = 10_000;

fn style() -> Style {
    Style::default().with(|style| {
        style.codes.footprint = Footprint::Masks;
        style.drawing.renderer = RendererChoice::Gpu;
    })
}

/// A bumpy ball, whose cells lie on several levels of detail.
fn ball(count: usize) -> PreparedFrame {
    let mut random = Random(5);
    let mut direction = || random.cube().normalize_or(Vec3::Z);
    let normals: Vec<Vec3> = (0..count).map(|_| direction()).collect();
    let radius = |normal: &Vec3| 1.0 + 0.05 * (7.0 * normal.x).sin() * (5.0 * normal.y).cos();
    let positions = normals.iter().map(|normal| (*normal * radius(normal)).to_array());
    let mut raw = RawCloud::from_positions(Positions::F32(positions.collect()));
    let color = |index: usize| [index as u8, (index >> 8) as u8, 77, 255];
    raw.attributes.colors = Some((0..count).map(color).collect());
    raw.attributes.normals = Some(normals.iter().map(Vec3::to_array).collect());
    raw.attributes.radii = Some(vec![0.02; count]);
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    prepare(
        0,
        Arc::new(frame),
        0.0,
        &Scene::needs(&style()),
        &PrepareCounters::default(),
    )
}

fn packet(frame: &PreparedFrame, camera: &Camera, style: &Style) -> ScenePacket {
    Scene::default().packet(frame, DVec3::ZERO, camera, style, [320, 240])
}

fn read<T: bytemuck::Pod>(context: &Context, from: &wgpu::Buffer) -> Vec<T> {
    let readable = context.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: from.size(),
        usage: Usages::MAP_READ | Usages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = context
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, &readable, 0, readable.size());
    context.queue.submit([encoder.finish()]);
    map_and_read(context, &readable, bytemuck::pod_collect_to_vec).unwrap()
}

/// Output of the passes for a code: records in chunks, and the number of drawn nodes.
fn made(context: &Context, cells: &CodedCells, view: &CodeView) -> (Vec<PointRecord>, Vec<ShapeRecord>, usize) {
    let nodes = cells.deepest_nodes();
    let code = CodeExpander::upload(context, &cells.cloud);
    let tables = Tables::new(context, view);
    let scratch = Scratch::for_nodes(context, None, nodes);
    let expanded = Expanded {
        programs: &ComputePrograms::new(context, SHADER),
        scratch: &scratch,
        code: code.to_gather_from().unwrap(),
        tables: &tables.buffer,
    };
    let counts: Vec<usize> = (0..nodes).step_by(MAX).map(|first| MAX.min(nodes - first)).collect();
    let buffers = counts.iter().map(|&count| {
        // Nothing that was there before is left.
        let filled = vec![0xee; 16 * count];
        [0, 1].map(|_| context.filled_buffer("room", Usages::STORAGE | Usages::COPY_SRC, &filled, filled.len()))
    });
    let buffers: Vec<[wgpu::Buffer; STREAMS]> = buffers.collect();
    let outputs = counts
        .iter()
        .zip(&buffers)
        .map(|(&count, [points, shapes])| record::Output {
            records: count as u32,
            points,
            shapes,
        });
    let uniforms = Expanding::of_levels(&cells.cloud, view, view.deepest_level.min(cells.cloud.depth()));
    let mut encoder = context
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut recording = Recording::new(context, &mut encoder, None);
    expand(&mut recording, &expanded, &uniforms);
    write(&mut recording, &expanded, &uniforms[0], outputs);
    context.queue.submit([encoder.finish()]);
    let [points, shapes] = [0, 1].map(|stream| buffers.iter().map(move |buffers| &buffers[stream]));
    let found: Vec<u32> = read(context, scratch.buffer(FOUND));
    (
        points.flat_map(|buffer| read(context, buffer)).collect(),
        shapes.flat_map(|buffer| read(context, buffer)).collect(),
        found[2] as usize,
    )
}

/// Records are the same. Where a number is at its threshold except for rounding, a node may be drawn, or divided, by
/// one alone.
fn agree(context: &Context, name: &str, packet: &ScenePacket) -> usize {
    let cells = packet.content.coded().expect("a byte code");
    let view = packet.code_view(cells);
    let (points, shapes) = cells.cloud.surfels(&view);
    let (of_gpu, shapes_of_gpu, drawn) = made(context, cells, &view);
    let (of_gpu, after) = of_gpu.split_at(drawn);
    assert_eq!(after.len(), cells.deepest_nodes() - drawn, "{name}");
    assert!(
        shapes_of_gpu[drawn..].iter().all(|shape| shape.radius == -1.0),
        "{name}"
    );
    let key = |point: &PointRecord| (point.color, point.position.map(|axis| (axis * 1e4).round() as i32));
    let mut unmatched: std::collections::HashMap<_, Vec<usize>> = std::collections::HashMap::new();
    for (index, point) in points.iter().enumerate() {
        unmatched.entry(key(point)).or_default().push(index);
    }
    let (mut both, mut last, mut is_in_order) = (0, 0, true);
    for (point, shape) in of_gpu.iter().zip(&shapes_of_gpu) {
        let Some(index) = unmatched
            .get_mut(&key(point))
            .and_then(|found| (!found.is_empty()).then(|| found.remove(0)))
        else {
            continue;
        };
        both += 1;
        is_in_order &= last <= index;
        last = index;
        assert_eq!(shape.normal, shapes[index].normal, "{name}: {point:?}");
        assert!(
            (shape.radius / shapes[index].radius - 1.0).abs() < 1e-5,
            "{name}: {shape:?}"
        );
    }
    assert!(is_in_order, "{name}: by level, and in Morton order on each");
    let alone = points.len() + drawn - 2 * both;
    assert!(
        alone * 200 <= both,
        "{name}: {alone} drawn by one alone, {both} by both"
    );
    both
}

#[test]
fn passes_find_the_same_nodes_as_the_cpu() {
    let options = ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    };
    let context = Context::headless(&options).unwrap();
    let frame = ball(30_000);
    let bounds = frame.frame.bounds();
    let camera = |distance: f64, azimuth_deg: f64| Camera {
        distance,
        azimuth_deg,
        elevation_deg: 20.0,
        ..Camera::framing(&bounds, DVec3::ZERO, UpAxis::Y)
    };
    let mut counts = Vec::new();
    for (distance, azimuth_deg) in [(3.5, 0.0), (40.0, 100.0), (1.2, 210.0), (0.3, 33.0)] {
        for (lod, back_faces) in [
            (Lod::ThresholdPx(0.0), BackFaces::Drawn),
            (Lod::ThresholdPx(4.0), BackFaces::Culled),
            (Lod::ThresholdPx(12.0), BackFaces::Drawn),
            (Lod::Level(4), BackFaces::Culled),
        ] {
            for (bits, footprint) in [
                (NormalBits::Thirteen, Footprint::Masks),
                (NormalBits::Fifteen, Footprint::Pixels),
                (NormalBits::Seventeen, Footprint::Masks),
            ] {
                let style = style().with(|style| {
                    style.codes.footprint = footprint;
                    style.levels.lod = lod;
                    style.surfels.back_faces = back_faces;
                    style.codes.normal_bits = bits;
                });
                let name = format!("{footprint:?}, {lod:?}, {back_faces:?}, {bits:?}, {distance} away");
                counts.push(agree(
                    &context,
                    &name,
                    &packet(&frame, &camera(distance, azimuth_deg), &style),
                ));
            }
        }
    }
    // All leaves, a few large cells, and some of the nodes of a view from within.
    assert!(counts[0] > 10_000, "{counts:?}");
    assert!(counts.iter().any(|&count| (1..100).contains(&count)), "{counts:?}");
}

/// More nodes than a workgroup has sums of workgroups for: the scan goes round more than once.
#[test]
fn large_queues_are_scanned_in_rounds() {
    let context = Context::headless(&ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    });
    let frame = ball(150_000);
    let style = style().with(|style| {
        style.levels.lod = Lod::ThresholdPx(0.0);
        style.surfels.back_faces = BackFaces::Drawn;
    });
    let camera = Camera::framing(&frame.frame.bounds(), DVec3::ZERO, UpAxis::Y);
    let both = agree(&context.unwrap(), "150,000 points", &packet(&frame, &camera, &style));
    assert!(both > 256 * 256, "{both}");
}

#[test]
fn a_code_of_one_node_and_an_empty_one_can_be_drawn() {
    let context = Context::headless(&ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    });
    let context = context.unwrap();
    let packet_of = |count| {
        let frame = ball(count);
        let camera = Camera::framing(&frame.frame.bounds(), DVec3::ZERO, UpAxis::Y);
        packet(&frame, &camera, &style())
    };
    let one = packet_of(1);
    assert_eq!(agree(&context, "one node", &one), 1);
    // Without a root there is nothing to traverse.
    let mut renderer = GpuRenderer::new(context).unwrap();
    renderer.set_makes_surfels(true);
    let empty = packet_of(0);
    assert!(empty.content.coded().is_some());
    let nothing = ScenePacket {
        content: Content::Nothing,
        ..empty.clone()
    };
    let [image, background] = [empty, nothing].map(|packet| {
        renderer.prepare(&packet).unwrap();
        renderer.render().unwrap();
        renderer.read_image().unwrap()
    });
    assert_eq!(image, background);
}
