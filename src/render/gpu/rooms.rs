//! Streams of records that compute passes write: their chunks, in rooms that are used again.

use super::context::Context;
use super::instancing::{RECORD_BYTES, RecordInstancing, Room, Stream};
use super::primitives::Amplification;

/// Maximum capacity of reused buffers, as a multiple of what is needed.
pub(super) const MAX_ROOM: usize = 4;

/// Chunks for so many records, in `rooms` that are large enough. The amplification says how long chunks may be.
pub(super) fn stream_in(
    context: &Context,
    instancing: &dyn RecordInstancing,
    count: usize,
    chunked_for: &'static Amplification,
    rooms: &mut Vec<Room>,
) -> Stream {
    let max = instancing.max_records(context, chunked_for);
    let mut chunks = Vec::new();
    let mut kept = std::mem::take(rooms).into_iter();
    for first in (0..count).step_by(max) {
        let needed = max.min(count - first);
        let fits = |room: &Room| (needed..=MAX_ROOM * needed).contains(&room.capacity);
        let room = kept.next().filter(fits);
        let room = room.unwrap_or_else(|| instancing.room(context, needed.next_power_of_two().min(max)));
        chunks.push(instancing.chunk_in(context, &room, needed as u32));
        rooms.push(room);
    }
    Stream {
        chunks,
        byte_size: (count * RECORD_BYTES) as u64,
    }
}
