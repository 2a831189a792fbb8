//! The uniforms of the parts of one picture, in one buffer.

use super::context::Context;
use super::part::Uniform;
use super::passes::ScreenPass;
use crate::scene::ScenePacket;

/// Those of the picture that was prepared last.
#[derive(Debug)]
pub(super) struct PartUniforms {
    buffer: wgpu::Buffer,
    /// Where each is.
    offsets: Vec<(&'static str, u64)>,
}

/// Room for those of most pictures.
const USUAL_BYTES: u64 = 4096;

impl PartUniforms {
    pub(super) fn new(context: &Context) -> Self {
        Self {
            buffer: buffer(context, USUAL_BYTES),
            offsets: Vec::new(),
        }
    }

    /// Uploads those of passes over a packet.
    pub(super) fn prepare(
        &mut self,
        context: &Context,
        passes: impl Iterator<Item = &'static ScreenPass>,
        packet: &ScenePacket,
    ) {
        let alignment = context.limits.min_uniform_buffer_offset_alignment as usize;
        let mut bytes = Vec::new();
        self.offsets.clear();
        for uniform in passes.flat_map(ScreenPass::uniforms) {
            if self.offset_of(uniform).is_none() {
                self.offsets.push((uniform.name, bytes.len() as u64));
                bytes.extend((uniform.bytes)(packet));
                bytes.resize(bytes.len().next_multiple_of(alignment), 0);
            }
        }
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = buffer(context, bytes.len() as u64);
        }
        context.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// What is bound for one. Precondition: a pass that was prepared has it.
    pub(super) fn binding(&self, uniform: &Uniform) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: self.offset_of(uniform).unwrap_or_default(),
            size: wgpu::BufferSize::new(uniform.layout.size as u64),
        })
    }

    fn offset_of(&self, uniform: &Uniform) -> Option<u64> {
        let known = self.offsets.iter().find(|(name, _)| *name == uniform.name);
        known.map(|&(_, offset)| offset)
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
