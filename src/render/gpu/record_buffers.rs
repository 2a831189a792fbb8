//! Streams of records that compute passes write: their chunks, in reused buffers.

use super::context::Context;
use super::instancing::{RECORD_BYTES, RecordBuffer, RecordInstancing, Stream};
use super::primitives::Amplification;

/// Maximum capacity of reused buffers, as a multiple of the needed size.
pub(super) const MAX_OVERSIZE: usize = 4;

/// Chunks for this number of records, in `record_buffers` that are large enough. The amplification limits the length of
/// chunks.
pub(super) fn stream_in(
    context: &Context,
    instancing: &dyn RecordInstancing,
    count: usize,
    chunked_for: &'static Amplification,
    record_buffers: &mut Vec<RecordBuffer>,
) -> Stream {
    let max = instancing.max_records(context, chunked_for);
    let mut chunks = Vec::new();
    let mut cached = std::mem::take(record_buffers).into_iter();
    for first in (0..count).step_by(max) {
        let needed = max.min(count - first);
        let fits = |record_buffer: &RecordBuffer| (needed..=MAX_OVERSIZE * needed).contains(&record_buffer.capacity);
        let record_buffer = cached.next().filter(fits);
        let record_buffer =
            record_buffer.unwrap_or_else(|| instancing.record_buffer(context, needed.next_power_of_two().min(max)));
        chunks.push(instancing.chunk_in(context, &record_buffer, needed as u32));
        record_buffers.push(record_buffer);
    }
    Stream {
        chunks,
        byte_size: (count * RECORD_BYTES) as u64,
    }
}
