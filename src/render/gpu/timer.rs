//! GPU time of an image, by two timestamps for each of its passes: when it begins and when it ends.
//!
//! Timestamps can be missing, zero or run backwards; then there is no time rather than a wrong one. The window never
//! waits for them: a measurement that is still under way when the next image starts is left alone.

use super::context::Context;
use super::late_read::LateRead;
use crate::render::{PassTime, PassTimes};

const QUERY_COUNT: u32 = 2 * PassTimes::MAX as u32;
const QUERY_BYTES: u64 = wgpu::QUERY_SIZE as u64;

#[derive(Debug)]
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    late: LateRead,
    recorded: bool,
    /// The passes of the timed image.
    passes: Vec<&'static str>,
    last: GpuTimes,
}

/// GPU timings of an image.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct GpuTimes {
    /// From the beginning of the first pass to the end of the last.
    pub(super) total_ms: Option<f64>,
    pub(super) passes: PassTimes,
}

/// Timestamp query locations of a pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stamps<'a> {
    queries: &'a wgpu::QuerySet,
    begin: u32,
}

impl Timer {
    /// `None` if the adapter has no timestamps.
    pub(super) fn new(context: &Context) -> Option<Self> {
        if !context.has_timestamps {
            return None;
        }
        let bytes = QUERY_BYTES * u64::from(QUERY_COUNT);
        Some(Self {
            queries: context.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: QUERY_COUNT,
            }),
            resolved: context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: bytes,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            late: LateRead::new(context, "timestamps", bytes),
            recorded: false,
            passes: Vec::new(),
            last: GpuTimes::default(),
        })
    }

    /// Begins an image.
    pub(super) fn begin(&mut self, context: &Context) {
        self.collect(context);
        self.recorded = self.late.is_idle();
        if self.recorded {
            self.passes.clear();
        }
    }

    /// Returns the timestamp locations of the next pass, if it is timed.
    pub(super) fn stamps(&mut self, pass: &'static str) -> Option<Stamps<'_>> {
        if !self.recorded || self.passes.len() == PassTimes::MAX {
            return None;
        }
        let begin = 2 * self.passes.len() as u32;
        self.passes.push(pass);
        Some(Stamps {
            queries: &self.queries,
            begin,
        })
    }

    /// Requests the result as well, which comes some time after the commands were submitted.
    pub(super) fn end(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let count = 2 * self.passes.len() as u32;
        if !std::mem::take(&mut self.recorded) || count == 0 {
            return;
        }
        let bytes = QUERY_BYTES * u64::from(count);
        encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
        self.late.ask(encoder, &self.resolved, bytes);
    }

    /// Takes a result that has arrived.
    fn collect(&mut self, context: &Context) {
        // Runs pending callbacks. A lost device is reported elsewhere.
        let _ = context.device.poll(wgpu::PollType::Poll);
        let period_ns = context.queue.get_timestamp_period();
        let of_ticks = |ticks: Vec<u64>| GpuTimes::of(&self.passes, &ticks, period_ns);
        let come = self.late.take(|ticks| ticks.map_or_else(GpuTimes::default, of_ticks));
        self.last = come.unwrap_or(self.last);
    }

    /// The last times that arrived, without waiting.
    pub(super) fn last(&self) -> GpuTimes {
        self.last
    }

    /// Waits for the times of the last image.
    pub(super) fn wait(&mut self, context: &Context) -> Option<GpuTimes> {
        context.wait().ok()?;
        self.collect(context);
        Some(self.last)
    }
}

impl<'a> Stamps<'a> {
    pub(super) fn of_render(self) -> wgpu::RenderPassTimestampWrites<'a> {
        wgpu::RenderPassTimestampWrites {
            query_set: self.queries,
            beginning_of_pass_write_index: Some(self.begin),
            end_of_pass_write_index: Some(self.begin + 1),
        }
    }

    pub(super) fn of_compute(self) -> wgpu::ComputePassTimestampWrites<'a> {
        wgpu::ComputePassTimestampWrites {
            query_set: self.queries,
            beginning_of_pass_write_index: Some(self.begin),
            end_of_pass_write_index: Some(self.begin + 1),
        }
    }
}

impl GpuTimes {
    /// Computes the timings of passes with a pair of ticks each.
    fn of(passes: &[&'static str], ticks: &[u64], period_ns: f32) -> Self {
        let pairs = ticks.as_chunks().0;
        let passes = passes.iter().zip(pairs);
        let last = passes.len().checked_sub(1).map(|last| pairs[last][1]);
        Self {
            total_ms: ticks
                .first()
                .zip(last)
                .and_then(|(&begin, end)| elapsed_ms([begin, end], period_ns)),
            passes: passes
                .map(|(&pass, &ticks)| PassTime {
                    pass,
                    gpu_ms: elapsed_ms(ticks, period_ns),
                })
                .collect(),
        }
    }
}

fn elapsed_ms([begin, end]: [u64; 2], period_ns: f32) -> Option<f64> {
    let elapsed = end.checked_sub(begin).filter(|&elapsed| elapsed > 0 && begin > 0)?;
    Some(elapsed as f64 * f64::from(period_ns) * 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_valid_timestamps_give_a_time() {
        assert_eq!(elapsed_ms([1_000, 3_001_000], 1.0), Some(3.0));
        assert_eq!(elapsed_ms([1_000, 2_000], 1000.0), Some(1.0));
        assert_eq!(elapsed_ms([0, 0], 1.0), None, "never written");
        assert_eq!(elapsed_ms([0, 7], 1.0), None, "half written");
        assert_eq!(elapsed_ms([9, 7], 1.0), None, "backwards");
    }

    #[test]
    fn each_pass_has_a_timestamp_pair_and_the_total_spans_first_to_last() {
        let ticks = [1_000_000, 2_000_000, 2_500_000, 2_400_000, 3_000_000, 5_000_000, 0, 0];
        let times = GpuTimes::of(&["first", "backwards", "last"], &ticks, 1.0);
        assert_eq!(times.total_ms, Some(4.0));
        let passes: Vec<_> = times.passes.iter().map(|time| (time.pass, time.gpu_ms)).collect();
        assert_eq!(passes, [("first", Some(1.0)), ("backwards", None), ("last", Some(2.0))]);
        assert_eq!(GpuTimes::of(&[], &ticks, 1.0), GpuTimes::default());
    }
}
