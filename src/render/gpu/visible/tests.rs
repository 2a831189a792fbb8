//! Surfels made by passes compared with the CPU's, on depth images of surfaces.

use super::passes::Programs;
use super::record::{Screened, find_visible, write_surfels};
use super::scratch::{Scratch, Sizes};
use super::*;
use crate::analysis::screen::{ScreenCloud, ScreenEstimator, ScreenView, Search};
use crate::cloud::{PointRecord, ShapeRecord, oct_decode};
use crate::render::gpu::context::ContextOptions;
use crate::render::gpu::readback::map_and_read;
use glam::{Mat3, Vec3};
use wgpu::BufferUsages as Usages;

/// Records of a chunk: fewer than there are points.
const MAX: usize = 10_000;

/// A camera in the plane of x and z that looks at a point one unit in front of the sensor.
fn view(eye: Vec3, size_px: [u32; 2], px_per_slope: f32) -> ScreenView {
    let back = (eye - Vec3::NEG_Z).normalize();
    let right = Vec3::Y.cross(back).normalize();
    ScreenView {
        rotation: Mat3::from_cols(right, back.cross(right), back).transpose(),
        eye_high: eye,
        eye_low: Vec3::ZERO,
        near: 0.01,
        size_px,
        px_per_slope: [px_per_slope, -px_per_slope],
        center_px: size_px.map(|edge| 0.5 * edge as f32),
    }
}

/// One point a pixel of a sensor of 320×240 pixels, where `depth_along` knows the depth along a ray with z = −1.
fn depth_image(depth_along: impl Fn(Vec3) -> Option<f32>) -> Vec<PointRecord> {
    let mut points = Vec::new();
    for row in 0..240_u16 {
        for column in 0..320_u16 {
            let [x, y] = [f32::from(column) - 159.5, f32::from(row) - 119.5].map(|px| px / 262.0);
            let ray = Vec3::new(x, -y, -1.0);
            points.extend(depth_along(ray).map(|depth| PointRecord {
                position: (depth * ray).to_array(),
                color: [row as u8, column as u8, 0, 255],
            }));
        }
    }
    points
}

fn ball(ray: Vec3) -> Option<f32> {
    let (a, b) = (ray.length_squared(), -ray.z);
    let root = b * b - a * 0.91;
    (root > 0.0).then(|| (b - root.sqrt()) / a)
}

fn plane(ray: Vec3) -> Option<f32> {
    let normal = Vec3::new(0.3, 0.5, 0.8);
    let depth = -1.2 * normal.z / normal.dot(ray);
    (depth > 0.0 && depth < 6.0).then_some(depth)
}

/// A torus, by steps as long as it is away.
fn torus(ray: Vec3) -> Option<f32> {
    let unit = ray.normalize();
    let mut along = 0.3;
    for _ in 0..200 {
        let place = Mat3::from_rotation_x(0.6) * (along * unit - Vec3::NEG_Z);
        let away = (place.truncate().length() - 0.25).hypot(place.z) - 0.1;
        if away < 1e-5 {
            return Some(along * -unit.z);
        }
        along += away;
        if along > 3.0 {
            break;
        }
    }
    None
}

