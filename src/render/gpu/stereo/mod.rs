//! Stereo matching on the GPU: disparities of rectified pairs.
//!
//! **How it works.** Compute passes of the stages of [`crate::stereo`] (`shaders/stereo`): the census of both images;
//! sums of costs along eight paths (a workgroup goes along a path, its invocations share the labels of a pixel), or
//! over squares; the winners of both images; subpixel positions between labels; the median. One disparity per pixel is
//! read back. Specks, which are connected areas, are removed by the CPU. Costs are computed wherever they are needed,
//! eight times for eight paths: bits of the census are read, which are next to each other, and nothing is written but
//! sums, two bytes per label.
//!
//! Integers (sums, winners, labels before they are refined) match the CPU to the bit, and so do positions that are
//! quotients of them (`exact_share.wgsl`). Planes through positions are sums of fractions, in an order of the
//! adapter's: they differ by less than a thousandth of a pixel.
//!
//! **When it wins.** On a hardware GPU: all paths of a direction at once. A software adapter on the CPU is slower than
//! the CPU's own code, which takes 32 labels at once and sums in caches; so [`CardMatcher::shared`] is the CPU there.
//!
//! The CPU takes over where the GPU cannot: more than 512 labels, buffers above 512 MiB or the adapter's limits, no
//! memory, a device that was lost. Rectification is the CPU's, too.
//!
//! Yang et al. 2006 §5; Hirschmüller 2008.

mod passes;
mod scratch;
#[cfg(test)]
mod tests;

pub(super) use passes::SHADER;

use super::compute::Bound;
use super::constants::{NO_LABEL, STEREO_MAX_LABELS};
use super::context::Context;
use super::gpu_data::StereoMatching;
use super::readback::map_and_read;
use crate::locks::lock;
use crate::render::RenderError;
use crate::stereo::{
    Between, DisparityMap, DisparityRange, Gathering, GrayImage, Matching, OnProcessor, PairMatcher, SharedMatcher,
    StereoError,
};
use passes::{AFTER, BEFORE, PATH_STEPS, Pass, Programs, has_groups};
use scratch::{Scratch, Sizes};
use std::sync::{Arc, Mutex};

/// GPU stereo matcher, which matches one pair at a time.
#[derive(Debug)]
pub struct CardMatcher {
    context: Arc<Context>,
    on_card: Mutex<OnCard>,
}

/// GPU state that is reused for the next pair.
#[derive(Debug, Default)]
struct OnCard {
    programs: Option<Programs>,
    scratch: Option<Scratch>,
    has_warned: bool,
}

impl CardMatcher {
    /// A matcher on the GPU of this context. Its programs are made when the first pair is matched.
    pub fn new(context: Arc<Context>) -> Self {
        Self {
            context,
            on_card: Mutex::default(),
        }
    }

    /// Returns the stereo matcher for the machine where this context draws: its GPU, or the CPU if that draws as well.
    pub fn shared(context: &Arc<Context>) -> SharedMatcher {
        // lavapipe (2 cores, one in use), 128 × 128 pixels, 64 disparities: 54 ms local, 377 ms semi-global; the CPU
        // code takes 11 and 19 ms. An NVIDIA H200 takes 0.42 and 1.29 ms, 16 threads of its host 1.48 and 5.99 ms.
        if context.is_software() {
            SharedMatcher::default()
        } else {
            SharedMatcher(Arc::new(Self::new(Arc::clone(context))))
        }
    }

    /// Disparities of a pair without specks taken out; `None` where it is none for the GPU.
    fn on_card(
        &self,
        matching: &Matching,
        images: [&GrayImage; 2],
        range: DisparityRange,
    ) -> Result<Option<Vec<f32>>, RenderError> {
        let Some(job) = Job::of(&self.context, matching, images, range) else {
            return Ok(None);
        };
        self.context.check_alive()?;
        let mut on_card = lock(&self.on_card);
        let OnCard { programs, scratch, .. } = &mut *on_card;
        let programs = programs.get_or_insert_with(|| Programs::new(&self.context));
        let buffers = Scratch::of(&self.context, scratch.take(), job.sizes)?;
        let disparities = job.run(&self.context, programs, &buffers)?;
        *scratch = Some(buffers).filter(Scratch::is_cached);
        Ok(Some(disparities))
    }

