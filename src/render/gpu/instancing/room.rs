//! Room for the records of a chunk, which a compute pass writes.

use super::stream::RECORD_BYTES;
use crate::render::gpu::recording::Recording;

/// Where a compute pass writes records.
#[derive(Debug)]
pub(in crate::render::gpu) struct Room {
    /// How many records it is for.
    pub(in crate::render::gpu) capacity: usize,
    /// Where they are written.
    pub(in crate::render::gpu) buffer: wgpu::Buffer,
    /// What they are copied to, if they are not drawn from the buffer.
    pub(super) texture: Option<wgpu::Texture>,
}

impl Room {
    /// Copies what was written to where it is drawn from, if that is a texture.
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
