//! Surfels drawn from the byte code of an octree: compute passes traverse it and decode the nodes that are drawn
//! (Botsch et al. 2002, on a GPU).
//!
//! **How it works.** The GPU holds the code and its attributes as they are stored, 8 bytes per node and some bits. A
//! view uploads uniforms alone. Passes go down the tree level by level (`shaders/coded/expand.wgsl`): all nodes of a
//! level that may be seen are tested at once, and those that are too large on the screen write their children into the
//! queue of the next level, whose dispatch the GPU sizes by itself. A last pass writes the records of the drawn nodes
//! to where the strategy has its own, as for visible points (`visible/mod.rs`): shaders and draw calls are the same as
//! for any other cloud.
//!
//! The CPU does not learn the number of drawn nodes: there is space for all of the deepest level, and records beyond
//! the drawn ones have the radius by which `compute` drops them and other strategies draw nothing.
//!
//! **When it wins.** A frame takes a third to a half of the GPU memory that its records take and is uploaded once for
//! all levels of detail; a view needs no traversal on the CPU and no upload. What it costs: positions are those of
//! cells, moved along normals; 88 bytes for each node of the deepest level, once, for queues and records; and all of
//! those records pass the vertex stage, however few nodes are drawn.

mod passes;
mod record;
mod scratch;
#[cfg(test)]
mod tests;

pub(super) use passes::SHADER;

use super::compute::ComputePrograms;
use super::context::Context;
use super::gpu_data::Expanding;
use super::instancing::{Chunk, RecordBuffer, RecordInstancing, Stream};
use super::primitives::Amplification;
use super::record_buffers::stream_in;
use super::recording::Recording;
use super::residency::{Residency, StreamKey};
use crate::levels::octree::CodedCloud;
use crate::levels::octree::coded::CodeView;
use crate::scene::CodedCells;
use record::{Expanded, expand, write};
use scratch::Scratch;
use std::sync::Arc;

/// Points, and their shapes.
const STREAMS: usize = 2;

/// Decodes the nodes of one view at a time.
#[derive(Debug, Default)]
pub(super) struct CodeExpander {
    programs: Option<ComputePrograms>,
    tables: Option<Tables>,
    scratch: Option<Scratch>,
    made: Option<Made>,
}

/// Tables of attributes, for a number of bits of normals.
#[derive(Debug)]
struct Tables {
    normal_bits: u32,
    buffer: wgpu::Buffer,
}

/// Records of drawn nodes, or buffers for them.
#[derive(Debug)]
struct Made {
    of: Arc<CodedCloud>,
    view: CodeView,
    code: StreamKey,
    streams: Vec<Stream>,
    /// Allocated buffers of each chunk of each stream.
    record_buffers: Vec<Vec<RecordBuffer>>,
    is_outdated: bool,
}

/// A byte code in a view.
#[derive(Debug, Clone, Copy)]
pub(super) struct CodeInView<'a> {
    pub(super) cells: &'a CodedCells,
    pub(super) view: CodeView,
}

/// Request for the records of a byte code, which is resident.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'a> {
    pub(super) code: CodeInView<'a>,
    pub(super) stream: StreamKey,
    pub(super) chunked_for: &'static Amplification,
}

impl CodeExpander {
    /// Returns true if the adapter's limits are large enough.
    pub(super) fn can_hold(context: &Context, cells: &CodedCells) -> bool {
        let [.., words] = cells.cloud.word_starts();
        let bytes = (words * size_of::<u32>()) as u64;
        bytes <= context.max_storage_bytes() && scratch::fits(context, cells.deepest_nodes())
    }

    /// The code as a stream to decode from.
    pub(super) fn upload(context: &Context, cloud: &CodedCloud) -> Stream {
        let words = cloud.words();
        let bytes: &[u8] = bytemuck::cast_slice(&words);
        let buffer = context.filled_buffer("byte code", wgpu::BufferUsages::STORAGE, bytes, bytes.len());
        Stream {
            chunks: vec![Chunk::to_gather_from(0, buffer)],
            byte_size: bytes.len() as u64,
        }
    }

