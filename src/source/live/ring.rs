//! The newest frames, as they came.

use crate::locks::lock;
use crate::wire::Frame;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Maximum size of all frames together, in bytes: ten seconds of uncompressed 640 × 480 at 30 frames per second.
const MAX_BYTES: usize = 512 << 20;

/// Frames at most, of streams of tiny ones.
const MAX_FRAMES: usize = 1 << 14;

/// A frame, and when it came.
#[derive(Debug)]
pub(super) struct Held {
    pub(super) frame: Frame,
    /// Since the first frame.
    pub(super) time: Duration,
    arrived: Instant,
}

/// The newest frames.
#[derive(Debug)]
pub(super) struct Ring {
    frames: Mutex<Frames>,
    comes: Condvar,
    /// Older frames are dropped.
    keeps: Duration,
}

#[derive(Debug, Default)]
struct Frames {
    /// The newest last.
    newest: VecDeque<Arc<Held>>,
    byte_size: usize,
    /// Frames that have come.
    count: usize,
}

impl Ring {
    pub(super) fn new(keeps: Duration) -> Self {
        Self {
            frames: Mutex::default(),
            comes: Condvar::default(),
            keeps,
        }
    }

    pub(super) fn push(&self, frame: Frame, time: Duration, now: Instant) {
        let mut frames = lock(&self.frames);
        frames.byte_size += frame.byte_size;
        frames.count += 1;
        frames.newest.push_back(Arc::new(Held {
            frame,
            time,
            arrived: now,
        }));
        while let Some(oldest) = frames.newest.front()
            && frames.newest.len() > 1
        {
            let is_old = now.saturating_duration_since(oldest.arrived) > self.keeps;
            if !is_old && frames.byte_size <= MAX_BYTES && frames.newest.len() <= MAX_FRAMES {
                break;
            }
            let gone = frames.newest.pop_front().map_or(0, |held| held.frame.byte_size);
            frames.byte_size -= gone;
        }
        drop(frames);
        self.comes.notify_all();
    }

    /// Until there are more than `count` frames, or that time is over.
    pub(super) fn wait(&self, count: usize, at_most: Duration) {
        let frames = lock(&self.frames);
        let waited = self
            .comes
            .wait_timeout_while(frames, at_most, |frames| frames.count <= count);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    /// The frames that are there.
    pub(super) fn range(&self) -> Range<usize> {
        let frames = lock(&self.frames);
        frames.count - frames.newest.len()..frames.count
    }

    /// Frame `index`; `None` where it is gone, or has not come.
    pub(super) fn frame(&self, index: usize) -> Option<Arc<Held>> {
        let frames = lock(&self.frames);
        let oldest = frames.count - frames.newest.len();
        frames.newest.get(index.checked_sub(oldest)?).cloned()
    }

    /// The newest frame.
    pub(super) fn newest(&self) -> Option<Arc<Held>> {
        lock(&self.frames).newest.back().cloned()
    }

    /// Seconds from the oldest to the newest frame, and bytes of all.
    pub(super) fn buffered(&self) -> (f64, usize) {
        let frames = lock(&self.frames);
        let span = frames.newest.front().zip(frames.newest.back());
        let span = span.map_or(Duration::ZERO, |(first, last)| last.time.saturating_sub(first.time));
        (span.as_secs_f64(), frames.byte_size)
    }
}
