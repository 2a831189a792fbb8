//! Tests of node selection on the GPU against the CPU: every bit is the same.

use super::context::{Context, ContextOptions};
use super::gather_program::FILTER;
use super::gpu_data::Filtering;
use super::readback::map_and_read;
use crate::analysis::test_shapes::{self, Random};
use crate::cloud::{PointRecord, ShapeRecord, oct_encode};
use crate::levels::{
    CutHints, Levels, LodMetric, RecordBuffers, Records, SelectView, Selection, SequenceFilter, SphereKind,
    SphereLevels,
};
use crate::math::{Cube, Frustum, order_of_codes};
use glam::{Mat4, Vec3, Vec4};
use std::sync::Arc;
use wgpu::BufferUsages as Usages;

fn context() -> Arc<Context> {
    let options = ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    };
    Context::headless(&options).unwrap()
}

/// Runs a compute shader for this many invocations in groups of 256 and reads the buffer at one of its bindings.
fn run(
    context: &Context,
    source: &str,
    entry_point: &str,
    invocations: usize,
    buffers: &[(Usages, &[u8])],
    result: usize,
) -> Vec<u32> {
    let device = &context.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let filled = |&(usage, bytes): &(Usages, &[u8])| {
        let usage = if usage == Usages::STORAGE {
            usage | Usages::COPY_SRC
        } else {
            usage
        };
        context.filled_buffer("test", usage, bytes, bytes.len())
    };
    let buffers: Vec<wgpu::Buffer> = buffers.iter().map(filled).collect();
    let entries: Vec<_> = (0..)
        .zip(&buffers)
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let readable = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffers[result].size(),
        usage: Usages::MAP_READ | Usages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(invocations.div_ceil(256) as u32, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&buffers[result], 0, &readable, 0, readable.size());
    context.queue.submit([encoder.finish()]);
    map_and_read(context, &readable, bytemuck::pod_collect_to_vec).unwrap()
}

fn words(number: f64) -> [u32; 2] {
    [number.to_bits() as u32, (number.to_bits() >> 32) as u32]
}

/// Numbers of all sizes: near one another, far apart, with few bits and with all, and zero.
fn numbers(random: &mut Random) -> Vec<[f64; 2]> {
    let mut number = || {
        let bits = u64::from((random.cube().x * 16_777_216.0) as u32) << 40
            | u64::from((random.cube().y * 16_777_216.0) as u32) << 20
            | u64::from((random.cube().z * 16_777_216.0) as u32);
        let spread = if bits & 1 == 0 { 8 } else { 300 };
        let exponent = 1023 + (bits >> 8) % spread - spread / 2;
        let few = if bits & 6 == 0 { 0xf_ff00_0000_0000 } else { u64::MAX };
        f64::from_bits((bits >> 4 & 1) << 63 | exponent << 52 | bits.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 12 & few)
    };
    let mut pairs: Vec<[f64; 2]> = (0..60_000).map(|_| [number(), number()]).collect();
    for ulps in 0..2000_u64 {
        let a = number();
        // Nearly equal, and of opposite sign: the difference has few bits.
        pairs.push([a, -f64::from_bits(a.to_bits() + ulps % 5)]);
        pairs.push([a, a]);
    }
    pairs.extend([
        [0.0, 1.5],
        [1.5, 1.0],
        [4.0, 2.0],
        [2.0, 1e-200],
        [1.0, f64::EPSILON / 2.0],
        [0.0, 7.0],
    ]);
    pairs
}

