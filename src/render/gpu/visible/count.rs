//! Visible point count of an image, read back from the GPU without waiting for it.
//!
//! The number arrives some images late. A readback that is in progress when the next image is made is left alone; that
//! image's count is then never read.

use super::scratch::FOUND_BYTES;
use crate::locks::lock;
use crate::render::gpu::context::Context;
use crate::render::gpu::late_read::LateRead;
use std::sync::Mutex;

/// Offset of the visible point count in `Found`, words.
const VISIBLE_WORD: usize = 3;

/// Reads `Found` of `screen_normals/view.wgsl` back.
#[derive(Debug)]
pub(super) struct CountReader {
    late: LateRead,
    /// Readback in progress, and the counts received.
    counts: Mutex<Counts>,
}

#[derive(Debug, Default)]
struct Counts {
    points_asked: usize,
    last: Option<VisibleCount>,
}

/// Visible point count of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render::gpu) struct VisibleCount {
    /// Points that might have been seen.
    pub(in crate::render::gpu) points: usize,
    /// Visible points.
    pub(in crate::render::gpu) visible: usize,
}

impl CountReader {
    pub(super) fn new(context: &Context) -> Self {
        Self {
            late: LateRead::new(context, "visible points", FOUND_BYTES),
            counts: Mutex::default(),
        }
    }

    /// Requests the number for a view of this many points, unless another request is under way. To be recorded after it
    /// is known.
    pub(super) fn ask(&self, encoder: &mut wgpu::CommandEncoder, found: &wgpu::Buffer, points: usize) {
        self.last();
        if self.late.ask(encoder, found, FOUND_BYTES) {
            lock(&self.counts).points_asked = points;
        }
    }

    /// The last number that has come.
    pub(super) fn last(&self) -> Option<VisibleCount> {
        let mut counts = lock(&self.counts);
        let points = counts.points_asked;
        let of_words = |words: Vec<u32>| {
            let visible = *words.get(VISIBLE_WORD)? as usize;
            Some(VisibleCount { points, visible })
        };
        let come = self.late.take(|words| words.and_then(of_words));
        counts.last = come.unwrap_or(counts.last);
        counts.last
    }
}
