//! Strategy `compute`: compute passes write the corners and the draw call, as the paper's geometry shader did.
//!
//! Records that lie outside the view or face away are dropped before they cost a vertex; the rest stays in the order of
//! the cloud (a prefix sum, no atomics), so blending gives the same image as every other strategy. The corners are
//! computed by the very WGSL functions that the other strategies run in the vertex stage. It wins when much of the
//! cloud is not seen and costs 32 bytes per corner (128 per surfel, 384 per voxel) of memory when all of it is.

use super::binding::{max_indexed_records, single_binding};
use super::record_buffer::RecordBuffer;
use super::storage::{self, Storage};
use super::strategy::{Instancing, RecordInstancing, StrategyRow};
use super::stream::{Chunk, Draw, ViewBinding};
use crate::render::gpu::compute::{BufferGroup, BufferRow, declarations_of, pipeline, shader_module};
use crate::render::gpu::constants::{GROUP_RECORDS, OUTPUT_GROUP, STREAM_GROUP, VIEW_GROUP};
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::{DrawIndexedIndirect, SplatVertex};
use crate::render::gpu::layout::Shared;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::recording::Recording;
use crate::render::gpu::wgsl::{ImportError, assembled, shader_file};
use std::collections::HashMap;

/// Output bindings of a chunk.
const VERTICES: u32 = 0;
const GROUP_OFFSETS: u32 = 1;
const DRAW: u32 = 2;

const OUTPUTS: [BufferRow; 3] = [
    BufferRow::read_write(VERTICES, "vertices", "array<SplatVertex>"),
    BufferRow::read_write(GROUP_OFFSETS, "group_offsets", "array<u32>"),
    BufferRow::read_write(DRAW, "draw", "DrawIndexedIndirect"),
];

pub(super) const ROW: StrategyRow = StrategyRow {
    fetch_corner: Some(shader_file!("fetch/compute.wgsl")),
    open: |context, view_layout| Box::new(Compute::new(context, view_layout)),
    ..storage::ROW
};

/// The WGSL of the passes that write corners.
pub(in crate::render::gpu) fn amplifying_source(amplification: &Amplification) -> Result<String, ImportError> {
    let mut files = ROW.amplifying_files(amplification);
    files.push(shader_file!("passes/amplify.wgsl"));
    let outputs = DrawIndexedIndirect::LAYOUT.declaration() + &declarations_of("OUTPUT_GROUP", &OUTPUTS);
    assembled(&[amplification.given(), ("generated/outputs", outputs)], &files)
}

#[derive(Debug)]
struct Compute {
    storage: Storage,
    outputs: BufferGroup,
    view_layout: wgpu::BindGroupLayout,
    /// Pipelines by the name of their amplification.
    pipelines: HashMap<&'static str, Pipelines>,
    /// For each chunk amplified last.
    amplified: Vec<AmplifiedChunk>,
}

#[derive(Debug)]
struct Pipelines {
    count: wgpu::ComputePipeline,
    scan: wgpu::ComputePipeline,
    emit: wgpu::ComputePipeline,
}

/// Output buffers for the corners of one chunk.
#[derive(Debug)]
struct AmplifiedChunk {
    record_capacity: u32,
    vertices_per_record: u32,
    indirect: wgpu::Buffer,
    compute_group: wgpu::BindGroup,
    draw_group: wgpu::BindGroup,
}

impl Compute {
    fn new(context: &Context, view_layout: &wgpu::BindGroupLayout) -> Self {
        Self {
            storage: Storage::new(context),
            outputs: BufferGroup::new(context, "amplified", &OUTPUTS),
            view_layout: view_layout.clone(),
            pipelines: HashMap::new(),
            amplified: Vec::new(),
        }
    }

    fn build_pipelines(&self, context: &Context, amplification: &'static Amplification) -> Pipelines {
        let label = amplification.name;
        let module = shader_module(context, label, amplifying_source(amplification));
        let stream = self.storage.stream_layout();
        let shapes = stream.filter(|_| amplification.reads_shapes);
        let groups = [Some(&self.view_layout), stream, shapes, Some(&self.outputs.layout)];
        let pipeline = |entry| pipeline(context, label, &module, entry, &groups);
        Pipelines {
            count: pipeline("count"),
            scan: pipeline("scan"),
            emit: pipeline("emit"),
        }
    }

