//! Strategy `vertex`: records are per-instance vertex attributes, stepped by the hardware.
//!
//! The most natural of the paper's variants and the slowest there: every record is an instance of its own with 3 or 4
//! (surfel) or 12 (voxel) vertices, and small instances leave most of a wave idle. It needs no binding at all.

use super::binding::{buffer_for, buffer_with, records_of};
use super::record_buffer::RecordBuffer;
use super::strategy::{Instancing, RecordInstancing, StrategyRow};
use super::stream::{Chunk, Draw, RECORD_BYTES};
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::wgsl::shader_file;

const POINT_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32];

const SHAPE_ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![2 => Uint32, 3 => Float32, 4 => Uint32, 5 => Float32];

pub(super) const ROW: StrategyRow = StrategyRow {
    fetch: [
        shader_file!("fetch/vertex_points.wgsl"),
        shader_file!("fetch/vertex.wgsl"),
    ],
    fetch_corner: None,
    open: |_, _| Box::new(Vertex),
};

#[derive(Debug)]
struct Vertex;

impl Instancing for Vertex {
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        None
    }

    fn vertex_buffers(&self, amplification: &'static Amplification) -> Vec<wgpu::VertexBufferLayout<'static>> {
        let step_mode = if amplification.is_point_list() {
            wgpu::VertexStepMode::Vertex
        } else {
            wgpu::VertexStepMode::Instance
        };
        let stream = |attributes| wgpu::VertexBufferLayout {
            array_stride: RECORD_BYTES as u64,
            step_mode,
            attributes,
        };
        let mut layouts = vec![stream(POINT_ATTRIBUTES.as_slice())];
        if amplification.reads_shapes {
            layouts.push(stream(SHAPE_ATTRIBUTES.as_slice()));
        }
        layouts
    }

    fn max_chunk_records(&self, context: &Context, _amplification: &'static Amplification) -> usize {
        records_of(context.limits.max_buffer_size)
    }

    fn quads_per_draw(&self, _records: u32, amplification: &'static Amplification) -> u32 {
        amplification.quads_per_record()
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>) -> u32 {
        for chunk in 0..draw.chunk_count() {
            for (slot, stream) in (0..).zip(draw.streams) {
                if let Some(buffer) = &stream.chunks[chunk].buffer {
                    pass.set_vertex_buffer(slot, buffer.slice(..));
                }
            }
            let records = draw.chunk_records(chunk);
            if draw.amplification.is_point_list() {
                draw.pulled(pass, records);
            } else {
                draw.instanced(pass, 1, 0..records);
            }
        }
        draw.chunk_count() as u32
    }
}

impl RecordInstancing for Vertex {
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk {
        Chunk {
            record_count: (records.len() / RECORD_BYTES) as u32,
            bind_group: None,
            buffer: Some(buffer_with(context, wgpu::BufferUsages::VERTEX, records, RECORD_BYTES)),
        }
    }

    fn record_buffer(&self, context: &Context, capacity: usize) -> RecordBuffer {
        RecordBuffer {
            capacity,
            buffer: buffer_for(context, wgpu::BufferUsages::VERTEX, capacity, RECORD_BYTES),
            texture: None,
        }
    }

    fn chunk_in(&self, _context: &Context, record_buffer: &RecordBuffer, record_count: u32) -> Chunk {
        Chunk {
            record_count,
            bind_group: None,
            buffer: Some(record_buffer.buffer.clone()),
        }
    }
}
