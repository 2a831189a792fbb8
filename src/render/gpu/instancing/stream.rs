//! Streams of records on the GPU, and their drawing.

use crate::render::gpu::constants::STREAM_GROUP;
use crate::render::gpu::primitives::Amplification;
use std::ops::Range;

/// Size of every record.
pub(in crate::render::gpu) const RECORD_BYTES: usize = 16;

/// A sequence of records on the GPU.
#[derive(Debug)]
pub(in crate::render::gpu) struct Stream {
    pub(in crate::render::gpu) chunks: Vec<Chunk>,
    pub(in crate::render::gpu) byte_size: u64,
}

/// Records that fit in one binding.
#[derive(Debug, Clone)]
pub(in crate::render::gpu) struct Chunk {
    pub(in crate::render::gpu) record_count: u32,
    /// For strategies that bind.
    pub(super) bind_group: Option<wgpu::BindGroup>,
    /// For the strategy that feeds vertex attributes.
    pub(super) buffer: Option<wgpu::Buffer>,
}

impl Chunk {
    /// Records that are gathered from, not drawn.
    pub(in crate::render::gpu) fn to_gather_from(record_count: u32, buffer: wgpu::Buffer) -> Self {
        Self {
            record_count,
            bind_group: None,
            buffer: Some(buffer),
        }
    }
}

impl Stream {
    /// The records that are gathered from.
    pub(in crate::render::gpu) fn to_gather_from(&self) -> Option<&wgpu::Buffer> {
        self.chunks.first()?.buffer.as_ref()
    }
}

/// Inputs of a draw call.
pub(in crate::render::gpu) struct Draw<'a> {
    /// Points or voxels, and shapes where the amplification needs them. All have the same chunks.
    pub(in crate::render::gpu) streams: &'a [&'a Stream],
    pub(in crate::render::gpu) amplification: &'static Amplification,
    /// Indices 0 1 2 2 1 3, 4 5 6 6 5 7, … for the number of quads in [`Instancing::quads_per_draw`].
    pub(in crate::render::gpu) quad_indices: &'a wgpu::Buffer,
}

impl Draw<'_> {
    /// Number of records of one stream: the other streams have the same.
    pub(in crate::render::gpu) fn record_count(&self) -> u64 {
        let chunks = self.streams.first().map(|stream| &stream.chunks);
        let records = chunks.into_iter().flatten().map(|chunk| chunk.record_count);
        records.map(u64::from).sum()
    }

    pub(super) fn chunk_count(&self) -> usize {
        self.streams.iter().map(|stream| stream.chunks.len()).min().unwrap_or(0)
    }

    pub(super) fn chunk_records(&self, chunk: usize) -> u32 {
        self.streams
            .iter()
            .map(|stream| stream.chunks[chunk].record_count)
            .min()
            .unwrap_or(0)
    }

    /// Binds one chunk of every stream.
    pub(super) fn bind(&self, pass: &mut wgpu::RenderPass<'_>, chunk: usize, offsets: &[wgpu::DynamicOffset]) {
        for (group, stream) in (STREAM_GROUP..).zip(self.streams) {
            pass.set_bind_group(group, stream.chunks[chunk].bind_group.as_ref(), offsets);
        }
    }

    /// Draws `records` records by vertex index, from bound streams.
    pub(super) fn pulled(&self, pass: &mut wgpu::RenderPass<'_>, records: u32) {
        // One indexed draw of all quads, not one small instance per record: only `vertex` needs hardware instancing.
        self.instanced(pass, records, 0..1);
    }

    /// Draws instances with the vertices of this many records each.
    pub(super) fn instanced(&self, pass: &mut wgpu::RenderPass<'_>, records: u32, instances: Range<u32>) {
        let drawn = 0..records * self.amplification.drawn_per_record();
        match self.amplification.quads_per_record() {
            0 => pass.draw(drawn, instances),
            _ => pass.draw_indexed(drawn, 0, instances),
        }
    }
}

/// The view's bind group with the dynamic offset of the pass.
#[derive(Debug, Clone, Copy)]
pub(in crate::render::gpu) struct ViewBinding<'a> {
    pub(in crate::render::gpu) bind_group: &'a wgpu::BindGroup,
    pub(in crate::render::gpu) offset: u32,
}
