//! The compute programs that gather records: one binding a buffer, and a group of bindings for each chunk.

use super::compute::{Bound, BufferRow, ComputePrograms, ComputeShader, EntryRow, UNIFORM};
use super::constants::GROUP_RECORDS;
use super::context::Context;
use super::gpu_data::{Filtering, Gathering};
use super::layout::Shared;
use super::wgsl::shader_file;

/// The pass that copies selected nodes.
pub(super) const GATHER: ComputeShader = ComputeShader {
    label: "gather",
    rows: &[EntryRow {
        entry: "gather",
        file: shader_file!("passes/gather.wgsl"),
        buffers: &[1, 2, 3],
    }],
    given: &[],
    uniform: ("gathering", &Gathering::LAYOUT),
    buffers: &[BufferRow::read(1, "indices", "array<u32>"), NODES, GATHERED],
};

/// The pass that tests nodes.
pub(super) const FILTER: ComputeShader = ComputeShader {
    label: "filter",
    rows: &[EntryRow {
        entry: "gather",
        file: shader_file!("passes/filter.wgsl"),
        buffers: &[1, 2, 3, 4],
    }],
    given: &[],
    uniform: ("filtering", &Filtering::LAYOUT),
    buffers: &[
        // Names of the parents of leaves.
        BufferRow::read(1, "parents", "array<u32>"),
        NODES,
        GATHERED,
        BufferRow::read(4, "bounds", "array<NodeBounds>"),
    ],
};

const NODES: BufferRow = BufferRow::read(2, "nodes", "array<vec4u>");

const GATHERED: BufferRow = BufferRow::read_write(3, "gathered", "array<vec4u>");

/// One of them, made when it is first needed.
#[derive(Debug)]
pub(super) struct Program {
    pub(super) shader: ComputeShader,
    made: Option<ComputePrograms>,
}

impl Program {
    pub(super) fn new(shader: ComputeShader) -> Self {
        Self { shader, made: None }
    }

    pub(super) fn made(&mut self, context: &Context) -> &ComputePrograms {
        self.made
            .get_or_insert_with(|| ComputePrograms::new(context, self.shader))
    }
}

/// A uniform, and storage buffers in the order of their bindings.
pub(super) fn bind_group(
    programs: &ComputePrograms,
    context: &Context,
    uniform: &[u8],
    buffers: &[&wgpu::Buffer],
) -> wgpu::BindGroup {
    let uniform = context.filled_buffer("gathering", wgpu::BufferUsages::UNIFORM, uniform, uniform.len());
    programs.group(context, 0, |binding| match binding {
        UNIFORM => &uniform,
        _ => buffers[binding as usize - 1],
    })
}

/// Gathers this number of records.
pub(super) fn dispatch(
    programs: &ComputePrograms,
    context: &Context,
    pass: &mut wgpu::ComputePass<'_>,
    group: &wgpu::BindGroup,
    record_count: u32,
) {
    let max = context.limits.max_compute_workgroups_per_dimension;
    let groups = [record_count.div_ceil(GROUP_RECORDS).min(max), 1];
    programs.dispatch(pass, 0, Bound::whole(group), groups);
}
