//! Layouts, groups and limits that several strategies share.

use super::stream::RECORD_BYTES;
use crate::render::gpu::constants::INDICES_PER_QUAD;
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;

/// A buffer that holds `records`, padded with zeros to a multiple of `alignment` bytes.
pub(super) fn buffer_with(
    context: &Context,
    usage: wgpu::BufferUsages,
    records: &[u8],
    alignment: usize,
) -> wgpu::Buffer {
    context.filled_buffer("records", usage, records, records.len().next_multiple_of(alignment))
}

/// A buffer for this many records, which a compute pass writes, padded like [`buffer_with`].
pub(super) fn buffer_for(
    context: &Context,
    usage: wgpu::BufferUsages,
    capacity: usize,
    alignment: usize,
) -> wgpu::Buffer {
    context.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("gathered records"),
        size: (capacity * RECORD_BYTES).next_multiple_of(alignment) as u64,
        usage: usage | wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}

/// A layout with one binding for the vertex stage (and the compute stage, which amplifies).
pub(super) fn single_binding_layout(context: &Context, label: &str, ty: wgpu::BindingType) -> wgpu::BindGroupLayout {
    context
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX | wgpu::ShaderStages::COMPUTE,
                ty,
                count: None,
            }],
        })
}

/// The bind group of a [`single_binding_layout`].
pub(super) fn single_binding(
    context: &Context,
    layout: &wgpu::BindGroupLayout,
    resource: wgpu::BindingResource<'_>,
) -> wgpu::BindGroup {
    context.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("records"),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource }],
    })
}

/// Returns the number of records that the given number of bytes holds.
pub(super) fn records_of(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX) / RECORD_BYTES
}

/// Limit of a draw call: indices are u32 and so is their count.
const MAX_INDEXED_QUADS: usize = (u32::MAX / INDICES_PER_QUAD) as usize;

/// The maximum number of records whose quads one draw call can index, with an index buffer that the adapter can hold.
pub(super) fn max_indexed_records(context: &Context, amplification: &'static Amplification) -> usize {
    let quads = amplification.quads_per_record().max(1) as usize;
    let index_bytes = (INDICES_PER_QUAD as usize) * size_of::<u32>();
    let buffer_quads = usize::try_from(context.limits.max_buffer_size).unwrap_or(usize::MAX) / index_bytes;
    MAX_INDEXED_QUADS.min(buffer_quads) / quads
}
