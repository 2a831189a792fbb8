//! A buffer for the records of a chunk, which a compute pass writes.

use super::stream::RECORD_BYTES;
use crate::render::gpu::recording::Recording;

/// Buffer that a compute pass writes records to.
#[derive(Debug)]
pub(in crate::render::gpu) struct RecordBuffer {
    /// Capacity in records.
    pub(in crate::render::gpu) capacity: usize,
    /// Destination buffer of the records.
    pub(in crate::render::gpu) buffer: wgpu::Buffer,
    /// Texture that they are copied to, if they are not drawn from the buffer.
    pub(super) texture: Option<wgpu::Texture>,
}

impl RecordBuffer {
    /// Copies the written records to the texture they are drawn from, if there is one.
    pub(in crate::render::gpu) fn copy_to_texture(&self, recording: &mut Recording<'_>) {
        if let Some(texture) = &self.texture {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(texture.width() * RECORD_BYTES as u32),
                rows_per_image: None,
            };
            recording.copy_to_texture(&self.buffer, layout, texture);
        }
    }
}
