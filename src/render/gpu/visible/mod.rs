//! Screen-space surfels: compute passes find the visible points of an image, with their normals and radii.
//!
//! **How it works.** The GPU holds all points of the frame, which were uploaded or made of images (`depth_images`). A
//! view uploads uniforms alone; passes of the stages of [`crate::analysis::screen`] (`shaders/screen_normals`) write
//! records of surfels to where the strategy has its own: a storage, uniform or vertex buffer, or one that becomes a
//! texture. So shaders and draw calls are the same as for any other cloud, whatever the strategy, as for gathered nodes
//! (`gather.rs`).
//!
//! The CPU does not learn the number of visible points in time: it would have to wait for it. So there is space for
//! all, and records beyond the visible ones have the radius by which `compute` drops them and other strategies draw
//! nothing. For statistics the number is read back later (`count.rs`).
//!
//! **When it wins.** A real GPU makes the records in a fraction of the CPU's time, and nothing is uploaded. A software
//! adapter is the CPU, which does better with code written for it: there the renderer takes the CPU's records
//! ([`GpuRenderer::set_makes_surfels`](super::GpuRenderer::set_makes_surfels)).
//!
//! Hofer et al. 2018 §3.4 and §3.5.

mod count;
mod passes;
mod record;
mod scratch;
#[cfg(test)]
mod tests;

pub(super) use count::VisibleCount;
pub(super) use passes::SHADER;
pub(super) use record::{CULL_PASS, NORMALS_PASS};

use super::context::Context;
use super::depth_images::DepthMaker;
use super::gpu_data::Screening;
use super::instancing::{RecordBuffer, RecordInstancing, Stream};
use super::primitives::Amplification;
use super::record_buffers::stream_in;
use super::recording::Recording;
use super::residency::{Residency, StreamKey};
use crate::analysis::screen::constants::MAX_LEVELS;
use crate::analysis::screen::with_margin_of_splats;
use crate::scene::VisiblePoints;
use count::CountReader;
use passes::{FOUND, Programs};
use record::{STREAMS, Screened, find_visible, write_surfels};
use scratch::{Scratch, Sizes};
use std::sync::Arc;

/// Makes the surfels of one view at a time.
#[derive(Debug, Default)]
pub(super) struct VisibleMaker {
    programs: Option<Programs>,
    scratch: Option<Scratch>,
    made: Option<Made>,
    count: Option<CountReader>,
}

/// Surfels, or buffers for them.
#[derive(Debug)]
struct Made {
    of: Arc<VisiblePoints>,
    points: StreamKey,
    sizes: Sizes,
    streams: Vec<Stream>,
    /// Allocated buffers of each chunk of each stream.
    record_buffers: Vec<Vec<RecordBuffer>>,
    is_outdated: bool,
}

/// Request for surfels, with the points that they are made from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'a> {
    pub(super) visible: &'a Arc<VisiblePoints>,
    /// All points, which are resident.
    pub(super) points: StreamKey,
    pub(super) chunked_for: &'static Amplification,
}

impl VisibleMaker {
    /// Returns true if the adapter's binding size limit is large enough.
    pub(super) fn can_hold(context: &Context, visible: &VisiblePoints) -> bool {
        let images = visible.images.as_ref();
        images.is_none_or(|images| DepthMaker::can_hold(context, &images.frame))
            && sizes_of(visible, &screening(visible)).fit(context)
    }

    /// Discards the records, which another strategy lays out differently, and all buffers: some may be invalid after a
    /// failed allocation.
    pub(super) fn clear(&mut self) {
        (self.made, self.scratch) = (None, None);
    }

