//! Prefetching: frames ahead of the playhead, made by worker threads, kept within a byte budget.
//!
//! [`Loader::request`] sets the playhead and the needs of its images; it never blocks. Workers make that frame first,
//! then those the playhead will reach ([`queue`] has their order, [`cache`] the evictions for them). When a frame is
//! finished the loader calls `wake`; [`Loader::get`] then has it. A frame that cannot be read is remembered with its
//! error and played over.

mod cache;
mod facts;
mod options;
mod queue;
mod readings;
#[cfg(test)]
pub(crate) mod simulation;
pub(crate) mod stages;
mod stats;
mod worker;

pub use facts::FrameFacts;
pub use options::LoaderOptions;
pub use readings::{Reading, ReadingStage};
pub use stats::{FrameState, LoaderStats};

use super::{FrameError, Needs, PreparedFrame, Sequence, SequenceError};
use crate::timeline::{Direction, LoopMode, PlayRange, Travel};
use cache::Focus;
use queue::{Queue, Waiter};
use readings::Readings;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::Duration;
use worker::Shared;

/// A frame as it is now.
#[derive(Debug, Clone)]
pub enum Slot {
    /// Here, with everything needed.
    Ready(Arc<PreparedFrame>),
    /// Here with everything needed, but of fewer points than its file has: an image that may be shown instead.
    Coarse(Arc<PreparedFrame>),
    /// A large frame being loaded: some of its points, or all of them without estimates. To be shown as points
    /// meanwhile.
    Partial(Arc<PreparedFrame>),
    /// Here for older needs: an image to show meanwhile.
    Stale(Arc<PreparedFrame>),
    /// Not here.
    Pending,
    /// It cannot be shown.
    Failed(Arc<FrameError>),
}

/// Prepares the frames of one sequence on its own threads. Dropping it stops them, and their reading.
pub struct Loader {
    shared: Arc<Shared>,
    threads: Vec<thread::JoinHandle<()>>,
    next_ticket: AtomicU64,
}

impl Loader {
    /// Starts the worker threads; they sleep until the first request.
    ///
    /// # Errors
    /// [`SequenceError::NoThread`] if the system does not give a single thread.
    pub fn new(sequence: Arc<Sequence>, options: LoaderOptions) -> Result<Self, SequenceError> {
        let workers = options.workers.max(1);
        let mut loader = Self::without_threads(sequence, options)?;
        for number in 0..workers {
            let pool = worker::pool(1)?;
            let shared = Arc::clone(&loader.shared);
            let started = thread::Builder::new()
                .name(format!("frame loader {number}"))
                .spawn(move || pool.install(|| worker::run(&shared)));
            match started {
                Ok(thread) => loader.threads.push(thread),
                Err(reason) if loader.threads.is_empty() => {
                    return Err(SequenceError::NoThread { reason });
                }
                Err(reason) => {
                    log::warn!("frames load on {number} threads, no more start: {reason}");
                    break;
                }
            }
        }
        Ok(loader)
    }

    fn without_threads(sequence: Arc<Sequence>, options: LoaderOptions) -> Result<Self, SequenceError> {
        let focus = Focus {
            travel: Travel::whole(sequence.len(), LoopMode::default()),
            playhead: 0,
            direction: Direction::Forward,
        };
        Ok(Self {
            shared: Arc::new(Shared {
                pool: worker::pool(options.workers.max(1))?,
                first_pool: worker::first_pool(options.workers.max(1))?,
                queue: Mutex::new(Queue::new(Arc::clone(&sequence), focus, &options)),
                sequence,
                readings: Readings::default(),
                machine_bytes: options.machine_bytes,
                work: Condvar::new(),
                finished: Condvar::new(),
                counters: super::PrepareCounters::default(),
                wake: options.wake,
            }),
            threads: Vec::new(),
            next_ticket: AtomicU64::new(0),
        })
    }

    /// The sequence.
    pub fn sequence(&self) -> &Arc<Sequence> {
        &self.shared.sequence
    }

