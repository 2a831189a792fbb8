//! How many points a picture shows, read back from the card without waiting for it.
//!
//! The number comes some pictures late. One that is under way when the next picture is made is left alone; that
//! picture's is then never read.

use super::scratch::FOUND_BYTES;
use crate::locks::lock;
use crate::render::gpu::context::Context;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex};

const IDLE: u8 = 0;
const IN_FLIGHT: u8 = 1;
const MAPPED: u8 = 2;
const READING: u8 = 3;

/// Where the number is in `Found`, words.
const VISIBLE_WORD: usize = 3;

/// Reads `Found` of `screen_normals/view.wgsl` back.
#[derive(Debug)]
pub(super) struct CountReader {
    readable: wgpu::Buffer,
    state: Arc<AtomicU8>,
    /// What is under way, and what has come.
    counts: Mutex<Counts>,
}

#[derive(Debug, Default)]
struct Counts {
    points_asked: usize,
    last: Option<VisibleCount>,
}

/// What was found of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render::gpu) struct VisibleCount {
    /// Points that might have been seen.
    pub(in crate::render::gpu) points: usize,
    /// Those that were.
    pub(in crate::render::gpu) visible: usize,
}

impl CountReader {
    pub(super) fn new(context: &Context) -> Self {
        Self {
            readable: context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("visible points"),
                size: FOUND_BYTES,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            state: Arc::new(AtomicU8::new(IDLE)),
            counts: Mutex::default(),
        }
    }

    /// Asks for the number of a view of so many points, unless another one is under way. To be recorded after it is
    /// known.
    pub(super) fn ask(&self, encoder: &mut wgpu::CommandEncoder, found: &wgpu::Buffer, points: usize) {
        self.last();
        let is_idle = self
            .state
            .compare_exchange(IDLE, IN_FLIGHT, Ordering::AcqRel, Ordering::Acquire);
        if is_idle.is_err() {
            return;
        }
        lock(&self.counts).points_asked = points;
        encoder.copy_buffer_to_buffer(found, 0, &self.readable, 0, FOUND_BYTES);
        let state = Arc::clone(&self.state);
        encoder.map_buffer_on_submit(&self.readable, wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { MAPPED } else { IDLE }, Ordering::Release);
        });
    }

    /// The last number that has come.
    pub(super) fn last(&self) -> Option<VisibleCount> {
        let mut counts = lock(&self.counts);
        let has_come = self
            .state
            .compare_exchange(MAPPED, READING, Ordering::AcqRel, Ordering::Acquire);
        if has_come.is_ok() {
            let words = self.readable.slice(..).get_mapped_range();
            let words = words.map(|bytes| bytemuck::pod_collect_to_vec::<u8, u32>(&bytes));
            counts.last = words.ok().and_then(|words| {
                Some(VisibleCount {
                    points: counts.points_asked,
                    visible: *words.get(VISIBLE_WORD)? as usize,
                })
            });
            self.readable.unmap();
            self.state.store(IDLE, Ordering::Release);
        }
        counts.last
    }
}
