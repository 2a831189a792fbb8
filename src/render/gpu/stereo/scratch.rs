//! GPU scratch buffers for matching a stereo pair, reused for a pair of the same size.

use super::passes::{CENSUS, COLUMNS, MADE_CENSUS, PATH_STEPS, PIXELS, SUMS, UNIFORM, WINNERS};
use crate::render::RenderError;
use crate::render::gpu::context::Context;
use crate::render::gpu::gpu_data::StereoMatching;
use crate::stereo::GrayImage;
use wgpu::BufferUsages as Usages;

/// Size of a label, or of two sums.
const WORD_BYTES: u64 = 4;

/// Size of the census bits of a pixel.
const CENSUS_BYTES: u64 = 8;

/// Memory limit for the buffers of a pair.
const MAX_BYTES: u64 = 512 << 20;

/// Maximum memory retained between pairs.
const MAX_CACHED_BYTES: u64 = 128 << 20;

/// Dimensions that determine the buffer sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sizes {
    pub(super) pixels: u64,
    /// Labels of a pixel, an even number.
    pub(super) labels: u64,
    /// True if sums of columns are stored in addition to sums of squares.
    pub(super) is_local: bool,
}

impl Sizes {
    /// Returns true if the adapter can bind the buffers and their total is within the memory limit. Preconditions:
    /// fewer than 2³² pixels and 2¹⁶ labels.
    pub(super) fn fit(&self, context: &Context) -> bool {
        let largest = self.sums().max(2 * self.pixels * CENSUS_BYTES);
        largest <= context.max_storage_bytes() && self.all() <= MAX_BYTES
    }

    fn sums(&self) -> u64 {
        // All sums at once, not in bands as on the CPU: a GPU has the memory, and would gain nothing from bands.
        self.pixels * self.labels / 2 * WORD_BYTES
    }

    fn columns(&self) -> u64 {
        if self.is_local { self.sums() } else { WORD_BYTES }
    }

    fn brightnesses(&self) -> u64 {
        (2 * self.pixels).next_multiple_of(WORD_BYTES)
    }

    /// Returns the total size of all buffers.
    fn all(&self) -> u64 {
        // Winners of both images, labels before and after, and the readback.
        let of_pixels = 2 * CENSUS_BYTES + 5 * WORD_BYTES;
        self.sums() + self.columns() + self.brightnesses() + self.pixels * of_pixels
    }
}

/// Buffers of a pair.
#[derive(Debug)]
pub(super) struct Scratch {
    sizes: Sizes,
    uniforms: wgpu::Buffer,
    uniform_stride: u32,
    pixels: wgpu::Buffer,
    census: wgpu::Buffer,
    columns: wgpu::Buffer,
    sums: wgpu::Buffer,
    winners: wgpu::Buffer,
    labels: [wgpu::Buffer; 2],
    readable: wgpu::Buffer,
}

impl Scratch {
    /// For a pair of this size: `before`, if it is of one. Precondition: it fits.
    pub(super) fn of(context: &Context, before: Option<Self>, sizes: Sizes) -> Result<Self, RenderError> {
        if let Some(known) = before.filter(|known| known.sizes == sizes) {
            return Ok(known);
        }
        let alignment = context.limits.min_uniform_buffer_offset_alignment;
        let uniform_stride = (size_of::<StereoMatching>() as u32).next_multiple_of(alignment);
        let buffer = |size: u64, usage| {
            context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("stereo"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        context.catching_out_of_memory("stereo of a pair", || {
            let labels = || buffer(sizes.pixels * WORD_BYTES, Usages::STORAGE | Usages::COPY_SRC);
            Self {
                sizes,
                uniforms: buffer(
                    u64::from(uniform_stride) * PATH_STEPS.len() as u64,
                    Usages::UNIFORM | Usages::COPY_DST,
                ),
                uniform_stride,
                pixels: buffer(sizes.brightnesses(), Usages::STORAGE | Usages::COPY_DST),
                census: buffer(2 * sizes.pixels * CENSUS_BYTES, Usages::STORAGE),
                columns: buffer(sizes.columns(), Usages::STORAGE),
                sums: buffer(sizes.sums(), Usages::STORAGE | Usages::COPY_SRC),
                winners: buffer(2 * sizes.pixels * WORD_BYTES, Usages::STORAGE),
                labels: [labels(), labels()],
                readable: buffer(sizes.pixels * WORD_BYTES, Usages::MAP_READ | Usages::COPY_DST),
            }
        })
    }

    /// Returns true if the scratch buffers are worth keeping for the next pair.
    pub(super) fn is_cached(&self) -> bool {
        self.sizes.all() <= MAX_CACHED_BYTES
    }

    /// Uploads both images, and the uniforms of all paths. Precondition: images of the size of these buffers.
    pub(super) fn upload(&self, context: &Context, images: [&GrayImage; 2], uniform: StereoMatching) {
        let mut pixels = images.map(GrayImage::pixels).concat();
        pixels.resize(self.sizes.brightnesses() as usize, 0);
        context.queue.write_buffer(&self.pixels, 0, &pixels);
        let mut uniforms = vec![0; self.uniforms.size() as usize];
        let places = uniforms.chunks_exact_mut(self.uniform_stride as usize);
        for (number, (place, path_step)) in places.zip(PATH_STEPS).enumerate() {
            let uniform = StereoMatching {
                path_step,
                is_first_path: (number == 0).into(),
                ..uniform
            };
            place[..size_of::<StereoMatching>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        context.queue.write_buffer(&self.uniforms, 0, &uniforms);
    }

    /// Returns the offset of the uniform of a path. The first path's also serves every other pass.
    pub(super) fn uniform_offset(&self, path: usize) -> u32 {
        self.uniform_stride * path as u32
    }

    /// Returns the buffer for a binding that is not a label image.
    pub(super) fn bound(&self, binding: u32) -> &wgpu::Buffer {
        match binding {
            UNIFORM => &self.uniforms,
            PIXELS => &self.pixels,
            CENSUS | MADE_CENSUS => &self.census,
            COLUMNS => &self.columns,
            SUMS => &self.sums,
            other => {
                debug_assert_eq!(other, WINNERS);
                &self.winners
            }
        }
    }

    /// One of the two images of labels that are read and written in turn.
    pub(super) fn labels(&self, place: usize) -> &wgpu::Buffer {
        &self.labels[place % 2]
    }

    /// Returns the readback buffer that labels are copied to.
    pub(super) fn readable(&self) -> &wgpu::Buffer {
        &self.readable
    }
}
