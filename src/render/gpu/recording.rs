//! Command recording of compute passes and copies of an image.

use super::context::Context;
use super::timer::{Stamps, Timer};

/// State for recording compute passes.
#[derive(Debug)]
pub(super) struct Recording<'a> {
    pub(super) context: &'a Context,
    encoder: &'a mut wgpu::CommandEncoder,
    timer: Option<&'a mut Timer>,
}

impl<'a> Recording<'a> {
    /// Starts recording the commands before the passes of an image.
    pub(super) fn new(
        context: &'a Context,
        encoder: &'a mut wgpu::CommandEncoder,
        timer: Option<&'a mut Timer>,
    ) -> Self {
        Self {
            context,
            encoder,
            timer,
        }
    }

    /// Copies a buffer to all of a texture.
    pub(super) fn copy_to_texture(
        &mut self,
        buffer: &wgpu::Buffer,
        layout: wgpu::TexelCopyBufferLayout,
        texture: &wgpu::Texture,
    ) {
        let from = wgpu::TexelCopyBufferInfo { buffer, layout };
        self.encoder
            .copy_buffer_to_texture(from, texture.as_image_copy(), texture.size());
    }

    /// Writes zeros into the first bytes of a buffer, a multiple of four.
    pub(super) fn clear(&mut self, buffer: &wgpu::Buffer, bytes: u64) {
        self.encoder.clear_buffer(buffer, 0, Some(bytes));
    }

    /// For commands that are neither passes nor copies to a texture.
    pub(super) fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.encoder
    }

    /// Begins a compute pass.
    pub(super) fn begin_compute(&mut self, label: &'static str) -> wgpu::ComputePass<'_> {
        let stamps = self.timer.as_deref_mut().and_then(|timer| timer.stamps(label));
        self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: stamps.map(Stamps::of_compute),
        })
    }
}
