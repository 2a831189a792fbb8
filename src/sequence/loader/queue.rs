//! Which frame a worker takes next.
//!
//! **How it works.** There is no list of queued work that could become outdated. A worker that is free looks at the plan as it is
//! now: frames somebody waits for, then the playhead's, then those the playhead will reach, in that order, and takes the
//! first that is neither there nor failed nor in flight. What the playhead has passed, or what was wanted for older
//! needs, is thereby forgotten at once. Work in flight asks between its stages whether it is still wanted.
//!
//! A look costs at most [`LOOK_AHEAD_FRAMES`] steps, whatever the length of the sequence.

use super::cache::{Cache, Focus};
use crate::sequence::{FrameError, LoopMode, Needs, PreparedFrame, Sequence};
use std::sync::Arc;

/// How far ahead frames are prepared, if the budget allows: ten seconds of film.
pub(super) const LOOK_AHEAD_FRAMES: usize = 256;

/// These many frames ahead of the playhead are prepared even if others of the loop have to go for them.
const ALWAYS_AHEAD_FRAMES: usize = 4;

/// Somebody who blocks until a frame is there.
#[derive(Debug)]
pub(super) struct Waiter {
    pub(super) ticket: u64,
    pub(super) index: usize,
    pub(super) needs: Needs,
    pub(super) outcome: Option<Result<Arc<PreparedFrame>, Arc<FrameError>>>,
}

/// What a worker is to do.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) index: usize,
    pub(super) needs: Needs,
    /// Prepared for other needs: to be completed, not decoded.
    pub(super) existing: Option<Arc<PreparedFrame>>,
}

/// All that workers and the interface share, under one lock.
#[derive(Debug)]
pub(super) struct Queue {
    pub(super) cache: Cache,
    pub(super) focus: Focus,
    /// Needs of the last request; `None` before the first: then only waiters are served.
    pub(super) needs: Option<Needs>,
    pub(super) waiters: Vec<Waiter>,
    pub(super) shutdown: bool,
    pub(super) cancelled: u64,
    pub(super) peak_bytes: usize,
    /// Changes whenever a frame's state does.
    pub(super) revision: u64,
    sequence: Arc<Sequence>,
}

impl Queue {
    pub(super) fn new(sequence: Arc<Sequence>, focus: Focus, budget_bytes: usize) -> Self {
        Self {
            cache: Cache::new(sequence.len(), budget_bytes),
            focus,
            needs: None,
            waiters: Vec::new(),
            shutdown: false,
            cancelled: 0,
            peak_bytes: 0,
            revision: 0,
            sequence,
        }
    }

    /// Resident, in flight, and the frame kept since the origin was decided.
    pub(super) fn used_bytes(&self) -> usize {
        self.cache.used_bytes() + self.sequence.kept_bytes()
    }

    /// The next frame to work on, reserved for the caller; `None` when there is nothing to do now.
    pub(super) fn next_job(&mut self) -> Option<Job> {
        self.waiters_job().or_else(|| self.planned_job())
    }

    fn waiters_job(&mut self) -> Option<Job> {
        let waiter = self
            .waiters
            .iter()
            .find(|waiter| waiter.outcome.is_none() && !self.cache.is_in_flight(waiter.index))?;
        let (index, needs) = (waiter.index, waiter.needs);
        let bytes = self.bytes_to_add(index).unwrap_or(0);
        self.must_start(bytes)
            .then(|| self.start(index, needs, bytes))
    }

    fn planned_job(&mut self) -> Option<Job> {
        let needs = self.needs?;
        let mut nearer_bytes = 0;
        for rank in 0..LOOK_AHEAD_FRAMES {
            let index = self.focus.upcoming(rank)?;
            let done = self.cache.error(index).is_some()
                || self.cache.is_in_flight(index)
                || self
                    .cache
                    .prepared(index)
                    .is_some_and(|frame| frame.satisfies(&needs));
            if done {
                nearer_bytes += self.cache.held_bytes(index);
                continue;
            }
            let bytes = self.bytes_to_add(index);
            let fits = match bytes {
                _ if rank == 0 => self.must_start(bytes.unwrap_or(0)),
                Some(bytes) => {
                    let through_here = nearer_bytes + bytes + self.cache.held_bytes(index);
                    through_here <= self.cache.budget_bytes()
                        && (self.has_room(bytes)
                            || (self.may_evict_for(rank, through_here)
                                && self.make_room(bytes, rank)))
                }
                // Without a measure of what a frame takes, one at a time.
                None => self.cache.in_flight() == 0,
            };
            return fits.then(|| self.start(index, needs, bytes.unwrap_or(0)));
        }
        None
    }