    /// Reports once why the CPU does the GPU's work.
    fn warn(&self, error: &RenderError) {
        let mut on_card = lock(&self.on_card);
        if !std::mem::replace(&mut on_card.has_warned, true) {
            log::warn!("stereo on the GPU failed: {error}; the CPU matches this pair");
        }
    }
}

impl PairMatcher for CardMatcher {
    fn disparities(
        &self,
        matching: &Matching,
        left: &GrayImage,
        right: &GrayImage,
        range: DisparityRange,
    ) -> Result<DisparityMap, StereoError> {
        match self.on_card(matching, [left, right], range) {
            Ok(Some(disparities)) => return Ok(matching.without_specks([left.width(), left.height()], disparities)),
            Ok(None) => {}
            Err(error) => self.warn(&error),
        }
        OnProcessor.disparities(matching, left, right, range)
    }
}

/// A pair that the GPU can match.
#[derive(Debug)]
struct Job<'a> {
    images: [&'a GrayImage; 2],
    sizes: Sizes,
    uniform: StereoMatching,
    is_local: bool,
    by_lines: bool,
}

impl<'a> Job<'a> {
    /// `None` if the CPU has to report its fault, or has to match it.
    fn of(context: &Context, matching: &Matching, images: [&'a GrayImage; 2], range: DisparityRange) -> Option<Self> {
        let [left, right] = images;
        let is_local = match matching.gathering {
            Gathering::SemiGlobal(penalties) if !penalties.are_valid() => return None,
            Gathering::SemiGlobal(_) => false,
            Gathering::Local { .. } => true,
        };
        if left.size_px() != right.size_px() || range.count() > STEREO_MAX_LABELS as usize {
            return None;
        }
        let uniform = StereoMatching::of(left.size_px(), range, matching);
        let sizes = Sizes {
            pixels: left.pixels().len() as u64,
            labels: range.count() as u64,
            is_local,
        };
        (sizes.fit(context) && has_groups(context, &uniform, is_local)).then_some(Self {
            images,
            sizes,
            uniform,
            is_local,
            by_lines: matching.between == Between::Lines,
        })
    }

    /// Disparities before specks are taken out, NaN where there is none.
    fn run(&self, context: &Context, programs: &Programs, scratch: &Scratch) -> Result<Vec<f32>, RenderError> {
        scratch.upload(context, self.images, self.uniform);
        let mut encoder = context
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("stereo") });
        let place = self.record(context, programs, scratch, &mut encoder);
        let readable = scratch.readable();
        encoder.copy_buffer_to_buffer(scratch.labels(place), 0, readable, 0, readable.size());
        context.queue.submit([encoder.finish()]);
        let told = |&label: &f32| if label == NO_LABEL { f32::NAN } else { label };
        let disparities = map_and_read(context, readable, |bytes| {
            let labels: Vec<f32> = bytemuck::pod_collect_to_vec(bytes);
            labels.iter().map(told).collect()
        })?;
        context.check_alive()?;
        Ok(disparities)
    }

    /// Records all passes, and returns the image of labels made last.
    fn record(
        &self,
        context: &Context,
        programs: &Programs,
        scratch: &Scratch,
        encoder: &mut wgpu::CommandEncoder,
    ) -> usize {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("stereo"),
            timestamp_writes: None,
        });
        // Labels ping-pong between two buffers.
        let mut place = 0;
        let mut record = |which: Pass| {
            let group = programs.group(context, which, |binding| match binding {
                BEFORE => scratch.labels(place),
                AFTER => scratch.labels(place + 1),
                other => scratch.bound(other),
            });
            let paths = if which == Pass::AlongPath {
                &PATH_STEPS[..]
            } else {
                &PATH_STEPS[..1]
            };
            for (path, &path_step) in paths.iter().enumerate() {
                let uniform = StereoMatching {
                    path_step,
                    ..self.uniform
                };
                let bound = Bound {
                    group: &group,
                    uniform_offset: scratch.uniform_offset(path),
                };
                programs.dispatch(&mut pass, which, bound, &uniform);
            }
            if matches!(which, Pass::Choose | Pass::Meet | Pass::LayOnPlanes | Pass::Median) {
                place += 1;
            }
        };
        record(Pass::Census);
        if self.is_local {
            record(Pass::SumColumns);
            record(Pass::SumSquares);
        } else {
            record(Pass::AlongPath);
        }
        record(Pass::FindWinners);
        record(Pass::Choose);
        if self.by_lines {
            record(Pass::Meet);
            record(Pass::LayOnPlanes);
        }
        record(Pass::Median);
        place
    }
}
