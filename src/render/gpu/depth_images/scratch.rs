//! GPU scratch buffers between the images of a frame and its points, which are reused.

use super::passes::{AGES, MEAN};
use crate::render::gpu::constants::NO_RAY;
use crate::render::gpu::context::Context;
use crate::render::gpu::recording::Recording;
use crate::rgbd::{DepthFrame, DepthSamples, DepthTable, RayTable};
use std::sync::Arc;
use wgpu::BufferUsages as Usages;

/// Size of a depth or an age.
const WORD_BYTES: u64 = 4;

/// Images of depths that passes hand on, and the state retained from earlier frames.
#[derive(Debug)]
pub(super) struct Scratch {
    pixels: u64,
    images: [wgpu::Buffer; 2],
    mean: wgpu::Buffer,
    ages: wgpu::Buffer,
}

impl Scratch {
    /// For this number of pixels: `before`, if it is as large.
    pub(super) fn of(context: &Context, before: Option<Self>, pixels: u64) -> Self {
        if let Some(known) = before.filter(|known| known.pixels == pixels) {
            return known;
        }
        let image = || {
            context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("depth images"),
                size: pixels * WORD_BYTES,
                usage: Usages::STORAGE | Usages::COPY_DST | Usages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        Self {
            pixels,
            images: [image(), image()],
            mean: image(),
            ages: image(),
        }
    }

    /// One of the two images that are read and written in turn.
    pub(super) fn image(&self, place: usize) -> &wgpu::Buffer {
        &self.images[place % 2]
    }

    /// Returns the buffer retained from previous frames: [`MEAN`] or [`AGES`].
    pub(super) fn cached(&self, binding: u32) -> &wgpu::Buffer {
        debug_assert!([MEAN, AGES].contains(&binding));
        if binding == MEAN { &self.mean } else { &self.ages }
    }

    /// No frames were before.
    pub(super) fn clear_cached(&self, recording: &mut Recording<'_>) {
        for buffer in [&self.mean, &self.ages] {
            recording.clear(buffer, buffer.size());
        }
    }
}

/// Lookup tables that are uploaded once: the table of a code and the rays of a camera.
#[derive(Debug, Default)]
pub(super) struct Tables {
    metres: Option<(DepthTable, wgpu::Buffer)>,
    rays: Option<(Arc<RayTable>, wgpu::Buffer)>,
    nothing: Option<wgpu::Buffer>,
}

impl Tables {
    /// Uploads the missing ones. Returns the bytes uploaded.
    pub(super) fn ensure(&mut self, context: &Context, frame: &DepthFrame) -> u64 {
        let mut uploaded = 0;
        self.nothing.get_or_insert_with(|| uploaded_buffer(context, &[0; 16]));
        if let Some(table) = frame.images().find_map(|samples| samples.table())
            && !self.metres.as_ref().is_some_and(|(known, _)| known.is_same(table))
        {
            let bytes: &[u8] = bytemuck::cast_slice(table.metres());
            uploaded += bytes.len() as u64;
            self.metres = Some((table.clone(), uploaded_buffer(context, bytes)));
        }
        let rays = frame.rays();
        if !self.rays.as_ref().is_some_and(|(known, _)| Arc::ptr_eq(known, rays)) {
            let told = |&[x, y]: &[f32; 2]| {
                let is_ray = x.abs() < NO_RAY && y.abs() < NO_RAY;
                // Shaders see neither NaN nor infinities: not outside the lens, either.
                if is_ray { [x, y] } else { [NO_RAY; 2] }
            };
            let slopes: Vec<[f32; 2]> = rays.rays().iter().map(told).collect();
            let bytes: &[u8] = bytemuck::cast_slice(&slopes);
            uploaded += bytes.len() as u64;
            self.rays = Some((Arc::clone(rays), uploaded_buffer(context, bytes)));
        }
        uploaded
    }

    /// Metres of each number, or of nothing.
    pub(super) fn metres(&self) -> Option<&wgpu::Buffer> {
        self.metres.as_ref().map(|(_, buffer)| buffer).or(self.nothing.as_ref())
    }

    /// Returns the rays of the frame that was ensured last.
    pub(super) fn rays(&self) -> Option<&wgpu::Buffer> {
        self.rays.as_ref().map(|(_, buffer)| buffer)
    }

    /// Returns the placeholder buffer for a missing binding.
    pub(super) fn nothing(&self) -> Option<&wgpu::Buffer> {
        self.nothing.as_ref()
    }
}

/// The samples of an image on the GPU.
pub(super) fn uploaded_samples(context: &Context, samples: &DepthSamples) -> wgpu::Buffer {
    match samples {
        // Raw values in any encoding: a table of 2¹⁶ entries has exactly the metres of the CPU, and five bytes per
        // pixel with colour are uploaded instead of 16 per point (1.5 MB for 640×480).
        DepthSamples::Coded { numbers, .. } => uploaded_buffer(context, bytemuck::cast_slice(numbers)),
        // Without values that are not distances: shaders see neither NaN nor infinities.
        DepthSamples::Metres(metres) => uploaded_buffer(context, bytemuck::cast_slice(metres)),
    }
}

/// A buffer that begins with `bytes`, with space for one more word: the value read there is ignored.
pub(super) fn uploaded_buffer(context: &Context, bytes: &[u8]) -> wgpu::Buffer {
    let whole = bytes.len().next_multiple_of(WORD_BYTES as usize);
    let mut padded = Vec::new();
    let bytes = if whole == bytes.len() {
        bytes
    } else {
        // Memory is mapped in whole words.
        padded.extend_from_slice(bytes);
        padded.resize(whole, 0);
        &padded
    };
    context.filled_buffer("depth images", Usages::STORAGE, bytes, whole + WORD_BYTES as usize)
}
