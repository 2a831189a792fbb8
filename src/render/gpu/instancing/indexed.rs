//! Triangles and the vertices that they name, in storage buffers: the vertex stage pulls both by index.
//!
//! Strategies differ in how a record reaches the vertex stage. A triangle is nothing without its vertices, which it
//! shares with others: they are neither attributes stepped per instance nor read in their order, and 64 KiB of a
//! uniform buffer would part them from their triangles. So all strategies draw meshes in this one way, as `storage`
//! does, with the same bytes.
//!
//! A mesh whose vertices are more than a binding holds is drawn in chunks with the vertices of their own triangles: few
//! are in two chunks, as triangles stand in Morton order.

use super::binding::{buffer_with, max_indexed_records, records_of};
use super::strategy::Instancing;
use super::stream::{Chunk, RECORD_BYTES, Stream};
use crate::cloud::{MeshRecords, TriangleRecord, VertexRecord};
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::wgsl::{ShaderFile, shader_file};
use std::borrow::Cow;
use std::collections::HashMap;

/// The file by which the vertex stage gets a triangle.
pub(super) const FETCH: ShaderFile = shader_file!("fetch/indexed.wgsl");

/// Size of a vertex in records.
const RECORDS_PER_VERTEX: usize = size_of::<VertexRecord>() / RECORD_BYTES;

/// Shader stages that read triangles, vertices, texels, and texture locations.
const STAGES: [wgpu::ShaderStages; 4] = [
    wgpu::ShaderStages::VERTEX,
    wgpu::ShaderStages::VERTEX,
    wgpu::ShaderStages::FRAGMENT,
    wgpu::ShaderStages::FRAGMENT,
];

#[derive(Debug)]
pub(in crate::render::gpu) struct Indexed {
    /// Triangles, vertices, texels, and where textures are among them.
    layout: wgpu::BindGroupLayout,
}

/// Triangles that are drawn by one call, with their vertices.
struct Part<'a> {
    triangles: Cow<'a, [TriangleRecord]>,
    vertices: Cow<'a, [VertexRecord]>,
}

impl Indexed {
    pub(in crate::render::gpu) fn new(context: &Context) -> Self {
        let entry = |(binding, visibility)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = context
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("mesh"),
                entries: &(0..).zip(STAGES).map(entry).collect::<Vec<_>>(),
            });
        Self { layout }
    }

    /// Uploads a mesh in the number of chunks that the adapter needs.
    pub(in crate::render::gpu) fn upload(
        &self,
        context: &Context,
        amplification: &'static Amplification,
        mesh: &MeshRecords,
    ) -> Stream {
        let max_triangles = self.max_chunk_records(context, amplification);
        let max = max_triangles.min(context.max_chunk_records.unwrap_or(usize::MAX));
        let parts = parts(mesh, max, max / RECORDS_PER_VERTEX);
        let byte_size = |part: &Part<'_>| size_of_val(&*part.triangles) + size_of_val(&*part.vertices);
        let textures = [
            storage(context, bytemuck::cast_slice(mesh.textures.texels())),
            storage(context, bytemuck::cast_slice(mesh.textures.places())),
        ];
        let upload = |part: &Part<'_>| self.upload_part(context, part, &textures);
        Stream {
            byte_size: (parts.iter().map(byte_size).sum::<usize>() + mesh.textures.byte_size()) as u64,
            chunks: parts.iter().map(upload).collect(),
        }
    }

    fn upload_part(&self, context: &Context, part: &Part<'_>, textures: &[wgpu::Buffer]) -> Chunk {
        let records = [
            storage(context, bytemuck::cast_slice(&part.triangles)),
            storage(context, bytemuck::cast_slice(&part.vertices)),
        ];
        let resources = records.iter().chain(textures).map(wgpu::Buffer::as_entire_binding);
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
        Chunk {
            record_count: part.triangles.len() as u32,
            bind_group: Some(context.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("mesh"),
                layout: &self.layout,
                entries: &entries,
            })),
            buffer: None,
        }
    }
}

impl Instancing for Indexed {
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        Some(&self.layout)
    }

    fn max_chunk_records(&self, context: &Context, amplification: &'static Amplification) -> usize {
        let limits = &context.limits;
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        records_of(bytes).min(max_indexed_records(context, amplification))
    }
}

/// A buffer with these bytes; without any, of one record that is never read, as an empty buffer cannot be bound.
fn storage(context: &Context, bytes: &[u8]) -> wgpu::Buffer {
    let bytes = if bytes.is_empty() { &[0; RECORD_BYTES] } else { bytes };
    buffer_with(context, wgpu::BufferUsages::STORAGE, bytes, RECORD_BYTES)
}

/// Parts of at most this many triangles and vertices, but of one triangle at least, in the order of the triangles.
fn parts(mesh: &MeshRecords, max_triangles: usize, max_vertices: usize) -> Vec<Part<'_>> {
    if mesh.triangles.is_empty() {
        return Vec::new();
    }
    if mesh.triangles.len() <= max_triangles && mesh.vertices.len() <= max_vertices {
        return vec![Part {
            triangles: Cow::Borrowed(&mesh.triangles),
            vertices: Cow::Borrowed(&mesh.vertices),
        }];
    }
    let mut parts = Vec::new();
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    let (mut triangles, mut vertices) = (Vec::new(), Vec::new());
    for triangle in mesh.triangles.iter() {
        let is_full = triangles.len() + 1 > max_triangles || vertices.len() + 3 > max_vertices;
        if is_full && !triangles.is_empty() {
            parts.push(Part {
                triangles: Cow::Owned(std::mem::take(&mut triangles)),
                vertices: Cow::Owned(std::mem::take(&mut vertices)),
            });
            numbers.clear();
        }
        let corners = triangle.corners.map(|corner| {
            *numbers.entry(corner).or_insert_with(|| {
                vertices.push(mesh.vertices[corner as usize]);
                vertices.len() as u32 - 1
            })
        });
        triangles.push(TriangleRecord { corners, ..*triangle });
    }
    parts.push(Part {
        triangles: Cow::Owned(triangles),
        vertices: Cow::Owned(vertices),
    });
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable as _;
    use proptest::prelude::*;
    use std::sync::Arc;

    proptest! {
        #[test]
        fn chunks_have_all_triangles_in_order_with_their_own_vertices(
            corners in prop::collection::vec(prop::array::uniform3(0u32..30), 1..80),
            max_triangles in 1usize..40,
            max_vertices in 3usize..40,
        ) {
            let vertex = |index: u32| VertexRecord { texture: index, ..VertexRecord::zeroed() };
            let triangle = |corners: [u32; 3]| TriangleRecord { corners, normal: [0; 2] };
            let mesh = MeshRecords::new(
                Arc::new((0..30).map(vertex).collect()),
                Arc::new(corners.iter().copied().map(triangle).collect()),
            );
            let parts = parts(&mesh, max_triangles, max_vertices);
            let mut found = Vec::new();
            for part in &parts {
                prop_assert!(part.triangles.len() <= max_triangles && part.vertices.len() <= max_vertices);
                let named = |corner: u32| part.vertices[corner as usize].texture;
                found.extend(part.triangles.iter().map(|triangle| triangle.corners.map(named)));
            }
            prop_assert_eq!(found, corners);
        }
    }
}
