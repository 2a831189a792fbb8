//! The uniforms of the parts of one image, in one buffer.

use super::context::Context;
use super::passes::ScreenPass;
use crate::scene::ScenePacket;

/// Uniforms of the image that was prepared last.
#[derive(Debug)]
pub(super) struct PartUniforms {
    buffer: wgpu::Buffer,
    /// Buffer offset of each uniform.
    offsets: Vec<(&'static str, u64)>,
}

/// Capacity for the uniforms of most images.
const USUAL_BYTES: u64 = 4096;

impl PartUniforms {
    pub(super) fn new(context: &Context) -> Self {
        Self {
            buffer: buffer(context, USUAL_BYTES),
            offsets: Vec::new(),
        }
    }

    /// Uploads the uniforms of passes over a packet.
    pub(super) fn prepare(
        &mut self,
        context: &Context,
        passes: impl Iterator<Item = &'static ScreenPass>,
        packet: &ScenePacket,
    ) {
        let alignment = context.limits.min_uniform_buffer_offset_alignment as usize;
        let mut bytes = Vec::new();
        self.offsets.clear();
        for pass in passes {
            self.offsets.push((pass.name, bytes.len() as u64));
            bytes.extend(pass.uniforms().flat_map(|uniform| (uniform.bytes)(packet)));
            bytes.resize(bytes.len().next_multiple_of(alignment), 0);
        }
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = buffer(context, bytes.len() as u64);
        }
        context.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// Returns the uniform binding of a pass, if it has a uniform. Precondition: it was prepared.
    pub(super) fn binding(&self, pass: &ScreenPass) -> Option<wgpu::BindingResource<'_>> {
        let size = wgpu::BufferSize::new(pass.uniform_bytes())?;
        let &(_, offset) = self.offsets.iter().find(|(name, _)| *name == pass.name)?;
        Some(wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset,
            size: Some(size),
        }))
    }
}

fn buffer(context: &Context, size: u64) -> wgpu::Buffer {
    context.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("parts"),
        size,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