/// Output of the passes for points, in chunks, with nothing after the visible ones.
fn made(
    context: &Context,
    points: &[PointRecord],
    view: &ScreenView,
    cloud: &ScreenCloud,
) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
    let with_margin = with_margin_of_splats(view, points, cloud.spacing);
    let screening = Screening::of(&with_margin, cloud, points.len() as u32);
    let sizes = Sizes {
        points: points.len() as u32,
        size_px: screening.size_px,
    };
    assert!(sizes.fit(context));
    let counts: Vec<u32> = points.chunks(MAX).map(|chunk| chunk.len() as u32).collect();
    let mut uniforms: Vec<Screening> = (0..=MAX_LEVELS).map(|level| Screening { level, ..screening }).collect();
    uniforms.extend((0..).zip(&counts).map(|(chunk, &count)| Screening {
        first: chunk * MAX as u32,
        count,
        ..screening
    }));
    let mut scratch = Scratch::for_sizes(context, None, &sizes);
    scratch.upload(context, &uniforms);
    let bytes: &[u8] = bytemuck::cast_slice(points);
    let all = context.filled_buffer("points", Usages::STORAGE, bytes, bytes.len());
    let record_buffer = |&count: &u32| {
        let empty = vec![0; 16 * count as usize];
        [0, 1].map(|_| context.filled_buffer("room", Usages::STORAGE | Usages::COPY_SRC, &empty, empty.len()))
    };
    let record_buffers: Vec<[wgpu::Buffer; STREAMS]> = counts.iter().map(record_buffer).collect();
    let bound: Vec<[&wgpu::Buffer; STREAMS]> = record_buffers.iter().map(|[points, shapes]| [points, shapes]).collect();
    let screened = Screened {
        programs: &Programs::new(context),
        scratch: &scratch,
        points: &all,
        sizes: &sizes,
    };
    let mut encoder = context
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut recording = Recording::new(context, &mut encoder, None);
    find_visible(&mut recording, &screened);
    write_surfels(&mut recording, &screened, &bound, &counts);
    context.queue.submit([encoder.finish()]);
    let (mut drawn, mut shapes) = (Vec::new(), Vec::new());
    for [of_points, of_shapes] in bound {
        drawn.extend(read::<PointRecord>(context, of_points));
        shapes.extend(read::<ShapeRecord>(context, of_shapes));
    }
    (drawn, shapes)
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

#[test]
fn passes_find_the_same_points_and_normals_as_the_cpu() {
    let options = ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    };
    let context = Context::headless(&options).unwrap();
    let views = [
        view(Vec3::new(0.05, 0.02, 0.0), [640, 480], 525.0),
        view(Vec3::new(0.7, 0.3, -0.2), [500, 300], 400.0),
        view(Vec3::new(0.5, 1.0, 4.0), [320, 240], 300.0),
        view(Vec3::new(1.5, 0.1, -1.3), [640, 360], 500.0),
    ];
    for (name, points) in [
        ("ball", depth_image(ball)),
        ("torus", depth_image(torus)),
        ("plane", depth_image(plane)),
    ] {
        for (place, view) in views.iter().enumerate() {
            for sensor in [None, Some(Vec3::ZERO)] {
                let name = format!("{name} in view {place}, sensor {sensor:?}");
                let cloud = ScreenCloud {
                    spacing: 0.004,
                    closing: 1.0,
                    sensor,
                };
                agree(&context, &name, &points, view, &cloud);
            }
        }
    }
}

/// Compares both. Where numbers are equal except for rounding, a point may be visible to one alone; at outlines a
/// normal may be turned to either side.
fn agree(context: &Context, name: &str, points: &[PointRecord], view: &ScreenView, cloud: &ScreenCloud) {
    let mut estimator = ScreenEstimator::default();
    let visible = estimator.cull(view, points, cloud);
    let expected = estimator.surface(&visible, cloud, Search::Fixed);
    let mut of_processor = vec![None; points.len()];
    for (&slot, shape) in visible.slots.iter().zip(&expected) {
        of_processor[slot as usize] = Some(*shape);
    }
    let (drawn, shapes) = made(context, points, view, cloud);
    let count = shapes.iter().take_while(|shape| shape.radius > 0.0).count();
    assert!(shapes[count..].iter().all(|shape| shape.radius == -1.0), "{name}");
    let (mut both, mut off) = (0, 0);
    let mut slots = 0..points.len();
    for (point, shape) in drawn[..count].iter().zip(&shapes) {
        // They are in order.
        let slot = slots.find(|&slot| points[slot] == *point).unwrap();
        if let Some(expected) = of_processor[slot] {
            both += 1;
            let cosine = oct_decode(expected.normal).dot(oct_decode(shape.normal));
            let ratio = shape.radius / expected.radius;
            off += usize::from(cosine < 0.999_99 || (ratio - 1.0).abs() > 1e-3);
        }
    }
    let alone = visible.len() + count - 2 * both;
    assert!(both > 500, "{name}: {both}");
    assert!(alone * 1000 <= both, "{name}: {alone} seen by one alone of {both}");
    assert!(off * 200 <= both, "{name}: {off} of {both} are otherwise");
}
