//! Instancing strategies (the 4D media paper §IV): how records reach the vertex stage.
//!
//! A strategy knows one thing: how to bring a *stream* of 16-byte records to the GPU and how to draw from it. It does
//! not know the meaning of a record, nor the render target. Streams longer than the adapter can bind are cut into
//! chunks, each uploaded with one copy and drawn with one call (the uniform strategy: one per batch).
//!
//! Its file has its GPU side: [`StrategyRow`], binding, limits and draw call. Its name is a line of [`Strategy`] in the
//! scene, which knows no GPU. Meshes are drawn in one way, whatever the strategy (`indexed.rs`).

mod binding;
mod compute;
mod indexed;
mod record_buffer;
mod storage;
mod strategy;
mod stream;
mod texture;
mod uniform;
mod vertex;

pub(super) use compute::amplifying_source;
pub(super) use indexed::Indexed;
pub(super) use record_buffer::RecordBuffer;
pub(super) use strategy::{Instancing, RecordInstancing, StrategyRow, upload};
pub(super) use stream::{Chunk, Draw, RECORD_BYTES, Stream, ViewBinding};

use super::primitives::Amplification;
use super::wgsl::ShaderFile;
use crate::scene::Strategy;

/// The files by which the vertex stage gets its corners.
pub(super) fn vertex_files(strategy: Strategy, amplification: &Amplification) -> Vec<ShaderFile> {
    if amplification.is_indexed {
        return [&[indexed::FETCH], amplification.files].concat();
    }
    row(strategy).vertex_files(amplification)
}

/// The table of strategies.
pub(super) fn row(strategy: Strategy) -> &'static StrategyRow {
    match strategy {
        Strategy::Storage => &storage::ROW,
        Strategy::Uniform => &uniform::ROW,
        Strategy::Texture => &texture::ROW,
        Strategy::Vertex => &vertex::ROW,
        Strategy::Compute => &compute::ROW,
    }
}
