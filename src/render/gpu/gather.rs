//! Selected nodes of a structure whose records are resident: a compute pass brings them together.
//!
//! **How it works.** The records of all nodes lie in storage buffers. A view uploads the places of its nodes (four
//! bytes each), and one pass copies their records to where the strategy has its own: a storage, uniform or vertex
//! buffer, or one that becomes a texture. So shaders and draw calls are the same as for any other cloud, whatever the
//! strategy, and so is every byte of the image.
//!
//! For a sequential point tree there are no places: the pass tests each candidate (`passes/filter.wgsl`) and gives
//! undrawn ones a radius by which `compute` drops them, while other strategies draw only a point without extent.
//! Bisection has found the candidates, and the rule is a uniform.
//!
//! **Why not by an index in the vertex stage.** Uniform buffers are bound 64 KiB at a time, and attributes that are
//! stepped per instance come in the order of memory: two of five strategies could not. The others would read an index
//! for each of the four to twelve vertices of a record, and have twice as many shaders. The copy costs 64 bytes of the
//! GPU's own memory per record, once per view.

use super::context::Context;
use super::gather_program::{FILTER, GATHER, Program, bind_group, dispatch};
use super::gpu_data::{Filtering, Gathering};
use super::instancing::{Chunk, RECORD_BYTES, RecordBuffer, RecordInstancing, Stream};
use super::primitives::Amplification;
use super::record_buffers::{MAX_OVERSIZE, stream_in};
use super::recording::Recording;
use super::residency::{Residency, StreamKey};
use crate::levels::Selection;
use std::sync::Arc;

/// Streams of records: points, then shapes. Others follow, by which nodes are tested.
const RECORD_STREAMS: usize = 2;

/// Gathers the records of one selection at a time.
#[derive(Debug)]
pub(super) struct Gatherer {
    gather: Program,
    filter: Program,
    places: Option<wgpu::Buffer>,
    gathered: Option<Gathered>,
}

/// The records of a selection, or a buffer for them.
#[derive(Debug)]
struct Gathered {
    selection: Arc<Selection>,
    nodes: Vec<StreamKey>,
    streams: Vec<Stream>,
    /// Allocated buffers of each chunk of each stream.
    record_buffers: Vec<Vec<RecordBuffer>>,
    is_outdated: bool,
}

/// Selection of records, with the nodes that it selects from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Selected<'a> {
    pub(super) selection: &'a Arc<Selection>,
    /// Resident records of all nodes.
    pub(super) nodes: &'a [StreamKey],
    pub(super) chunked_for: &'static Amplification,
}

impl Gatherer {
    pub(super) fn new() -> Self {
        Self {
            gather: Program::new(GATHER),
            filter: Program::new(FILTER),
            places: None,
            gathered: None,
        }
    }

    /// Returns true if a single binding can hold the given number of bytes.
    pub(super) fn can_hold(context: &Context, bytes: usize) -> bool {
        bytes as u64 <= context.max_storage_bytes()
    }

    /// The records of all nodes as a stream to gather from.
    pub(super) fn upload_nodes(context: &Context, records: &[u8]) -> Stream {
        let buffer = context.filled_buffer(
            "nodes",
            wgpu::BufferUsages::STORAGE,
            records,
            records.len().max(RECORD_BYTES),
        );
        Stream {
            chunks: vec![Chunk::to_gather_from((records.len() / RECORD_BYTES) as u32, buffer)],
            byte_size: records.len() as u64,
        }
    }

    /// Discards the gathered records, which another strategy lays out differently, and all buffers: some may be invalid
    /// after a failed allocation.
    pub(super) fn clear(&mut self) {
        (self.gathered, self.places) = (None, None);
    }

