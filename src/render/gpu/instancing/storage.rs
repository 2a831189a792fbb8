//! Strategy `storage`: records lie in storage buffers, the vertex stage pulls them by index.
//!
//! One draw call indexes the quads of all records, 4 vertices each, instead of drawing one small instance per record:
//! this fills whole waves of a GPU, and a software rasteriser sets up one draw instead of thousands of instances. It
//! wins nearly everywhere and has no limits that matter, so it is the default.

use super::binding::{buffer_for, buffer_with, max_indexed_records, records_of, single_binding, single_binding_layout};
use super::record_buffer::RecordBuffer;
use super::strategy::{Instancing, RecordInstancing, StrategyRow};
use super::stream::{Chunk, RECORD_BYTES};
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::wgsl::shader_file;

pub(super) const ROW: StrategyRow = StrategyRow {
    fetch: [shader_file!("fetch/storage.wgsl"); 2],
    fetch_corner: None,
    open: |context, _| Box::new(Storage::new(context)),
};

#[derive(Debug)]
pub(super) struct Storage {
    /// Bind group layout of one stream; the compute strategy reads the same.
    pub(super) layout: wgpu::BindGroupLayout,
}

impl Storage {
    pub(super) fn new(context: &Context) -> Self {
        let ty = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        Self {
            layout: single_binding_layout(context, "storage stream", ty),
        }
    }
}

impl Storage {
    fn chunk(&self, context: &Context, buffer: &wgpu::Buffer, record_count: usize) -> Chunk {
        // The buffer may be larger: compute passes derive the number of records from the bound size.
        let records = wgpu::BufferBinding {
            buffer,
            offset: 0,
            size: wgpu::BufferSize::new((record_count * RECORD_BYTES) as u64),
        };
        Chunk {
            record_count: record_count as u32,
            bind_group: Some(single_binding(
                context,
                &self.layout,
                wgpu::BindingResource::Buffer(records),
            )),
            buffer: None,
        }
    }
}

impl Instancing for Storage {
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        Some(&self.layout)
    }

    fn max_chunk_records(&self, context: &Context, amplification: &'static Amplification) -> usize {
        let bytes = context
            .limits
            .max_storage_buffer_binding_size
            .min(context.limits.max_buffer_size);
        records_of(bytes).min(max_indexed_records(context, amplification))
    }
}

impl RecordInstancing for Storage {
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk {
        let buffer = buffer_with(context, wgpu::BufferUsages::STORAGE, records, RECORD_BYTES);
        self.chunk(context, &buffer, records.len() / RECORD_BYTES)
    }

    fn record_buffer(&self, context: &Context, capacity: usize) -> RecordBuffer {
        RecordBuffer {
            capacity,
            buffer: buffer_for(context, wgpu::BufferUsages::STORAGE, capacity, RECORD_BYTES),
            texture: None,
        }
    }

    fn chunk_in(&self, context: &Context, record_buffer: &RecordBuffer, record_count: u32) -> Chunk {
        self.chunk(context, &record_buffer.buffer, record_count as usize)
    }
}
