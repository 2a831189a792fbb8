//! Instancing strategies (paper 000 §IV): how records reach the vertex stage.
//!
//! A strategy knows one thing: how to bring a *stream* of 16-byte records to the GPU and how to draw from it. It does
//! not know what a record means nor what is drawn into. Streams longer than the adapter can bind are cut into chunks,
//! each uploaded with one copy and drawn with one call (the uniform strategy: one a batch).

mod compute;
mod storage;
mod texture;
mod uniform;
mod vertex;

use super::context::Context;
use super::shaders::Amplification;
use crate::scene::Strategy;
use std::fmt;

/// Size of every record.
pub(super) const RECORD_BYTES: usize = 16;

/// Bind group of the stream of points or voxels; the one after it is the stream of shapes.
pub(super) const STREAM_GROUP: u32 = 1;

/// A sequence of records on the GPU.
#[derive(Debug)]
pub(super) struct Stream {
    pub(super) chunks: Vec<Chunk>,
    pub(super) byte_size: u64,
}

/// As many records as one binding can hold.
#[derive(Debug)]
pub(super) struct Chunk {
    pub(super) record_count: u32,
    /// For strategies that bind.
    bind_group: Option<wgpu::BindGroup>,
    /// For the strategy that feeds vertex attributes.
    buffer: Option<wgpu::Buffer>,
}

/// What is to be drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw<'a> {
    /// Points or voxels, and shapes where the amplification needs them. All have the same chunks.
    pub(super) streams: &'a [&'a Stream],
    pub(super) amplification: Amplification,
    /// Indices 0 1 2 2 1 3, 4 5 6 6 5 7, … for as many quads as [`Instancing::quads_per_draw`] asks for.
    pub(super) quad_indices: &'a wgpu::Buffer,
}

impl Draw<'_> {
    /// Quads that one record becomes; 0 for point lists.
    fn quads_per_record(&self) -> u32 {
        self.amplification.vertices_per_record() / 4
    }

    fn chunk_count(&self) -> usize {
        self.streams
            .iter()
            .map(|stream| stream.chunks.len())
            .min()
            .unwrap_or(0)
    }

    fn chunk_records(&self, chunk: usize) -> u32 {
        self.streams
            .iter()
            .map(|stream| stream.chunks[chunk].record_count)
            .min()
            .unwrap_or(0)
    }

    /// Binds one chunk of every stream.
    fn bind(&self, pass: &mut wgpu::RenderPass<'_>, chunk: usize, offsets: &[wgpu::DynamicOffset]) {
        for (group, stream) in (STREAM_GROUP..).zip(self.streams) {
            pass.set_bind_group(group, stream.chunks[chunk].bind_group.as_ref(), offsets);
        }
    }

    /// Draws `records` records by vertex index, from bound streams.
    fn pulled(&self, pass: &mut wgpu::RenderPass<'_>, records: u32) {
        match self.quads_per_record() {
            0 => pass.draw(0..records, 0..1),
            quads => pass.draw_indexed(0..records * quads * INDICES_PER_QUAD, 0, 0..1),
        }
    }
}

/// Indices of the two triangles of a quad.
pub(super) const INDICES_PER_QUAD: u32 = 6;

/// The view's bind group with the dynamic offset of the pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewBinding<'a> {
    pub(super) bind_group: &'a wgpu::BindGroup,
    pub(super) offset: u32,
}

/// One way to bring records to the vertex stage.
pub(super) trait Instancing: fmt::Debug + Send {
    /// Which one.
    fn strategy(&self) -> Strategy;

    /// Layouts of the bind groups after the view's, for geometry pipelines.
    fn group_layouts(&self, amplification: Amplification) -> Vec<&wgpu::BindGroupLayout>;

    /// Layouts of the vertex buffers of geometry pipelines.
    fn vertex_buffers(
        &self,
        _amplification: Amplification,
    ) -> Vec<wgpu::VertexBufferLayout<'static>> {
        Vec::new()
    }

    /// The most records that one chunk may have.
    fn max_chunk_records(&self, context: &Context, amplification: Amplification) -> usize;

    /// The most quads that one draw call of a chunk with `records` records indexes.
    fn quads_per_draw(&self, records: u32, amplification: Amplification) -> u32 {
        records * amplification.vertices_per_record() / 4
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

/// The strategy's implementation; `view_layout` is the layout of bind group 0.
pub(super) fn new(
    strategy: Strategy,
    context: &Context,
    view_layout: &wgpu::BindGroupLayout,
) -> Box<dyn Instancing> {
    match strategy {
        Strategy::Storage => Box::new(storage::Storage::new(context)),
        Strategy::Uniform => Box::new(uniform::Uniform::new(context)),
        Strategy::Texture => Box::new(texture::Texture::new(context)),
        Strategy::Vertex => Box::new(vertex::Vertex),
        Strategy::Compute => Box::new(compute::Compute::new(context, view_layout)),
    }
}

/// Cuts `records` into chunks that the strategy and the adapter can hold, and uploads each.
pub(super) fn upload(
    instancing: &dyn Instancing,
    context: &Context,
    amplification: Amplification,
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

/// A buffer that holds `records`, padded with zeros to a multiple of `alignment` bytes.
fn buffer_with(
    context: &Context,
    usage: wgpu::BufferUsages,
    records: &[u8],
    alignment: usize,
) -> wgpu::Buffer {
    context.filled_buffer(
        "records",
        usage,
        records,
        records.len().next_multiple_of(alignment),
    )
}

/// A layout with one binding for the vertex stage (and the compute stage, which amplifies).
fn single_binding_layout(
    context: &Context,
    label: &str,
    ty: wgpu::BindingType,
) -> wgpu::BindGroupLayout {
    let stages = if matches!(
        ty,
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { .. },
            ..
        }
    ) {
        wgpu::ShaderStages::VERTEX | wgpu::ShaderStages::COMPUTE
    } else {
        wgpu::ShaderStages::VERTEX
    };
    context
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: stages,
                ty,
                count: None,
            }],
        })
}

/// The bind group of a [`single_binding_layout`].
fn single_binding(
    context: &Context,
    layout: &wgpu::BindGroupLayout,
    resource: wgpu::BindingResource<'_>,
) -> wgpu::BindGroup {
    context
        .device
        .create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("records"),
            layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource,
            }],
        })
}

/// One copy of the stream's layout for each stream that the amplification reads.
fn stream_layouts(
    layout: &wgpu::BindGroupLayout,
    amplification: Amplification,
) -> Vec<&wgpu::BindGroupLayout> {
    vec![layout; 1 + usize::from(amplification.needs_shapes())]
}

/// Limit of a draw call: indices are u32 and so is their count.
const MAX_INDEXED_QUADS: usize = (u32::MAX / INDICES_PER_QUAD) as usize;

/// The most records whose quads one draw call can index, with an index buffer that the adapter can hold.
fn max_indexed_records(context: &Context, amplification: Amplification) -> usize {
    let quads = (amplification.vertices_per_record() as usize / 4).max(1);
    let index_bytes = (INDICES_PER_QUAD as usize) * size_of::<u32>();
    let buffer_quads =
        usize::try_from(context.limits.max_buffer_size).unwrap_or(usize::MAX) / index_bytes;
    MAX_INDEXED_QUADS.min(buffer_quads) / quads
}