    /// Sets the playhead, its direction and the needs of images. Never blocks; costs the same for any length of the
    /// sequence. A playhead beyond the end is the last frame.
    pub fn request(&self, playhead: usize, direction: Direction, needs: &Needs) {
        let mut queue = self.shared.queue();
        let Some(last) = queue.cache.frame_count().checked_sub(1) else {
            return;
        };
        let playhead = playhead.min(last);
        let focus = Focus {
            playhead,
            direction,
            ..queue.focus
        };
        if queue.focus == focus && queue.needs.as_ref() == Some(needs) {
            return;
        }
        if queue.needs.as_ref() != Some(needs) {
            queue.cache.forget_sizes();
            queue.cache.facts.changed();
            queue.effort.forget();
            queue.revision += 1;
        }
        queue.focus = focus;
        queue.needs = Some(*needs);
        queue.trim();
        // A running estimation of normals that is no longer needed would occupy both cores for many seconds.
        self.shared.readings.supersede(|index| queue.is_complete(index, needs));
        drop(queue);
        self.shared.work.notify_all();
    }

    /// Sets the behaviour at the ends, so that the right frames are prepared there. [`LoopMode::Loop`] until then.
    pub fn set_loop_mode(&self, loop_mode: LoopMode) {
        self.shared.queue().focus.travel.loop_mode = loop_mode;
        self.shared.work.notify_all();
    }

    /// Sets the frames that play: others are not prepared ahead, and are the first to be evicted. All until then.
    pub fn set_range(&self, range: PlayRange) {
        self.shared.queue().focus.travel.range = range;
        self.shared.work.notify_all();
    }

    /// Sets the duration of a frame while playing, or that nothing is played: then frames are made with all their
    /// points, else with the number there is time for.
    pub fn set_interval(&self, interval: Option<Duration>) {
        if self.shared.queue().effort.set_interval(interval) {
            self.shared.work.notify_all();
        }
    }

    /// Records how long an image of a frame with this number of points took while playing: if it was too long, frames
    /// of fewer points are made.
    pub fn note_drawn(&self, points: usize, picture_ms: f64) {
        let mut queue = self.shared.queue();
        let before = queue.effort.at_best();
        queue.effort.note_drawn(points, picture_ms);
        if queue.effort.at_best() != before {
            drop(queue);
            self.shared.work.notify_all();
        }
    }

    /// Takes the frames by which the sequence has grown, and that old ones are gone.
    pub fn grow(&self) {
        let mut queue = self.shared.queue();
        let Range { start, end } = self.shared.sequence.frames();
        queue.cache.grow(end);
        (queue.focus.travel.first, queue.focus.travel.frame_count) = (start, end);
        queue.revision += 1;
        drop(queue);
        self.shared.work.notify_all();
    }

    /// Discards data read of `frames`, as their files changed.
    pub fn forget(&self, frames: &[usize]) {
        let mut queue = self.shared.queue();
        for &frame in frames {
            queue.cache.forget(frame);
        }
        queue.revision += 1;
        drop(queue);
        self.shared.work.notify_all();
    }

    /// Frame `index` as it is now; starts nothing. An index beyond the end has failed.
    pub fn get(&self, index: usize, needs: &Needs) -> Slot {
        if let Err(error) = self.check_index(index) {
            return Slot::Failed(Arc::new(error));
        }
        let queue = self.shared.queue();
        if let Some(error) = queue.cache.error(index) {
            return Slot::Failed(Arc::clone(error));
        }
        let stale = || queue.cache.full(index).or(queue.cache.coarse(index));
        match (queue.best(index, needs), queue.partial(index)) {
            (Some(frame), _) if !frame.is_sample() => return Slot::Ready(Arc::clone(frame)),
            (Some(frame), None) => return Slot::Coarse(Arc::clone(frame)),
            _ => {}
        }
        match (queue.partial(index), stale()) {
            (Some(frame), _) => Slot::Partial(Arc::clone(frame)),
            (None, Some(frame)) => Slot::Stale(Arc::clone(frame)),
            (None, None) => Slot::Pending,
        }
    }

    /// Prepares frame `index` before all others and blocks until it is there. The earlier request continues alongside
    /// it; without a request nothing but this frame is prepared.
    pub fn wait(&self, index: usize, needs: &Needs) -> Result<Arc<PreparedFrame>, FrameError> {
        self.check_index(index)?;
        let mut queue = self.shared.queue();
        if let Some(error) = queue.cache.error(index) {
            return Err((**error).clone());
        }
        if let Some(frame) = queue.cache.full(index)
            && frame.satisfies(needs)
        {
            return Ok(Arc::clone(frame));
        }
        if queue.needs.is_none() {
            // Nothing is playing: the surroundings of this frame are worth caching.
            queue.focus.playhead = index;
        }
        let ticket = self.next_ticket.fetch_add(1, Ordering::Relaxed);
        queue.waiters.push(Waiter {
            ticket,
            index,
            needs: *needs,
            outcome: None,
        });
        self.shared.work.notify_all();
        loop {
            let place = queue
                .waiters
                .iter()
                .position(|waiter| waiter.ticket == ticket && waiter.outcome.is_some());
            if let Some(outcome) = place.and_then(|place| queue.waiters.swap_remove(place).outcome) {
                return outcome.map_err(|error| (*error).clone());
            }
            queue = Shared::sleep(&self.shared.finished, queue);
        }
    }

