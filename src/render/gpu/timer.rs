//! GPU time of a picture, by two timestamps around its passes.
//!
//! Timestamps can be missing, zero or run backwards; then there is no time rather than a wrong one. The window never
//! waits for them: a measurement that is still under way when the next picture starts is left alone.

use super::context::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

const QUERY_BYTES: u64 = 2 * wgpu::QUERY_SIZE as u64;

const IDLE: u8 = 0;
const IN_FLIGHT: u8 = 1;
const MAPPED: u8 = 2;

#[derive(Debug)]
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    state: Arc<AtomicU8>,
    recorded: bool,
    last_ms: Option<f64>,
}

impl Timer {
    /// `None` where the adapter has no timestamps.
    pub(super) fn new(context: &Context) -> Option<Self> {
        if !context.has_timestamps {
            return None;
        }
        let buffer = |usage| {
            context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: QUERY_BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            queries: context.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
            state: Arc::new(AtomicU8::new(IDLE)),
            recorded: false,
            last_ms: None,
        })
    }

    pub(super) fn begin(&mut self, context: &Context, encoder: &mut wgpu::CommandEncoder) {
        self.collect(context);
        self.recorded = self.state.load(Ordering::Acquire) == IDLE;
        if self.recorded {
            encoder.write_timestamp(&self.queries, 0);
        }
    }

    /// Asks for the result as well, which comes some time after the commands were submitted.
    pub(super) fn end(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if !std::mem::take(&mut self.recorded) {
            return;
        }
        encoder.write_timestamp(&self.queries, 1);
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, QUERY_BYTES);
        self.state.store(IN_FLIGHT, Ordering::Release);
        let state = Arc::clone(&self.state);
        encoder.map_buffer_on_submit(&self.readable, wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { MAPPED } else { IDLE }, Ordering::Release);
        });
    }

    /// Takes a result that has arrived.
    fn collect(&mut self, context: &Context) {
        // Lets callbacks run. A lost device is reported elsewhere.
        let _ = context.device.poll(wgpu::PollType::Poll);
        if self.state.load(Ordering::Acquire) == MAPPED {
            let ticks = self.readable.slice(..).get_mapped_range();
            let period_ns = context.queue.get_timestamp_period();
            self.last_ms = ticks
                .ok()
                .and_then(|ticks| elapsed_ms(&bytemuck::pod_collect_to_vec::<u8, u64>(&ticks), period_ns));
            self.readable.unmap();
            self.state.store(IDLE, Ordering::Release);
        }
    }

    /// The last time that arrived, without waiting.
    pub(super) fn last_ms(&self) -> Option<f64> {
        self.last_ms
    }

    /// Waits for the time of the last picture.
    pub(super) fn wait_ms(&mut self, context: &Context) -> Option<f64> {
        context.wait().ok()?;
        self.collect(context);
        self.last_ms
    }
}

fn elapsed_ms(ticks: &[u64], period_ns: f32) -> Option<f64> {
    let [begin, end] = ticks else { return None };
    let elapsed = end.checked_sub(*begin).filter(|&elapsed| elapsed > 0 && *begin > 0)?;
    Some(elapsed as f64 * f64::from(period_ns) * 1e-6)
}

#[cfg(test)]
mod tests {
    use super::elapsed_ms;

    #[test]
    fn only_timestamps_that_make_sense_give_a_time() {
        assert_eq!(elapsed_ms(&[1_000, 3_001_000], 1.0), Some(3.0));
        assert_eq!(elapsed_ms(&[1_000, 2_000], 1000.0), Some(1.0));
        assert_eq!(elapsed_ms(&[0, 0], 1.0), None, "never written");
        assert_eq!(elapsed_ms(&[0, 7], 1.0), None, "half written");
        assert_eq!(elapsed_ms(&[9, 7], 1.0), None, "backwards");
    }
}