    fn build_output(&self, context: &Context, record_count: u32, vertices_per_record: u32) -> AmplifiedChunk {
        let buffer = |label, size, usage| {
            context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | usage,
                mapped_at_creation: false,
            })
        };
        let corners = u64::from(record_count) * u64::from(vertices_per_record);
        let none = wgpu::BufferUsages::empty();
        let vertices = buffer("amplified corners", corners * size_of::<SplatVertex>() as u64, none);
        let groups = u64::from(record_count.div_ceil(GROUP_RECORDS));
        let group_offsets = buffer("amplified offsets", groups * size_of::<u32>() as u64, none);
        let draw_bytes = size_of::<DrawIndexedIndirect>() as u64;
        let indirect = buffer("amplified draw", draw_bytes, wgpu::BufferUsages::INDIRECT);
        AmplifiedChunk {
            record_capacity: record_count,
            vertices_per_record,
            compute_group: self.outputs.bound(context, |binding| match binding {
                VERTICES => &vertices,
                GROUP_OFFSETS => &group_offsets,
                _ => &indirect,
            }),
            draw_group: single_binding(context, &self.storage.layout, vertices.as_entire_binding()),
            indirect,
        }
    }
}

impl Instancing for Compute {
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        self.storage.stream_layout()
    }

    fn group_layouts(&self, amplification: &'static Amplification) -> Vec<&wgpu::BindGroupLayout> {
        if amplification.compute_amplifies {
            // The corners.
            vec![&self.storage.layout]
        } else {
            self.storage.group_layouts(amplification)
        }
    }

    fn max_chunk_records(&self, context: &Context, amplification: &'static Amplification) -> usize {
        let limits = &context.limits;
        let corner_bytes = amplification.vertices_per_record as usize * size_of::<SplatVertex>();
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let groups = limits.max_compute_workgroups_per_dimension as usize;
        (usize::try_from(bytes).unwrap_or(usize::MAX) / corner_bytes)
            .min(groups * GROUP_RECORDS as usize)
            .min(max_indexed_records(context, amplification))
    }

    fn amplify(&mut self, recording: &mut Recording<'_>, view: ViewBinding<'_>, draw: &Draw<'_>) -> u64 {
        let amplification = draw.amplification;
        let context = recording.context;
        // Left-overs of an earlier cloud must not be drawn.
        self.amplified.truncate(draw.chunk_count());
        if !amplification.compute_amplifies || draw.chunk_count() == 0 {
            return 0;
        }
        if !self.pipelines.contains_key(amplification.name) {
            let pipelines = self.build_pipelines(context, amplification);
            self.pipelines.insert(amplification.name, pipelines);
        }
        let vertices_per_record = amplification.vertices_per_record;
        for chunk in 0..draw.chunk_count() {
            let records = draw.chunk_records(chunk);
            let fits = self.amplified.get(chunk).is_some_and(|output| {
                // `scan` reads as many offsets as the buffer has, so the capacity must be exact.
                output.record_capacity == records && output.vertices_per_record == vertices_per_record
            });
            if !fits {
                let output = self.build_output(context, records, vertices_per_record);
                if chunk < self.amplified.len() {
                    self.amplified[chunk] = output;
                } else {
                    self.amplified.push(output);
                }
            }
        }
        let pipelines = &self.pipelines[amplification.name];
        let mut pass = recording.begin_compute("amplify");
        pass.set_bind_group(VIEW_GROUP, view.bind_group, &[view.offset]);
        for (chunk, output) in self.amplified.iter().enumerate() {
            for (group, stream) in (STREAM_GROUP..).zip(draw.streams) {
                pass.set_bind_group(group, stream.chunks[chunk].bind_group.as_ref(), &[]);
            }
            pass.set_bind_group(OUTPUT_GROUP, &output.compute_group, &[]);
            let groups = draw.chunk_records(chunk).div_ceil(GROUP_RECORDS);
            pass.set_pipeline(&pipelines.count);
            pass.dispatch_workgroups(groups, 1, 1);
            pass.set_pipeline(&pipelines.scan);
            pass.dispatch_workgroups(1, 1, 1);
            pass.set_pipeline(&pipelines.emit);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        1
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>) -> u32 {
        if !draw.amplification.compute_amplifies {
            return self.storage.draw(pass, draw);
        }
        for output in &self.amplified {
            pass.set_bind_group(STREAM_GROUP, &output.draw_group, &[]);
            match draw.amplification.quads_per_record() {
                0 => pass.draw_indirect(&output.indirect, 0),
                _ => pass.draw_indexed_indirect(&output.indirect, 0),
            }
        }
        self.amplified.len() as u32
    }
}

impl RecordInstancing for Compute {
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk {
        self.storage.upload(context, records)
    }

    fn record_buffer(&self, context: &Context, capacity: usize) -> RecordBuffer {
        self.storage.record_buffer(context, capacity)
    }

    fn chunk_in(&self, context: &Context, record_buffer: &RecordBuffer, record_count: u32) -> Chunk {
        self.storage.chunk_in(context, record_buffer, record_count)
    }
}