    /// The state of every frame for the timeline. O(n): ask again when [`Loader::revision`] has changed.
    pub fn states(&self) -> Vec<FrameState> {
        let queue = self.shared.queue();
        let first = queue.focus.travel.first;
        queue.cache.states(queue.needs.as_ref(), first)
    }

    /// Returns the facts known of every frame; `None` for those that were never prepared. O(n): query again when
    /// [`Loader::facts_revision`] has changed.
    pub fn facts(&self) -> Vec<Option<FrameFacts>> {
        let queue = self.shared.queue();
        let stop = queue.needs.and_then(|needs| Some(needs.levels?.stop));
        queue.cache.facts.of(queue.cache.frame_count(), stop)
    }

    /// A number that changes whenever [`Loader::facts`] may have.
    pub fn facts_revision(&self) -> u64 {
        self.shared.queue().cache.facts.revision()
    }

    /// Returns true if a worker is busy with a frame.
    pub fn is_busy(&self) -> bool {
        self.shared.queue().cache.in_flight() > 0
    }

    /// The frames that are being read. Each can be cancelled: its frame has failed then, as [`FrameError::Cancelled`].
    pub fn readings(&self) -> Vec<Reading> {
        self.shared.readings.list()
    }

    /// Returns true if the reading of a frame was cancelled, even if it is over.
    pub fn was_cancelled(&self) -> bool {
        self.shared.readings.was_cancelled()
    }

    /// A number that changes whenever [`Loader::states`] may have.
    pub fn revision(&self) -> u64 {
        self.shared.queue().revision
    }

    /// Work done so far and memory in use.
    pub fn stats(&self) -> LoaderStats {
        let counters = &self.shared.counters;
        let queue = self.shared.queue();
        LoaderStats {
            decoded: self.shared.sequence.decode_count(),
            surfaces_estimated: counters.surfaces_estimated(),
            radii_estimated: counters.radii_estimated(),
            ellipses_estimated: counters.ellipses_estimated(),
            octrees_built: counters.octrees_built(),
            records_written: counters.records_written(),
            cancelled: queue.cancelled,
            evicted: queue.cache.evicted(),
            failed_frames: queue.cache.failed_frames(),
            resident_frames: queue.cache.resident_frames(),
            resident_bytes: queue.cache.resident_bytes(),
            coarse_frames: queue.cache.coarse_frames(),
            coarse_bytes: queue.cache.coarse_bytes(),
            detail: queue.effort.in_time(),
            in_flight_bytes: queue.used_bytes() - queue.cache.resident_bytes() - queue.cache.coarse_bytes(),
            peak_bytes: queue.peak_bytes,
            budget_bytes: queue.cache.budget_bytes(),
        }
    }

    /// Sets the memory for prepared frames; any excess is evicted at once.
    pub fn set_budget_bytes(&self, budget_bytes: usize) {
        let mut queue = self.shared.queue();
        queue.cache.set_budget_bytes(budget_bytes);
        queue.trim();
        drop(queue);
        self.shared.work.notify_all();
    }

    fn check_index(&self, index: usize) -> Result<(), FrameError> {
        let count = self.shared.queue().cache.frame_count();
        if index < count {
            Ok(())
        } else {
            Err(FrameError::NoSuchFrame { index, count })
        }
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.shared.queue().shutdown = true;
        self.shared.readings.end();
        self.shared.work.notify_all();
        for thread in self.threads.drain(..) {
            if thread.join().is_err() {
                log::error!("a frame loader thread ended by a panic");
            }
        }
    }
}

impl std::fmt::Debug for Loader {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Loader")
            .field("sequence", &self.shared.sequence)
            .field("stats", &self.stats())
            .finish_non_exhaustive()
    }
}
