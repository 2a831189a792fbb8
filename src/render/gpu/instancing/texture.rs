//! Strategy `texture`: a record is one texel of a 2-D `rgba32uint` texture, fetched without filtering.
//!
//! Texel fetches go through the texture cache, which hardware without storage buffers in the vertex stage (WebGL 2,
//! older phones) has too. The price is a copy into the texture's own memory layout.

use super::binding::{buffer_for, max_indexed_records, single_binding, single_binding_layout};
use super::record_buffer::RecordBuffer;
use super::strategy::{Instancing, RecordInstancing, StrategyRow};
use super::stream::{Chunk, RECORD_BYTES};
use crate::render::gpu::context::Context;
use crate::render::gpu::primitives::Amplification;
use crate::render::gpu::wgsl::shader_file;

/// Texels per row: a power of two that every adapter allows and that wastes little of the last row.
const ROW_RECORDS: usize = 2048;

pub(super) const ROW: StrategyRow = StrategyRow {
    fetch: [shader_file!("fetch/texture.wgsl"); 2],
    fetch_corner: None,
    open: |context, _| Box::new(Texture::new(context)),
};

#[derive(Debug)]
struct Texture {
    layout: wgpu::BindGroupLayout,
}

impl Texture {
    fn new(context: &Context) -> Self {
        let ty = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        Self {
            layout: single_binding_layout(context, "texture stream", ty),
        }
    }
}

impl Instancing for Texture {
    fn stream_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        Some(&self.layout)
    }

    fn max_chunk_records(&self, context: &Context, amplification: &'static Amplification) -> usize {
        (ROW_RECORDS * context.limits.max_texture_dimension_2d as usize)
            .min(max_indexed_records(context, amplification))
    }
}

impl RecordInstancing for Texture {
    fn upload(&self, context: &Context, records: &[u8]) -> Chunk {
        let row_bytes = ROW_RECORDS * RECORD_BYTES;
        let texture = texture_for(context, records.len() / RECORD_BYTES);
        // Whole rows with one copy, then the rest of the last row.
        let whole_rows = (records.len() / row_bytes) as u32;
        let (whole, rest) = records.split_at(whole_rows as usize * row_bytes);
        let rest_records = (rest.len() / RECORD_BYTES) as u32;
        for (bytes, first_row, width, height) in [
            (whole, 0, ROW_RECORDS as u32, whole_rows),
            (rest, whole_rows, rest_records, u32::from(rest_records > 0)),
        ] {
            if height > 0 {
                context.queue.write_texture(
                    wgpu::TexelCopyTextureInfo {
                        texture: &texture,
                        mip_level: 0,
                        origin: wgpu::Origin3d {
                            x: 0,
                            y: first_row,
                            z: 0,
                        },
                        aspect: wgpu::TextureAspect::All,
                    },
                    bytes,
                    wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(width * RECORD_BYTES as u32),
                        rows_per_image: None,
                    },
                    wgpu::Extent3d {
                        width,
                        height,
                        depth_or_array_layers: 1,
                    },
                );
            }
        }
        self.chunk(context, &texture, records.len() / RECORD_BYTES)
    }

    fn record_buffer(&self, context: &Context, capacity: usize) -> RecordBuffer {
        let usage = wgpu::BufferUsages::COPY_SRC;
        RecordBuffer {
            capacity,
            buffer: buffer_for(context, usage, capacity, ROW_RECORDS * RECORD_BYTES),
            texture: Some(texture_for(context, capacity)),
        }
    }

    fn chunk_in(&self, context: &Context, record_buffer: &RecordBuffer, record_count: u32) -> Chunk {
        let empty = || texture_for(context, 1);
        let texture = record_buffer.texture.clone().unwrap_or_else(empty);
        self.chunk(context, &texture, record_count as usize)
    }
}

impl Texture {
    fn chunk(&self, context: &Context, texture: &wgpu::Texture, record_count: usize) -> Chunk {
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let resource = wgpu::BindingResource::TextureView(&view);
        Chunk {
            record_count: record_count as u32,
            bind_group: Some(single_binding(context, &self.layout, resource)),
            buffer: None,
        }
    }
}

/// Whole rows for this many records.
fn texture_for(context: &Context, record_count: usize) -> wgpu::Texture {
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("records"),
        size: wgpu::Extent3d {
            width: ROW_RECORDS as u32,
            height: record_count.div_ceil(ROW_RECORDS) as u32,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}
