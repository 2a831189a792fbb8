//! What every strategy can do.

use super::stream::{Chunk, Draw, RECORD_BYTES, Stream, ViewBinding};
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::scene::Strategy;
use std::fmt;

/// One way to bring records to the vertex stage.
pub(in crate::render::gpu) trait Instancing: fmt::Debug + Send {
    /// Which one.
    fn strategy(&self) -> Strategy;

    /// Layouts of the bind groups after the view's, for geometry pipelines.
    fn group_layouts(&self, amplification: &'static Amplification) -> Vec<&wgpu::BindGroupLayout>;

    /// Layouts of the vertex buffers of geometry pipelines.
    fn vertex_buffers(&self, _amplification: &'static Amplification) -> Vec<wgpu::VertexBufferLayout<'static>> {
        Vec::new()
    }

    /// The most records that one chunk may have.
    fn max_chunk_records(&self, context: &Context, amplification: &'static Amplification) -> usize;

    /// The most quads that one draw call of a chunk with `records` records indexes.
    fn quads_per_draw(&self, records: u32, amplification: &'static Amplification) -> u32 {
        records * amplification.quads_per_record()
    }

    /// One copy: `records` become a chunk.
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk;

    /// Work before a render pass. Returns the number of compute passes.
    fn amplify(
        &mut self,
        _context: &Context,
        _encoder: &mut wgpu::CommandEncoder,
        _view: ViewBinding<'_>,
        _draw: &Draw<'_>,
    ) -> u64 {
        0
    }

    /// Draws all chunks with the pipeline that is set. Returns the number of draw calls.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>) -> u32;
}

/// Cuts `records` into chunks that the strategy and the adapter can hold, and uploads each.
pub(in crate::render::gpu) fn upload(
    instancing: &dyn Instancing,
    context: &Context,
    amplification: &'static Amplification,
    records: &[u8],
) -> Stream {
    let max_records = instancing
        .max_chunk_records(context, amplification)
        .min(context.max_chunk_records.unwrap_or(usize::MAX))
        .max(1);
    Stream {
        chunks: records
            .chunks(max_records * RECORD_BYTES)
            .map(|chunk| instancing.upload(context, chunk))
            .collect(),
        byte_size: records.len() as u64,
    }
}
