//! Interface of the instancing strategies.

use super::record_buffer::RecordBuffer;
use super::stream::{Chunk, Draw, RECORD_BYTES, Stream, ViewBinding};
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::recording::Recording;
use crate::render::gpu::wgsl::ShaderFile;
use std::{fmt, iter};

/// A row of the [table of strategies](super::row).
#[derive(Debug)]
pub(in crate::render::gpu) struct StrategyRow {
    /// Files of `shaders/fetch/` by which the vertex stage gets a record: where it reads no shapes, and where it does.
    pub(super) fetch: [ShaderFile; 2],
    /// The file by which it gets a corner that a compute pass has written, of strategies with such a pass.
    pub(super) fetch_corner: Option<ShaderFile>,
    /// Makes it; the layout is the view's bind group's.
    pub(in crate::render::gpu) open: fn(&Context, &wgpu::BindGroupLayout) -> Box<dyn RecordInstancing>,
}

impl StrategyRow {
    /// The files that make corners of records.
    pub(super) fn amplifying_files(&self, amplification: &Amplification) -> Vec<ShaderFile> {
        let fetch = self.fetch[usize::from(amplification.reads_shapes)];
        iter::once(fetch).chain(amplification.files.iter().copied()).collect()
    }

    /// The files by which the vertex stage gets its corners.
    pub(super) fn vertex_files(&self, amplification: &Amplification) -> Vec<ShaderFile> {
        match self.fetch_corner {
            Some(fetch_corner) if amplification.compute_amplifies => vec![fetch_corner],
            _ => self.amplifying_files(amplification),
        }
    }
}

/// A method of bringing records to the vertex stage.
pub(in crate::render::gpu) trait Instancing: fmt::Debug + Send {
    /// Layout of the bind group of one stream, for strategies that bind.
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout>;

    /// Layouts of the bind groups after the view's, for geometry pipelines: one for each stream.
    fn group_layouts(&self, amplification: &'static Amplification) -> Vec<&wgpu::BindGroupLayout> {
        let streams = 1 + usize::from(amplification.reads_shapes);
        iter::repeat_n(self.stream_layout(), streams).flatten().collect()
    }

    /// Layouts of the vertex buffers of geometry pipelines.
    fn vertex_buffers(&self, _amplification: &'static Amplification) -> Vec<wgpu::VertexBufferLayout<'static>> {
        Vec::new()
    }

    /// The maximum number of records of one chunk.
    fn max_chunk_records(&self, context: &Context, amplification: &'static Amplification) -> usize;

    /// The maximum number of quads that one draw call of a chunk with `records` records indexes.
    fn quads_per_draw(&self, records: u32, amplification: &'static Amplification) -> u32 {
        records * amplification.quads_per_record()
    }

    /// Work before a render pass. Returns the number of compute passes.
    fn amplify(&mut self, _recording: &mut Recording<'_>, _view: ViewBinding<'_>, _draw: &Draw<'_>) -> u64 {
        0
    }

    /// Draws all chunks with the pipeline that is set. Returns the number of draw calls.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>) -> u32 {
        for chunk in 0..draw.chunk_count() {
            draw.bind(pass, chunk, &[]);
            draw.pulled(pass, draw.chunk_records(chunk));
        }
        draw.chunk_count() as u32
    }
}

/// A strategy that brings streams of records, each read in place.
pub(in crate::render::gpu) trait RecordInstancing: Instancing {
    /// One copy: `records` become a chunk.
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk;

    /// A buffer for a chunk of this many records.
    fn record_buffer(&self, context: &Context, capacity: usize) -> RecordBuffer;

    /// The chunk of this many records in a buffer. Precondition: they fit.
    fn chunk_in(&self, context: &Context, record_buffer: &RecordBuffer, record_count: u32) -> Chunk;

    /// The maximum number of records of a chunk that the strategy and the adapter can hold, at least one.
    fn max_records(&self, context: &Context, amplification: &'static Amplification) -> usize {
        self.max_chunk_records(context, amplification)
            .min(context.max_chunk_records.unwrap_or(usize::MAX))
            .max(1)
    }
}

/// Cuts `records` into chunks that the strategy and the adapter can hold, and uploads each.
pub(in crate::render::gpu) fn upload(
    instancing: &dyn RecordInstancing,
    context: &Context,
    amplification: &'static Amplification,
    records: &[u8],
) -> Stream {
    let max_records = instancing.max_records(context, amplification);
    Stream {
        chunks: records
            .chunks(max_records * RECORD_BYTES)
            .map(|chunk| instancing.upload(context, chunk))
            .collect(),
        byte_size: records.len() as u64,
    }
}