#[test]
fn emulated_double_arithmetic_matches_the_cpu() {
    let source = [
        include_str!("../../../shaders/common/f64.wgsl"),
        "@group(0) @binding(0) var<storage, read> pairs: array<vec4u>;
        @group(0) @binding(1) var<storage, read_write> results: array<vec4u>;

        @compute @workgroup_size(256)
        fn calculate(@builtin(global_invocation_id) id: vec3u) {
            if (id.x < arrayLength(&pairs)) {
                let a = pairs[id.x].xy;
                let b = pairs[id.x].zw;
                results[2u * id.x] = vec4u(sum(a, b), product(a, b));
                results[2u * id.x + 1u] = vec4u(quotient(a, b), root(magnitude(a)));
            }
        }",
    ];
    let pairs = numbers(&mut Random(3));
    let given: Vec<[u32; 2]> = pairs.iter().flatten().map(|&number| words(number)).collect();
    let results = run(
        &context(),
        &source.concat(),
        "calculate",
        pairs.len(),
        &[
            (Usages::STORAGE, bytemuck::cast_slice(&given)),
            (Usages::STORAGE, &vec![0; 32 * pairs.len()]),
        ],
        1,
    );
    let results: &[[[u32; 2]; 4]] = bytemuck::cast_slice(&results);
    for (&[a, b], found) in pairs.iter().zip(results) {
        // The sign of a zero result does not matter.
        let expected = [a + b, a * b, a / b, a.abs().sqrt()].map(words);
        assert_eq!(found[1..], expected[1..], "{a:e} and {b:e}");
        assert!(
            found[0] == expected[0] || a + b == 0.0 && found[0][0] == 0,
            "{a:e} + {b:e}"
        );
    }
}

#[test]
fn single_floats_convert_to_the_same_doubles() {
    let source = [
        include_str!("../../../shaders/common/f64.wgsl"),
        "@group(0) @binding(0) var<storage, read> singles: array<u32>;
        @group(0) @binding(1) var<storage, read_write> results: array<vec2u>;

        @compute @workgroup_size(256)
        fn widen(@builtin(global_invocation_id) id: vec3u) {
            if (id.x < arrayLength(&singles)) {
                results[id.x] = f64_of_f32(singles[id.x]);
            }
        }",
    ];
    let mut singles = vec![
        0.0,
        -1.0,
        1.0,
        f32::MIN_POSITIVE,
        f32::MAX,
        -3.0e-45,
        1.0e-40,
        0.1,
        -1e30,
    ];
    singles.extend((0..5000).map(|i| f32::from_bits(0x9e37_79b9_u32.wrapping_mul(i) & 0xbf7f_ffff)));
    let results = run(
        &context(),
        &source.concat(),
        "widen",
        singles.len(),
        &[
            (Usages::STORAGE, bytemuck::cast_slice(&singles)),
            (Usages::STORAGE, &vec![0; 8 * singles.len()]),
        ],
        1,
    );
    let results: &[[u32; 2]] = bytemuck::cast_slice(&results);
    for (&single, &found) in singles.iter().zip(results) {
        assert_eq!(found, words(f64::from(single)), "{single:e}");
    }
}

/// A sequence of a torus of this radius, with its nodes retained.
fn sequence(scale: f32) -> SphereLevels {
    let torus = test_shapes::torus(4000, 0.4, &mut Random(5));
    let positions: Vec<Vec3> = torus.positions.iter().map(|&position| position * scale).collect();
    let cube = Cube::around(&positions).unwrap();
    let order = order_of_codes(&cube.codes(&positions));
    let at = || order.iter().map(|&index| index as usize);
    let point = |index: usize| PointRecord {
        position: positions[index].to_array(),
        color: [index as u8; 4],
    };
    let shape = |index: usize| ShapeRecord {
        normal: oct_encode(torus.normals[index]),
        radius: 0.02 * scale,
        ellipse: 0,
        scalar: index as f32,
    };
    let (points, shapes) = (at().map(point).collect(), at().map(shape).collect());
    let levels = SphereLevels::build(SphereKind::Sequential, cube, Arc::new(points), Arc::new(shapes));
    let view = view(Vec3::splat(scale), scale, 0.0, LodMetric::Edge);
    let cut = levels.cut(&view, CutHints::default());
    while levels.select(&cut, &mut RecordBuffers::default()).is_none() {}
    levels
}