    /// Discards the records, which another strategy lays out differently, and all buffers: some may be invalid after a
    /// failed allocation.
    pub(super) fn clear(&mut self) {
        (self.made, self.scratch, self.tables) = (None, None, None);
    }

    /// Makes the records again for the same view, for benchmarks.
    pub(super) fn invalidate(&mut self) {
        if let Some(made) = &mut self.made {
            made.is_outdated = true;
        }
    }

    /// Allocates space for all nodes that the view could show.
    pub(super) fn ensure(&mut self, context: &Context, instancing: &dyn RecordInstancing, wanted: Wanted<'_>) {
        let Wanted {
            code: CodeInView { cells, view },
            stream,
            ..
        } = wanted;
        let is_known = |made: &Made| Arc::ptr_eq(&made.of, &cells.cloud) && made.view == view && made.code == stream;
        if self.made.as_ref().is_some_and(is_known) {
            return;
        }
        self.programs
            .get_or_insert_with(|| ComputePrograms::new(context, SHADER));
        if self
            .tables
            .as_ref()
            .is_none_or(|tables| tables.normal_bits != view.normal_bits)
        {
            self.tables = Some(Tables::new(context, &view));
        }
        let nodes = cells.deepest_nodes();
        let mut record_buffers = self.made.take().map_or_else(Vec::new, |made| made.record_buffers);
        record_buffers.resize_with(STREAMS, Vec::new);
        let streams = record_buffers
            .iter_mut()
            .map(|record_buffers| stream_in(context, instancing, nodes, wanted.chunked_for, record_buffers))
            .collect();
        self.scratch = Some(Scratch::for_nodes(context, self.scratch.take(), nodes));
        self.made = Some(Made {
            of: Arc::clone(&cells.cloud),
            view,
            code: stream,
            streams,
            record_buffers,
            is_outdated: true,
        });
    }

    /// Returns the streams to draw.
    pub(super) fn streams(&self) -> Vec<&Stream> {
        self.made
            .as_ref()
            .map_or_else(Vec::new, |made| made.streams.iter().collect())
    }

    /// Records the passes, unless the records are there. Returns the number of passes.
    pub(super) fn record(&mut self, recording: &mut Recording<'_>, residency: &Residency) -> u64 {
        let (Some(programs), Some(tables), Some(scratch)) = (&self.programs, &self.tables, &self.scratch) else {
            return 0;
        };
        let Some(made) = self.made.as_mut().filter(|made| made.is_outdated) else {
            return 0;
        };
        made.is_outdated = false;
        let code = residency.get(made.code).and_then(Stream::to_gather_from);
        // Without nodes there is no root to begin with.
        let Some(code) = code.filter(|_| !made.of.attributes().is_empty()) else {
            return 0;
        };
        let [points, shapes] = [0, 1].map(|stream| made.record_buffers[stream].iter());
        let chunks = made.streams[0].chunks.iter().zip(points.zip(shapes));
        let chunks = chunks.map(|(chunk, (points, shapes))| record::Output {
            records: chunk.record_count,
            points: &points.buffer,
            shapes: &shapes.buffer,
        });
        let expanded = Expanded {
            programs,
            scratch,
            code,
            tables: &tables.buffer,
        };
        let deepest = made.view.deepest_level.min(made.of.depth());
        let uniforms = Expanding::of_levels(&made.of, &made.view, deepest);
        expand(recording, &expanded, &uniforms);
        write(recording, &expanded, &uniforms[0], chunks);
        for record_buffer in made.record_buffers.iter().flatten() {
            record_buffer.copy_to_texture(recording);
        }
        2
    }
}

impl Tables {
    fn new(context: &Context, view: &CodeView) -> Self {
        let words = passes::tables(view);
        let bytes: &[u8] = bytemuck::cast_slice(&words);
        Self {
            normal_bits: view.normal_bits,
            buffer: context.filled_buffer("byte code tables", wgpu::BufferUsages::STORAGE, bytes, bytes.len()),
        }
    }
}