    fn has_room(&self, bytes: usize) -> bool {
        self.used_bytes().saturating_add(bytes) <= self.cache.budget_bytes()
    }

    /// Whether frames that come later may be dropped for the one of this rank, which with all nearer ones takes
    /// `through_here` bytes. In a loop only half of the budget streams, so that the other half is not read again.
    fn may_evict_for(&self, rank: usize, through_here: usize) -> bool {
        self.focus.travel.loop_mode == LoopMode::Off
            || rank <= ALWAYS_AHEAD_FRAMES
            || through_here <= self.cache.budget_bytes() / 2
    }

    /// Makes room for a frame that is made even where it alone is more than the budget; then it has to be the only one in
    /// flight, so that the budget is exceeded by one frame at most.
    fn must_start(&mut self, bytes: usize) -> bool {
        self.make_room(bytes, 0) || self.cache.in_flight() == 0
    }

    /// How many bytes frame `index` is expected to take beyond what it holds.
    fn bytes_to_add(&self, index: usize) -> Option<usize> {
        let held = self.cache.held_bytes(index);
        self.cache
            .expected_bytes(index)
            .map(|bytes| bytes.saturating_sub(held))
    }

    fn start(&mut self, index: usize, needs: Needs, bytes: usize) -> Job {
        self.cache.reserve(index, bytes);
        self.changed();
        Job {
            index,
            needs,
            existing: self.cache.prepared(index).cloned(),
        }
    }

    /// Drops what is needed later than `rank` until `bytes` more fit; first of all the frame kept from finding the
    /// origin, which nobody may ever ask for.
    fn make_room(&mut self, bytes: usize, rank: usize) -> bool {
        if !self.has_room(bytes) {
            self.sequence.drop_kept();
        }
        let evicted = self.cache.evicted();
        let fits = self.cache.make_room(bytes, &self.focus, rank);
        if self.cache.evicted() != evicted {
            self.revision += 1;
        }
        fits
    }

    /// Between decoding and preparing: what `index` is to be prepared for now that its frame takes about `bytes`, or
    /// `None` if it is not wanted any more. A worker that hears `None` drops the frame and calls [`Queue::cancel`].
    pub(super) fn still_wanted(&mut self, index: usize, bytes: usize) -> Option<Needs> {
        if self.shutdown {
            return None;
        }
        let reserved = self.cache.expected_bytes(index).unwrap_or(0).max(bytes);
        let more = reserved.saturating_sub(self.cache.held_bytes(index));
        if let Some(waiter) = self
            .waiters
            .iter()
            .find(|waiter| waiter.index == index && waiter.outcome.is_none())
        {
            let needs = waiter.needs;
            self.make_room(more, 0);
            self.cache.reserve(index, reserved);
            self.note_peak();
            return Some(needs);
        }
        let needs = self.needs?;
        let rank = self.focus.rank(index);
        let wanted = rank < LOOK_AHEAD_FRAMES && self.focus.is_coming(index);
        if !wanted || (!self.make_room(more, rank) && rank > 0) {
            self.cache.learn_bytes(index, bytes);
            return None;
        }
        self.cache.reserve(index, reserved);
        self.note_peak();
        Some(needs)
    }

    /// The worker on `index` gave it up.
    pub(super) fn cancel(&mut self, index: usize) {
        self.cache.release(index);
        self.cancelled += 1;
        self.changed();
    }

    /// The worker on a frame is done with it.
    pub(super) fn finish(
        &mut self,
        index: usize,
        outcome: Result<Arc<PreparedFrame>, Arc<FrameError>>,
    ) {
        self.cache.release(index);
        for waiter in &mut self.waiters {
            let answers = waiter.index == index
                && waiter.outcome.is_none()
                && outcome
                    .as_ref()
                    .map_or(true, |frame| frame.satisfies(&waiter.needs));
            if answers {
                waiter.outcome = Some(outcome.clone());
            }
        }
        match outcome {
            Ok(frame) => self.cache.insert(frame),
            Err(error) => self.cache.fail(error),
        }
        self.note_peak();
        self.trim();
        self.changed();
    }

    /// Evicts until the budget is kept; the playhead's frame stays in any case.
    pub(super) fn trim(&mut self) {
        self.make_room(0, 0);
    }

    fn changed(&mut self) {
        self.revision += 1;
        self.note_peak();
    }

    fn note_peak(&mut self) {
        self.peak_bytes = self.peak_bytes.max(self.used_bytes());
    }
}
