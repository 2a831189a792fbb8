//! Points of depth images: compute passes filter the images of a camera and make a point of every pixel.
//!
//! **How it works.** A frame that is drawn first is uploaded as its images: two bytes of depth and three of colour per
//! pixel, a third of its points. Passes of the stages of [`crate::rgbd`] (`shaders/depth_images`) filter the depths and
//! write points into a buffer of their own, in the order of the image. That is resident like any stream of points, so a
//! view uploads nothing, and `visible` reads it as it reads points that were uploaded; holes among them are identified
//! by their colour. The rays of the camera and the table from samples to metres are uploaded once.
//!
//! Passes are submitted when the frame is uploaded, not with the image: so the state of the temporal filter is always
//! that of the frame uploaded last. It begins as on the CPU, with the first frame of a group, and goes on from frame to
//! frame; a seek uploads the images before once more. So a frame alone is the frame after those before it.
//!
//! **When it wins.** It saves two thirds of the upload, and on a hardware GPU filters take a fraction of the CPU time.
//! It is used where a GPU makes the screen-space surfels
//! ([`GpuRenderer::set_makes_surfels`](super::GpuRenderer::set_makes_surfels)). The CPU filters (`rgbd/filters`) are
//! the reference for these, and are used everywhere else.
//!
//! Hofer et al. 2018 §3.4: depth and colour are uploaded, not points.

mod network;
mod passes;
mod scratch;
#[cfg(test)]
mod tests;

pub(super) use passes::SHADER;

use super::context::Context;
use super::gpu_data::DepthImaging;
use super::recording::Recording;
use super::timer::Timer;
use crate::cloud::PointRecord;
use crate::render::{PassTimes, RenderError};
use crate::rgbd::{DepthFrame, DepthSamples, Filters};
use crate::scene::PointImages;
use passes::{AFTER, AGES, BEFORE, COLORS, MADE_POINTS, MEAN, Pass, Programs, RAYS, SAMPLES, TABLE, UNIFORM, groups};
use scratch::{Scratch, Tables, uploaded_buffer, uploaded_samples};
use std::ptr;
use std::sync::{Arc, Weak};

/// Makes the points of one frame at a time.
#[derive(Debug, Default)]
pub(super) struct DepthMaker {
    programs: Option<Programs>,
    tables: Tables,
    scratch: Option<Scratch>,
    /// Frames that the temporal mean includes so far.
    cached: Option<Cached>,
    timer: Option<Timer>,
}

/// The frames that a mean over time is of.
#[derive(Debug)]
struct Cached {
    first: Weak<DepthSamples>,
    last: Weak<DepthSamples>,
    filters: Filters,
}

/// Points on the GPU.
#[derive(Debug)]
pub(super) struct MadePoints {
    pub(super) buffer: wgpu::Buffer,
    pub(super) count: u32,
    /// Uploaded bytes of images, rays and tables.
    pub(super) uploaded_bytes: u64,
    /// Compute passes.
    pub(super) passes: u64,
}

impl DepthMaker {
    /// Returns true if the adapter's limits on bindings and dispatches are large enough.
    pub(super) fn can_hold(context: &Context, frame: &DepthFrame) -> bool {
        let max_groups = context.limits.max_compute_workgroups_per_dimension;
        let bytes = (frame.pixels() * size_of::<PointRecord>()) as u64;
        bytes <= context.max_storage_bytes() && groups(frame.size_px()).iter().all(|&count| count <= max_groups)
    }

    /// Makes the points of `images`. Precondition: [`DepthMaker::can_hold`].
    pub(super) fn make(&mut self, context: &Context, images: &PointImages) -> MadePoints {
        let frame = &*images.frame;
        let size_px = frame.size_px();
        self.programs.get_or_insert_with(|| Programs::new(context));
        if self.timer.is_none() {
            self.timer = Timer::new(context);
        }
        if let Some(timer) = &mut self.timer {
            timer.begin(context);
        }
        let goes_on = self.images_to_do(frame);
        let pixels = frame.pixels() as u64;
        let scratch = Scratch::of(context, self.scratch.take(), pixels);
        let mut made = MadePoints {
            buffer: points_buffer(context, frame.pixels()),
            count: frame.pixels() as u32,
            uploaded_bytes: self.tables.ensure(context, frame),
            passes: 0,
        };
        let colors = frame.colors().filter(|_| images.one_color.is_none());
        let colors = colors.map(|colors| {
            let bytes: &[u8] = bytemuck::cast_slice(colors);
            made.uploaded_bytes += bytes.len() as u64;
            uploaded_buffer(context, bytes)
        });
        let uniform = DepthImaging {
            origin: images.origin.to_array(),
            has_colors: colors.is_some().into(),
            one_color: u32::from_le_bytes(images.one_color.unwrap_or([u8::MAX; 4])),
            ..DepthImaging::of(size_px, frame.filters())
        };
        let mut encoder = context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("depth images"),
        });
        let to_do: Vec<&Arc<DepthSamples>> = frame.images().skip(goes_on.unwrap_or(0)).collect();
        if goes_on.is_none() && frame.filters().temporal.is_some() {
            scratch.clear_cached(&mut Recording::new(context, &mut encoder, None));
        }
        let mut place = 0;
        for (number, samples) in (1..).zip(&to_do) {
            let is_coded = samples.table().is_some().into();
            let uniform = uploaded_uniform(context, DepthImaging { is_coded, ..uniform });
            let of_samples = uploaded_samples(context, samples);
            made.uploaded_bytes += samples.byte_size() as u64;
            // The reported times of a frame belong to its own image.
            let timer = self.timer.as_mut().filter(|_| number == to_do.len());
            let mut filtering = Filtering {
                recording: Recording::new(context, &mut encoder, timer),
                programs: self.programs.as_ref(),
                tables: &self.tables,
                scratch: &scratch,
                uniform: &uniform,
                samples: Some(&of_samples),
                size_px,
                place: 0,
                passes: 0,
            };
            filtering.filter(frame.filters());
            place = filtering.place;
            made.passes += filtering.passes;
        }
        let uniform = uploaded_uniform(context, uniform);
        let mut last = Filtering {
            recording: Recording::new(context, &mut encoder, self.timer.as_mut()),
            programs: self.programs.as_ref(),
            tables: &self.tables,
            scratch: &scratch,
            uniform: &uniform,
            samples: None,
            size_px,
            place,
            passes: 0,
        };
        last.reproject(frame.filters(), colors.as_ref(), &made.buffer);
        made.passes += last.passes;
        if let Some(timer) = &mut self.timer {
            timer.end(&mut encoder);
        }
        // With the upload and not with the image: the mean over time must not depend on which images were drawn.
        context.queue.submit([encoder.finish()]);
        self.scratch = Some(scratch);
        self.cached = frame.filters().temporal.and(cached_after(frame));
        made
    }

    /// Returns the number of images that the temporal mean already includes; `None` where it starts again.
    fn images_to_do(&self, frame: &DepthFrame) -> Option<usize> {
        let cached = self
            .cached
            .as_ref()
            .filter(|cached| cached.filters == *frame.filters())?;
        let is = |known: &Weak<DepthSamples>, image: &Arc<DepthSamples>| ptr::eq(known.as_ptr(), Arc::as_ptr(image));
        let begins_alike = frame.images().next().is_some_and(|first| is(&cached.first, first));
        let last = frame.images().rposition(|image| is(&cached.last, image));
        last.filter(|_| begins_alike).map(|last| last + 1)
    }

    /// The times of the last frame that was measured.
    pub(super) fn times(&self) -> PassTimes {
        let last = self.timer.as_ref().map(Timer::last);
        last.map_or_else(PassTimes::default, |times| times.passes)
    }

    /// Waits for the times of the last frame.
    pub(super) fn wait_times(&mut self, context: &Context) -> Result<PassTimes, RenderError> {
        context.wait()?;
        let times = self.timer.as_mut().and_then(|timer| timer.wait(context));
        Ok(times.unwrap_or_default().passes)
    }
}

