//! A few bytes of the GPU, read back without waiting for them: they come some frames late.

use super::context::Context;
use bytemuck::{AnyBitPattern, NoUninit};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

const IDLE: u8 = 0;
const IN_FLIGHT: u8 = 1;
const MAPPED: u8 = 2;
const READING: u8 = 3;

/// A staging buffer for one reading at a time.
#[derive(Debug)]
pub(super) struct LateRead {
    readable: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

impl LateRead {
    /// Creates a readback buffer of at most the given number of bytes.
    pub(super) fn new(context: &Context, label: &'static str, bytes: u64) -> Self {
        Self {
            readable: context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            state: Arc::new(AtomicU8::new(IDLE)),
        }
    }

    /// Returns true if no readback is in progress.
    pub(super) fn is_idle(&self) -> bool {
        self.state.load(Ordering::Acquire) == IDLE
    }

    /// Requests the first bytes of a buffer as they are after the commands so far; false if others are under way.
    pub(super) fn ask(&self, encoder: &mut wgpu::CommandEncoder, from: &wgpu::Buffer, bytes: u64) -> bool {
        if !self.goes_on(IDLE, IN_FLIGHT) {
            return false;
        }
        encoder.copy_buffer_to_buffer(from, 0, &self.readable, 0, bytes);
        let state = Arc::clone(&self.state);
        encoder.map_buffer_on_submit(&self.readable, wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { MAPPED } else { IDLE }, Ordering::Release);
        });
        true
    }

    /// Hands over the bytes received, once: none if they cannot be read.
    pub(super) fn take<T: AnyBitPattern + NoUninit, R>(&self, of: impl FnOnce(Option<Vec<T>>) -> R) -> Option<R> {
        if !self.goes_on(MAPPED, READING) {
            return None;
        }
        let bytes = self.readable.slice(..).get_mapped_range();
        let numbers = bytes.ok().map(|bytes| bytemuck::pod_collect_to_vec::<u8, T>(&bytes));
        self.readable.unmap();
        self.state.store(IDLE, Ordering::Release);
        Some(of(numbers))
    }

    fn goes_on(&self, from: u8, to: u8) -> bool {
        let exchanged = self
            .state
            .compare_exchange(from, to, Ordering::AcqRel, Ordering::Acquire);
        exchanged.is_ok()
    }
}