    /// Uploads the selection of records, and allocates space for them. Returns the bytes uploaded.
    pub(super) fn ensure(
        &mut self,
        context: &Context,
        instancing: &dyn RecordInstancing,
        selected: Selected<'_>,
    ) -> u64 {
        let Selected { selection, nodes, .. } = selected;
        let is_known =
            |gathered: &Gathered| Arc::ptr_eq(&gathered.selection, selection) && gathered.nodes.as_slice() == nodes;
        if self.gathered.as_ref().is_some_and(is_known) {
            return 0;
        }
        let uploaded_bytes = self.upload_places(context, selection);
        let mut streams = Vec::new();
        let mut record_buffers = self
            .gathered
            .take()
            .map_or_else(Vec::new, |gathered| gathered.record_buffers);
        record_buffers.resize_with(RECORD_STREAMS.min(nodes.len()), Vec::new);
        for record_buffers in &mut record_buffers {
            streams.push(stream_in(
                context,
                instancing,
                selection.len(),
                selected.chunked_for,
                record_buffers,
            ));
        }
        self.gathered = Some(Gathered {
            selection: Arc::clone(selection),
            nodes: nodes.to_vec(),
            streams,
            record_buffers,
            is_outdated: true,
        });
        uploaded_bytes
    }

    fn upload_places(&mut self, context: &Context, selection: &Selection) -> u64 {
        let Selection::At(places) = selection else { return 0 };
        let bytes: &[u8] = bytemuck::cast_slice(places);
        let needed = bytes.len() as u64;
        let fits =
            |buffer: &wgpu::Buffer| buffer.size() >= needed && buffer.size() <= (needed + 1) * MAX_OVERSIZE as u64;
        if !self.places.as_ref().is_some_and(fits) {
            self.places = Some(context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("places of nodes"),
                size: needed.next_power_of_two().max(RECORD_BYTES as u64),
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.places {
            context.queue.write_buffer(buffer, 0, bytes);
        }
        needed
    }

    /// Returns the streams to draw for the selection.
    pub(super) fn streams(&self) -> Vec<&Stream> {
        self.gathered
            .as_ref()
            .map_or_else(Vec::new, |gathered| gathered.streams.iter().collect())
    }

    /// Records the pass, unless the records are there. Returns the number of passes.
    pub(super) fn record(&mut self, recording: &mut Recording<'_>, residency: &Residency) -> u64 {
        let Some(gathered) = self.gathered.as_mut().filter(|gathered| gathered.is_outdated) else {
            return 0;
        };
        gathered.is_outdated = false;
        if gathered.selection.is_empty() {
            return 0;
        }
        let context = recording.context;
        let is_filtered = matches!(*gathered.selection, Selection::Filtered(_));
        let program = if is_filtered {
            &mut self.filter
        } else {
            &mut self.gather
        };
        let label = program.shader.label;
        let programs = program.made(context);
        let (nodes, of_test) = gathered.nodes.split_at(gathered.record_buffers.len());
        let buffer = |key: &StreamKey| residency.get(*key).and_then(Stream::to_gather_from);
        let mut pass = recording.begin_compute(label);
        for (stream, (key, record_buffers)) in nodes.iter().zip(&gathered.record_buffers).enumerate() {
            let Some(nodes) = buffer(key) else { continue };
            let mut first = 0;
            for (chunk, record_buffer) in gathered.streams[stream].chunks.iter().zip(record_buffers) {
                let records = first..first + chunk.record_count;
                first = records.end;
                // The first stream has no radii.
                let has_radii = stream > 0;
                let group = match &*gathered.selection {
                    Selection::Filtered(filter) => {
                        let [Some(bounds), Some(parents)] =
                            [of_test.first(), of_test.get(1)].map(|key| key.and_then(buffer))
                        else {
                            continue;
                        };
                        let filtering = Filtering::of(filter, records, has_radii);
                        let buffers = [parents, nodes, &record_buffer.buffer, bounds];
                        bind_group(programs, context, bytemuck::bytes_of(&filtering), &buffers)
                    }
                    selection => {
                        let gathering = Gathering::of(selection, records, has_radii);
                        let buffers = [self.places.as_ref().unwrap_or(nodes), nodes, &record_buffer.buffer];
                        bind_group(programs, context, bytemuck::bytes_of(&gathering), &buffers)
                    }
                };
                dispatch(programs, context, &mut pass, &group, chunk.record_count);
            }
        }
        drop(pass);
        for record_buffer in gathered.record_buffers.iter().flatten() {
            record_buffer.copy_to_texture(recording);
        }
        1
    }
}
