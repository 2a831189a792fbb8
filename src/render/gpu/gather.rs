//! Selected nodes of a structure whose records are resident: a compute pass brings them together.
//!
//! **How it works.** The records of all nodes lie in storage buffers. A view uploads the places of its nodes (four
//! bytes each), and one pass copies their records to where the strategy has its own: a storage, uniform or vertex
//! buffer, or one that becomes a texture. So shaders and draw calls are those of any other cloud, whatever the strategy,
//! and so is every byte of the picture.
//!
//! **Why not by an index in the vertex stage.** Uniform buffers are bound 64 KiB at a time, and attributes that are
//! stepped per instance come in the order of memory: two of five strategies could not. The others would read an index
//! for each of the four to twelve vertices of a record, and have twice as many shaders. The copy costs 64 bytes of the
//! GPU's own memory a record, once a view.

use super::constants::{self, GATHER_GROUP, GROUP_RECORDS};
use super::context::Context;
use super::gpu_data::Gathering;
use super::instancing::{Chunk, RECORD_BYTES, RecordInstancing, Room, Stream};
use super::primitives::Amplification;
use super::recording::Recording;
use super::residency::{Residency, StreamKey};
use crate::levels::Selection;
use std::sync::Arc;

/// A chunk has room for this many times as many records as it needs, at most.
const MOST_ROOM: usize = 4;

/// The WGSL of the pass.
pub(super) fn source() -> String {
    [
        constants::shared().as_str(),
        include_str!("../../../shaders/passes/gather.wgsl"),
    ]
    .join("\n")
}

/// Gathers the records of one selection at a time.
#[derive(Debug)]
pub(super) struct Gatherer {
    layout: wgpu::BindGroupLayout,
    pipeline: Option<wgpu::ComputePipeline>,
    places: Option<wgpu::Buffer>,
    gathered: Option<Gathered>,
}

/// The records of a selection, or room for them.
#[derive(Debug)]
struct Gathered {
    selection: Arc<Selection>,
    nodes: Vec<StreamKey>,
    streams: Vec<Stream>,
    /// Of each chunk of each stream.
    rooms: Vec<Vec<Room>>,
    is_outdated: bool,
}

/// What is selected from what.
#[derive(Debug, Clone, Copy)]
pub(super) struct Selected<'a> {
    pub(super) selection: &'a Arc<Selection>,
    /// Resident records of all nodes.
    pub(super) nodes: &'a [StreamKey],
    pub(super) chunked_for: &'static Amplification,
}

impl Gatherer {
    pub(super) fn new(context: &Context) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let entries = [
            entry(0, wgpu::BufferBindingType::Uniform),
            entry(1, storage(true)),
            entry(2, storage(true)),
            entry(3, storage(false)),
        ];
        Self {
            layout: context
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some("gather"),
                    entries: &entries,
                }),
            pipeline: None,
            places: None,
            gathered: None,
        }
    }

    /// Whether one binding holds so many records.
    pub(super) fn can_hold(context: &Context, records: usize) -> bool {
        let limits = &context.limits;
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        (records * RECORD_BYTES) as u64 <= bytes
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

    /// Forgets what was gathered: another strategy lays records out otherwise.
    pub(super) fn clear(&mut self) {
        self.gathered = None;
    }

    /// Uploads which records are selected, and makes room for them. Returns the bytes uploaded.
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
        let mut rooms = self.gathered.take().map_or_else(Vec::new, |gathered| gathered.rooms);
        rooms.resize_with(nodes.len(), Vec::new);
        for rooms in &mut rooms {
            streams.push(make_room(context, instancing, selected, rooms));
        }
        self.gathered = Some(Gathered {
            selection: Arc::clone(selection),
            nodes: nodes.to_vec(),
            streams,
            rooms,
            is_outdated: true,
        });
        uploaded_bytes
    }

    fn upload_places(&mut self, context: &Context, selection: &Selection) -> u64 {
        let Selection::At(places) = selection else { return 0 };
        let bytes: &[u8] = bytemuck::cast_slice(places);
        let needed = bytes.len() as u64;
        let fits = |buffer: &wgpu::Buffer| buffer.size() >= needed && buffer.size() <= (needed + 1) * MOST_ROOM as u64;
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

    /// What is drawn of the selection.
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
        let (layout, places) = (&self.layout, self.places.as_ref());
        let pipeline = self.pipeline.get_or_insert_with(|| pipeline(context, layout));
        let mut pass = recording.begin_compute("gather");
        pass.set_pipeline(pipeline);
        for (stream, (key, rooms)) in gathered.nodes.iter().zip(&gathered.rooms).enumerate() {
            let Some(nodes) = residency.get(*key).and_then(Stream::to_gather_from) else {
                continue;
            };
            let mut first = 0;
            for (chunk, room) in gathered.streams[stream].chunks.iter().zip(rooms) {
                // The first stream has no radii.
                let scales_radii = stream > 0;
                let gathering = Gathering::of(&gathered.selection, first..first + chunk.record_count, scales_radii);
                let group = bind_group(
                    context,
                    layout,
                    &gathering,
                    [places.unwrap_or(nodes), nodes, &room.buffer],
                );
                pass.set_bind_group(GATHER_GROUP, &group, &[]);
                let most = context.limits.max_compute_workgroups_per_dimension;
                pass.dispatch_workgroups(chunk.record_count.div_ceil(GROUP_RECORDS).min(most), 1, 1);
                first += chunk.record_count;
            }
        }
        drop(pass);
        for room in gathered.rooms.iter().flatten() {
            room.copy_to_texture(recording);
        }
        1
    }
}

/// Chunks for all records of a selection, in rooms that are large enough.
fn make_room(
    context: &Context,
    instancing: &dyn RecordInstancing,
    selected: Selected<'_>,
    rooms: &mut Vec<Room>,
) -> Stream {
    let count = selected.selection.len();
    let most = instancing.most_records(context, selected.chunked_for);
    let mut chunks = Vec::new();
    let mut kept = std::mem::take(rooms).into_iter();
    for first in (0..count).step_by(most) {
        let needed = most.min(count - first);
        let fits = |room: &Room| (needed..=MOST_ROOM * needed).contains(&room.capacity);
        let room = kept.next().filter(fits);
        let room = room.unwrap_or_else(|| instancing.room(context, needed.next_power_of_two().min(most)));
        chunks.push(instancing.chunk_in(context, &room, needed as u32));
        rooms.push(room);
    }
    Stream {
        chunks,
        byte_size: (count * RECORD_BYTES) as u64,
    }
}

fn pipeline(context: &Context, layout: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
    let label = Some("gather");
    let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label,
        source: wgpu::ShaderSource::Wgsl(source().into()),
    });
    let layout = context.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    context
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("gather"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
}

/// The places, the nodes and where these go, in the order of their bindings.
fn bind_group(
    context: &Context,
    layout: &wgpu::BindGroupLayout,
    gathering: &Gathering,
    buffers: [&wgpu::Buffer; 3],
) -> wgpu::BindGroup {
    let bytes = bytemuck::bytes_of(gathering);
    let uniform = context.filled_buffer("gathering", wgpu::BufferUsages::UNIFORM, bytes, bytes.len());
    let [places, nodes, room] = buffers;
    let entries: Vec<_> = (0..)
        .zip([&uniform, places, nodes, room])
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    context.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("gather"),
        layout,
        entries: &entries,
    })
}
