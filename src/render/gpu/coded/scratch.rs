//! Scratch buffers that passes hand on to those after them.

use super::passes::{DRAWN_NODES, FOUND, GROUPS, PLACES, SUMS};
use crate::render::gpu::constants::GROUP_RECORDS;
use crate::render::gpu::context::Context;
use crate::render::gpu::record_buffers::MAX_OVERSIZE;
use wgpu::BufferUsages as Usages;

/// Bytes of a node, of two counts, of `Found`, and of the size of a dispatch in `coded/code.wgsl`.
const NODE_BYTES: u64 = 16;
const COUNTS_BYTES: u64 = 8;
pub(super) const FOUND_BYTES: u64 = 16;
pub(super) const DISPATCH_BYTES: u64 = 16;

/// Buffers for nodes of one level.
#[derive(Debug)]
pub(super) struct Scratch {
    /// Two queues, each of which is the other's next.
    queues: [wgpu::Buffer; 2],
    places: wgpu::Buffer,
    sums: wgpu::Buffer,
    found: wgpu::Buffer,
    groups: wgpu::Buffer,
    drawn_nodes: wgpu::Buffer,
    capacity: u64,
}

/// Returns true if the adapter's limits allow binding buffers for this number of nodes, and dispatching the required
/// number of workgroups at once: 65,535 are about 16 million nodes.
pub(super) fn fits(context: &Context, nodes: usize) -> bool {
    let groups = nodes.div_ceil(GROUP_RECORDS as usize);
    groups <= context.limits.max_compute_workgroups_per_dimension as usize
        && nodes as u64 * NODE_BYTES <= context.max_storage_bytes()
}

impl Scratch {
    /// Buffers for this number of nodes, those of `before` where they suffice and are not much larger.
    pub(super) fn for_nodes(context: &Context, before: Option<Self>, nodes: usize) -> Self {
        let needed = (nodes as u64).max(1);
        let suffices =
            |scratch: &Self| (needed..=needed.saturating_mul(MAX_OVERSIZE as u64)).contains(&scratch.capacity);
        if let Some(before) = before.filter(suffices) {
            return before;
        }
        let buffer = |bytes: u64, usage| {
            context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("byte code"),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        let of_nodes = || buffer(needed * NODE_BYTES, Usages::STORAGE);
        Self {
            queues: [of_nodes(), of_nodes()],
            places: buffer(needed * COUNTS_BYTES, Usages::STORAGE),
            sums: buffer(needed.div_ceil(GROUP_RECORDS.into()) * COUNTS_BYTES, Usages::STORAGE),
            found: buffer(FOUND_BYTES, Usages::STORAGE | Usages::COPY_SRC),
            groups: buffer(2 * DISPATCH_BYTES, Usages::STORAGE | Usages::INDIRECT),
            drawn_nodes: of_nodes(),
            capacity: needed,
        }
    }

    /// The queue of a level.
    pub(super) fn queue(&self, level: u32) -> &wgpu::Buffer {
        &self.queues[level as usize % 2]
    }

    /// The buffer of a binding other than those of queues, code, tables and output.
    pub(super) fn buffer(&self, binding: u32) -> &wgpu::Buffer {
        match binding {
            PLACES => &self.places,
            SUMS => &self.sums,
            FOUND => &self.found,
            GROUPS => &self.groups,
            DRAWN_NODES => &self.drawn_nodes,
            other => unreachable!("binding {other} has no scratch buffer"),
        }
    }
}