/// A 60° view of 500×500 pixels towards the origin.
fn view(eye: Vec3, scale: f32, lod_px: f32, metric: LodMetric) -> SelectView {
    let focal = 3f32.sqrt();
    let clip_from_view = Mat4::from_cols(
        Vec4::new(focal, 0.0, 0.0, 0.0),
        Vec4::new(0.0, focal, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, 0.001 * scale, 0.0),
    );
    let forward = -eye.normalize();
    let right = forward.any_orthonormal_vector();
    let space_from_view = Mat4::from_cols(
        right.extend(0.0),
        right.cross(forward).extend(0.0),
        (-forward).extend(0.0),
        eye.extend(1.0),
    );
    SelectView {
        frustum: Frustum::from_clip_matrix(&(clip_from_view * space_from_view.inverse())),
        eye,
        pixels_per_unit_at_1: focal * 250.0,
        lod_px,
        metric,
        deepest_level: SelectView::ALL_LEVELS,
    }
}

/// Runs the filter pass on the shapes of candidates and returns its output.
fn filtered(context: &Context, filter: &SequenceFilter, shapes: &[ShapeRecord]) -> Vec<ShapeRecord> {
    let filtering = Filtering::of(filter, 0..filter.len() as u32, true);
    let results = run(
        context,
        &FILTER.source().unwrap(),
        "gather",
        filter.len(),
        &[
            (Usages::UNIFORM, bytemuck::bytes_of(&filtering)),
            (Usages::STORAGE, bytemuck::cast_slice(filter.parents())),
            (Usages::STORAGE, bytemuck::cast_slice(shapes)),
            (Usages::STORAGE, &vec![0; filter.len() * size_of::<ShapeRecord>()]),
            (Usages::STORAGE, bytemuck::cast_slice(filter.bounds())),
        ],
        3,
    );
    bytemuck::cast_slice(&results).to_vec()
}

#[test]
fn the_pass_draws_the_same_nodes_as_the_cpu() {
    let context = context();
    // At the larger scale single precision is useless, as squares may overflow: everything is decided in double
    // precision.
    for scale in [1.0_f32, 1e16] {
        let levels = sequence(scale);
        let mut drawn_in_all = 0;
        for metric in [LodMetric::Edge, LodMetric::Area] {
            for culls_back_faces in [false, true] {
                for (eye, lod_px) in [
                    ([3.0, 4.0, 5.0], 4.0),
                    ([0.3, 2.0, 0.2], 9.0),
                    ([1.2, 0.1, 0.1], 2.0),
                    ([0.0, 0.0, -20.0], 1.0),
                ] {
                    let view = view(Vec3::from_array(eye) * scale, scale, lod_px, metric);
                    for deepest_level in [SelectView::ALL_LEVELS, 4] {
                        let view = SelectView { deepest_level, ..view };
                        let hints = CutHints {
                            culls_back_faces,
                            before: None,
                        };
                        let Some(Records::Selected { nodes, selection }) = levels.filter(&view, hints) else {
                            panic!("the root is divided")
                        };
                        let Selection::Filtered(filter) = &selection else {
                            panic!("{selection:?}")
                        };
                        let found = filtered(&context, filter, &nodes.shapes);
                        for (candidate, found) in (0..).zip(&found) {
                            let shape = nodes.shapes[filter.name(candidate) as usize];
                            let is_drawn = filter.draws(candidate);
                            let expected = if is_drawn { shape.radius } else { -1.0 };
                            assert_eq!(
                                *found,
                                ShapeRecord {
                                    radius: expected,
                                    ..shape
                                },
                                "{candidate} from {eye:?}, {metric:?}, culled: {culls_back_faces}, scale {scale}"
                            );
                            drawn_in_all += usize::from(is_drawn);
                        }
                        let cut = levels.cut(&view, hints);
                        let (points, _) = selection.gathered(&nodes, Vec::new(), Vec::new());
                        assert_eq!(points.len(), cut.node_count());
                    }
                }
            }
        }
        assert!(drawn_in_all > 1000, "{drawn_in_all}");
    }
}
