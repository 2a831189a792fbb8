//! Scratch buffers that passes hand on to those after them.

use super::passes::{
    CELL_KEYS, CELL_KEYS_FOUND, CELLS, DEPTHS, FOUND, NEAREST, NEAREST_DRAWN, NORMALS, PLACES, SEEN_POINTS,
};
use crate::analysis::screen::constants::{BORDER_PX, MAX_LEVELS};
use crate::render::gpu::constants::GROUP_RECORDS;
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::Screening;
use crate::render::gpu::record_buffers::MAX_OVERSIZE;
use crate::render::gpu::recording::Recording;

/// Bytes of `Found` in `screen_normals/view.wgsl`.
pub(super) const FOUND_BYTES: u64 = 24;

/// Sizes of a number, of a key of a cell, and of four numbers.
const WORD_BYTES: u64 = 4;
const KEY_BYTES: u64 = 12;
const PLACE_BYTES: u64 = 16;

/// Buffers of its own: their bindings. Two of these have another one, by which they are read.
const OWN: [u32; 8] = [FOUND, NEAREST, DEPTHS, PLACES, SEEN_POINTS, CELL_KEYS, CELLS, NORMALS];

/// Bindings of the buffers that are cleared to zeros first.
const CLEARED: [u32; 3] = [FOUND, NEAREST, CELL_KEYS];

/// Numbers of elements that determine the buffer sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sizes {
    pub(super) points: u32,
    /// Size of the image with its margin.
    pub(super) size_px: [u32; 2],
}

impl Sizes {
    /// Pixels with the border around them.
    pub(super) fn bordered(&self) -> u32 {
        let [width, height] = self.size_px.map(|edge| edge + 2 * BORDER_PX as u32);
        width.saturating_mul(height)
    }

    pub(super) fn cells_of(&self, level: u32) -> u32 {
        let [width, height] = self.size_px.map(|edge| (edge >> level) + 1);
        width.saturating_mul(height)
    }

    /// Bytes of a buffer of its own.
    fn bytes(&self, binding: u32) -> u64 {
        let [width, height] = self.size_px.map(u64::from);
        let points = u64::from(self.points);
        let cells = || {
            (0..=MAX_LEVELS)
                .map(|level| u64::from(self.cells_of(level)))
                .sum::<u64>()
        };
        match binding {
            FOUND => FOUND_BYTES,
            NEAREST => width * height * WORD_BYTES,
            DEPTHS => u64::from(self.bordered()) * WORD_BYTES,
            PLACES => (2 * points + points.div_ceil(GROUP_RECORDS.into())) * WORD_BYTES,
            SEEN_POINTS => points * PLACE_BYTES,
            NORMALS => points * WORD_BYTES,
            CELL_KEYS => cells() * KEY_BYTES,
            _ => cells() * PLACE_BYTES,
        }
    }

    /// Returns true if the adapter's limits allow binding such buffers, and dispatching the required number of
    /// workgroups at once.
    pub(super) fn fit(&self, context: &Context) -> bool {
        let invocations = self.points.max(self.bordered()).max(self.cells_of(0));
        // 65,535 workgroups are about 16 million points or pixels; beyond that, the CPU makes the records.
        let groups = invocations.div_ceil(GROUP_RECORDS);
        let max_bytes = OWN.into_iter().map(|binding| self.bytes(binding)).max();
        groups <= context.limits.max_compute_workgroups_per_dimension
            && max_bytes.is_none_or(|bytes| bytes <= context.max_storage_bytes())
    }
}

/// The buffers.
#[derive(Debug)]
pub(super) struct Scratch {
    uniforms: wgpu::Buffer,
    /// In the order of [`OWN`].
    own: Vec<wgpu::Buffer>,
    uniform_stride: u32,
}

impl Scratch {
    /// Buffers that are large enough: those of `before` where they suffice and are not much larger.
    pub(super) fn for_sizes(context: &Context, before: Option<Self>, sizes: &Sizes) -> Self {
        let alignment = context.limits.min_uniform_buffer_offset_alignment;
        let uniform_stride = (size_of::<Screening>() as u32).next_multiple_of(alignment);
        let (uniforms, own) = before.map_or((None, Vec::new()), |before| (Some(before.uniforms), before.own));
        let mut own = own.into_iter();
        let buffers = OWN.into_iter().map(|binding| {
            let needed = sizes.bytes(binding).max(PLACE_BYTES);
            let fits = |buffer: &wgpu::Buffer| (needed..=MAX_OVERSIZE as u64 * needed).contains(&buffer.size());
            own.next()
                .filter(fits)
                .unwrap_or_else(|| buffer(context, needed, usage_of(binding)))
        });
        Self {
            own: buffers.collect(),
            uniforms: uniforms.unwrap_or_else(|| uniform_buffer(context, u64::from(uniform_stride))),
            uniform_stride,
        }
    }

    /// Returns the buffer for a binding other than those of points and of the drawn output.
    pub(super) fn buffer(&self, binding: u32) -> &wgpu::Buffer {
        let own = match binding {
            NEAREST_DRAWN => NEAREST,
            CELL_KEYS_FOUND => CELL_KEYS,
            binding => binding,
        };
        let place = OWN.iter().position(|&binding| binding == own);
        place.map_or(&self.uniforms, |place| &self.own[place])
    }

    /// Writes the uniforms.
    pub(super) fn upload(&mut self, context: &Context, uniforms: &[Screening]) {
        let stride = self.uniform_stride as usize;
        let mut bytes = vec![0; stride * uniforms.len()];
        for (place, uniform) in bytes.chunks_mut(stride).zip(uniforms) {
            place[..size_of::<Screening>()].copy_from_slice(bytemuck::bytes_of(uniform));
        }
        if self.uniforms.size() < bytes.len() as u64 {
            self.uniforms = uniform_buffer(context, bytes.len() as u64);
        }
        context.queue.write_buffer(&self.uniforms, 0, &bytes);
    }

    /// Returns the byte offset of a uniform.
    pub(super) fn uniform_offset(&self, place: u32) -> u32 {
        place * self.uniform_stride
    }

    /// Writes zeros where passes begin with them.
    pub(super) fn clear(&self, recording: &mut Recording<'_>, sizes: &Sizes) {
        for binding in CLEARED {
            recording.clear(self.buffer(binding), sizes.bytes(binding));
        }
    }
}

/// Returns the buffer usage of a binding; the visibility counters are read back.
fn usage_of(binding: u32) -> wgpu::BufferUsages {
    let read_back = if binding == FOUND {
        wgpu::BufferUsages::COPY_SRC
    } else {
        wgpu::BufferUsages::empty()
    };
    wgpu::BufferUsages::STORAGE | read_back
}

fn uniform_buffer(context: &Context, bytes: u64) -> wgpu::Buffer {
    buffer(context, bytes, wgpu::BufferUsages::UNIFORM)
}

fn buffer(context: &Context, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    context.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("screen normals"),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
