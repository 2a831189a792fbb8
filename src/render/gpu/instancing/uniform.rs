//! Strategy `uniform`: records lie in uniform buffers, which every adapter binds up to 64 KiB only.
//!
//! A chunk is one buffer; a draw call binds 4096 records of it by a dynamic offset, so a cloud takes several draws from
//! one upload. The paper found it the fastest of the instancing pipeline on the hardware of its day, where uniform
//! memory had a cache of its own.

use super::binding::{buffer_for, buffer_with, single_binding, single_binding_layout};
use super::record_buffer::RecordBuffer;
use super::strategy::{Instancing, RecordInstancing, StrategyRow};
use super::stream::{Chunk, Draw, RECORD_BYTES};
use crate::render::gpu::constants::BATCH_RECORDS;
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::wgsl::shader_file;

/// Bytes a draw.
const BATCH_BYTES: usize = BATCH_RECORDS as usize * RECORD_BYTES;

pub(super) const ROW: StrategyRow = StrategyRow {
    fetch: [shader_file!("fetch/uniform.wgsl"); 2],
    fetch_corner: None,
    open: |context, _| Box::new(Uniform::new(context)),
};

#[derive(Debug)]
struct Uniform {
    layout: wgpu::BindGroupLayout,
}

impl Uniform {
    fn new(context: &Context) -> Self {
        let ty = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: true,
            min_binding_size: wgpu::BufferSize::new(BATCH_BYTES as u64),
        };
        Self {
            layout: single_binding_layout(context, "uniform stream", ty),
        }
    }
}

impl Instancing for Uniform {
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        Some(&self.layout)
    }

    fn max_chunk_records(&self, context: &Context, _amplification: &'static Amplification) -> usize {
        // Dynamic offsets are u32.
        let bytes = context.limits.max_buffer_size.min(u64::from(u32::MAX));
        let batches = usize::try_from(bytes).unwrap_or(usize::MAX) / BATCH_BYTES;
        batches * BATCH_RECORDS as usize
    }

    fn quads_per_draw(&self, records: u32, amplification: &'static Amplification) -> u32 {
        records.min(BATCH_RECORDS) * amplification.quads_per_record()
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>) -> u32 {
        let mut draw_calls = 0;
        for chunk in 0..draw.chunk_count() {
            let records = draw.chunk_records(chunk);
            for first in (0..records).step_by(BATCH_RECORDS as usize) {
                draw.bind(pass, chunk, &[first * RECORD_BYTES as u32]);
                draw.pulled(pass, BATCH_RECORDS.min(records - first));
                draw_calls += 1;
            }
        }
        draw_calls
    }
}

impl RecordInstancing for Uniform {
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk {
        // The last batch is bound as a whole, so the buffer must extend to its end.
        let buffer = buffer_with(context, wgpu::BufferUsages::UNIFORM, records, BATCH_BYTES);
        self.chunk(context, &buffer, records.len() / RECORD_BYTES)
    }

    fn record_buffer(&self, context: &Context, capacity: usize) -> RecordBuffer {
        RecordBuffer {
            capacity,
            buffer: buffer_for(context, wgpu::BufferUsages::UNIFORM, capacity, BATCH_BYTES),
            texture: None,
        }
    }

    fn chunk_in(&self, context: &Context, record_buffer: &RecordBuffer, record_count: u32) -> Chunk {
        self.chunk(context, &record_buffer.buffer, record_count as usize)
    }
}

impl Uniform {
    fn chunk(&self, context: &Context, buffer: &wgpu::Buffer, record_count: usize) -> Chunk {
        let batch = wgpu::BufferBinding {
            buffer,
            offset: 0,
            size: wgpu::BufferSize::new(BATCH_BYTES as u64),
        };
        Chunk {
            record_count: record_count as u32,
            bind_group: Some(single_binding(
                context,
                &self.layout,
                wgpu::BindingResource::Buffer(batch),
            )),
            buffer: None,
        }
    }
}