    /// Uploads the view, and allocates space for all points that it could show.
    pub(super) fn ensure(&mut self, context: &Context, instancing: &dyn RecordInstancing, wanted: Wanted<'_>) {
        let Wanted { visible, points, .. } = wanted;
        let is_known = |made: &Made| Arc::ptr_eq(&made.of, visible) && made.points == points;
        if self.made.as_ref().is_some_and(is_known) {
            return;
        }
        self.programs.get_or_insert_with(|| Programs::new(context));
        self.count.get_or_insert_with(|| CountReader::new(context));
        let screening = screening(visible);
        let sizes = sizes_of(visible, &screening);
        let mut record_buffers = self.made.take().map_or_else(Vec::new, |made| made.record_buffers);
        record_buffers.resize_with(STREAMS, Vec::new);
        // Space for all points: the number of visible ones is only known on the GPU, and querying it would stall each
        // image.
        let count = visible.record_count();
        let streams: Vec<Stream> = record_buffers
            .iter_mut()
            .map(|record_buffers| stream_in(context, instancing, count, wanted.chunked_for, record_buffers))
            .collect();
        let scratch = Scratch::for_sizes(context, self.scratch.take(), &sizes);
        self.scratch
            .insert(scratch)
            .upload(context, &uniforms(&screening, &streams[0]));
        self.made = Some(Made {
            of: Arc::clone(visible),
            points,
            sizes,
            streams,
            record_buffers,
            is_outdated: true,
        });
    }

    /// Returns the streams to draw.
    pub(super) fn streams(&self) -> Vec<&Stream> {
        self.made
            .as_ref()
            .map_or_else(Vec::new, |made| made.streams.iter().collect())
    }

    /// Records the passes, unless the records are there. Returns the number of passes.
    pub(super) fn record(&mut self, recording: &mut Recording<'_>, residency: &Residency) -> u64 {
        let (Some(programs), Some(scratch)) = (&self.programs, &self.scratch) else {
            return 0;
        };
        let Some(made) = self.made.as_mut().filter(|made| made.is_outdated) else {
            return 0;
        };
        made.is_outdated = false;
        let points = residency.get(made.points).and_then(Stream::to_gather_from);
        let Some(points) = points.filter(|_| !made.of.points.is_empty()) else {
            return 0;
        };
        let record_buffers: Vec<[&wgpu::Buffer; STREAMS]> = made.record_buffers[0]
            .iter()
            .zip(&made.record_buffers[1])
            .map(|(points, shapes)| [&points.buffer, &shapes.buffer])
            .collect();
        let counts: Vec<u32> = made.streams[0].chunks.iter().map(|chunk| chunk.record_count).collect();
        let screened = Screened {
            programs,
            scratch,
            points,
            sizes: &made.sizes,
        };
        find_visible(recording, &screened);
        write_surfels(recording, &screened, &record_buffers, &counts);
        for record_buffer in made.record_buffers.iter().flatten() {
            record_buffer.copy_to_texture(recording);
        }
        if let Some(count) = &self.count {
            count.ask(recording.encoder(), scratch.buffer(FOUND), made.of.points.len());
        }
        2
    }

    /// Returns the most recent known count of visible points in a view.
    pub(super) fn count(&self) -> Option<VisibleCount> {
        self.count.as_ref()?.last()
    }
}

/// Returns the uniform shared by all passes.
fn screening(visible: &VisiblePoints) -> Screening {
    let view = with_margin_of_splats(&visible.view, &visible.points, visible.cloud.spacing);
    Screening {
        has_holes: visible.images.is_some().into(),
        ..Screening::of(&view, &visible.cloud, visible.record_count() as u32)
    }
}

fn sizes_of(visible: &VisiblePoints, screening: &Screening) -> Sizes {
    Sizes {
        points: visible.record_count() as u32,
        size_px: screening.size_px,
    }
}

/// One uniform for each level of cells, then one for each chunk of records.
fn uniforms(screening: &Screening, stream: &Stream) -> Vec<Screening> {
    let mut uniforms: Vec<Screening> = (0..=MAX_LEVELS)
        .map(|level| Screening { level, ..*screening })
        .collect();
    let mut first = 0;
    for chunk in &stream.chunks {
        let count = chunk.record_count;
        uniforms.push(Screening {
            first,
            count,
            ..*screening
        });
        first += count;
    }
    uniforms
}