/// Returns the state of the temporal mean once the points of `frame` are made.
fn cached_after(frame: &DepthFrame) -> Option<Cached> {
    Some(Cached {
        first: Arc::downgrade(frame.images().next()?),
        last: Arc::downgrade(frame.images().next_back()?),
        filters: *frame.filters(),
    })
}

/// The passes over one image.
struct Filtering<'a, 'b> {
    recording: Recording<'b>,
    programs: Option<&'a Programs>,
    tables: &'a Tables,
    scratch: &'a Scratch,
    uniform: &'a wgpu::Buffer,
    samples: Option<&'a wgpu::Buffer>,
    size_px: [u32; 2],
    /// Index, of the two ping-pong images, of the one with the latest result.
    place: usize,
    passes: u64,
}

impl Filtering<'_, '_> {
    /// All filters, in their order.
    fn filter(&mut self, filters: &Filters) {
        self.pass(Pass::Near);
        if filters.median {
            self.pass(Pass::Median);
        }
        if filters.bilateral.is_some() {
            self.pass(Pass::Bilateral);
        }
        if let Some(flying) = &filters.flying {
            self.pass(Pass::Flying);
            for _ in 0..flying.erosion_px {
                self.pass(Pass::Erode);
            }
        }
        if filters.temporal.is_some() {
            self.pass(Pass::Temporal);
        }
    }

    /// From one image to the other; the mean over time stays where it is.
    fn pass(&mut self, which: Pass) {
        let (scratch, uniform, samples) = (self.scratch, self.uniform, self.samples.or(self.tables.nothing()));
        let (before, after) = (scratch.image(self.place), scratch.image(self.place + 1));
        let (Some(programs), Some(samples), Some(metres)) = (self.programs, samples, self.tables.metres()) else {
            return;
        };
        programs.record(&mut self.recording, which, self.size_px, |binding| match binding {
            UNIFORM => uniform,
            SAMPLES => samples,
            TABLE => metres,
            BEFORE => before,
            AFTER => after,
            cached => scratch.cached(cached),
        });
        self.place += usize::from(which != Pass::Temporal);
        self.passes += 1;
    }

    /// Points of the images filtered last.
    fn reproject(&mut self, filters: &Filters, colors: Option<&wgpu::Buffer>, points: &wgpu::Buffer) {
        let (scratch, uniform) = (self.scratch, self.uniform);
        let depths = match filters.temporal {
            Some(_) => scratch.cached(MEAN),
            None => scratch.image(self.place),
        };
        let colors = colors.or(self.tables.nothing());
        let (Some(programs), Some(rays), Some(colors)) = (self.programs, self.tables.rays(), colors) else {
            return;
        };
        programs.record(
            &mut self.recording,
            Pass::Reproject,
            self.size_px,
            |binding| match binding {
                UNIFORM => uniform,
                RAYS => rays,
                COLORS => colors,
                MADE_POINTS => points,
                AGES | MEAN => scratch.cached(binding),
                _ => depths,
            },
        );
        self.passes += 1;
    }
}

fn uploaded_uniform(context: &Context, uniform: DepthImaging) -> wgpu::Buffer {
    let bytes = bytemuck::bytes_of(&uniform);
    context.filled_buffer("depth images", wgpu::BufferUsages::UNIFORM, bytes, bytes.len())
}

fn points_buffer(context: &Context, pixels: usize) -> wgpu::Buffer {
    context.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("points of depth images"),
        size: (pixels * size_of::<PointRecord>()) as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}
