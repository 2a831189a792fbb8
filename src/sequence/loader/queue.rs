//! Work queue: selects the frame that a worker takes next.
//!
//! **How it works.** There is no list of queued work that could become outdated. A worker that is free looks at the
//! plan as it is now: frames waited for, then the playhead's, then those the playhead will reach, in that order, and
//! takes the first that is neither there nor failed nor in flight. Frames that the playhead has passed, or that were
//! wanted for older needs, are thereby forgotten at once. Work in flight checks between its stages whether it is still
//! wanted.
//!
//! **Level of detail.** [`Effort`] determines how many points there is time for during playback. Frames due soon are
//! prepared with that many; once they are all there, later ones are prepared in full, so that a loop gains detail with
//! each iteration; and then, if the sequence is too long for the memory, coarse copies of all its frames, for
//! scrubbing.
//!
//! **Groups.** Frames that are decoded from one another ([`crate::source::Groups`]) are prepared by one worker at a
//! time, in their order, while others prepare other groups. Backwards, the next group is begun at its first frame, so
//! that each of its frames is decoded once.
//!
//! A look costs a multiple of [`LOOK_AHEAD_FRAMES`] steps, whatever the length of the sequence.

use super::LoaderOptions;
use super::cache::{ALWAYS_AHEAD_FRAMES, Cache, Focus};
use super::stages;
use crate::sequence::effort::Effort;
use crate::sequence::{Detail, FrameError, Needs, PreparedFrame, Sequence};
use crate::timeline::LoopMode;
use std::sync::Arc;

/// Prefetch distance: look-ahead in frames that are prepared, if the budget allows: ten seconds of footage.
pub(super) const LOOK_AHEAD_FRAMES: usize = 256;

/// Maximum and minimum number of points of the coarse copies cached of all frames.
const COARSE_POINTS: (f64, f64) = (32_768.0, 1024.0);

/// Somebody who blocks until a frame is there.
#[derive(Debug)]
pub(super) struct Waiter {
    pub(super) ticket: u64,
    pub(super) index: usize,
    pub(super) needs: Needs,
    pub(super) outcome: Option<Result<Arc<PreparedFrame>, Arc<FrameError>>>,
}

/// Job for a worker.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) index: usize,
    pub(super) needs: Needs,
    pub(super) detail: Detail,
    /// Existing frame prepared for other needs or in more detail: to be completed or subsampled, not decoded.
    pub(super) existing: Option<Arc<PreparedFrame>>,
    /// A coarse copy of a frame that may be far from the playhead.
    pub(super) is_for_scrubbing: bool,
    /// It may come in stages (see [`stages`]), the next of which is wanted.
    pub(super) next_stage: Option<NextStage>,
}

/// Next stage to prepare of a frame that comes in stages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NextStage {
    /// Some points, if they can be had without the others; else all.
    Sample,
    /// All points, with their number.
    AllPoints(usize),
    /// Completion: the attributes that the points lack.
    Completion,
}

/// All that workers and the interface share, under one lock.
#[derive(Debug)]
pub(super) struct Queue {
    pub(super) cache: Cache,
    pub(super) focus: Focus,
    /// Needs of the last request; `None` before the first: then only waiters are served.
    pub(super) needs: Option<Needs>,
    pub(super) effort: Effort,
    /// True if coarse copies of all frames are wanted, and where to look for the next that lacks one.
    keeps_coarse: bool,
    next_coarse: usize,
    /// True if large frames at rest come in stages.
    has_stages: bool,
    pub(super) waiters: Vec<Waiter>,
    pub(super) shutdown: bool,
    pub(super) cancelled: u64,
    pub(super) peak_bytes: usize,
    /// Changes whenever a frame's state does.
    pub(super) revision: u64,
    sequence: Arc<Sequence>,
}

impl Queue {
    pub(super) fn new(sequence: Arc<Sequence>, focus: Focus, options: &LoaderOptions) -> Self {
        Self {
            cache: Cache::new(sequence.len(), options.budget_bytes),
            focus,
            needs: None,
            effort: Effort::new(options.workers.max(1)),
            keeps_coarse: options.keeps_coarse_frames,
            next_coarse: 0,
            has_stages: options.shows_stages,
            waiters: Vec::new(),
            shutdown: false,
            cancelled: 0,
            peak_bytes: 0,
            revision: 0,
            sequence,
        }
    }

    /// Resident, in flight, and the frame cached since the origin was decided.
    pub(super) fn used_bytes(&self) -> usize {
        self.cache.used_bytes() + self.sequence.cached_bytes()
    }

    /// The next frame to work on, reserved for the caller; `None` when there is nothing to do now.
    pub(super) fn next_job(&mut self) -> Option<Job> {
        if let Some(job) = self.waiters_job() {
            return Some(job);
        }
        let needs = self.needs?;
        let (in_time, at_best) = (self.effort.in_time(), self.effort.at_best());
        // From the current plan, not a queue: frames behind the playhead are no longer requested, and nothing needs
        // back-pressure. Full frames come second, so that a loop gets denser with each iteration.
        let ahead = self.effort.ahead_frames().min(LOOK_AHEAD_FRAMES);
        self.planned_job(&needs, in_time, ahead)
            .or_else(|| self.planned_job(&needs, at_best, LOOK_AHEAD_FRAMES))
            .or_else(|| self.coarse_job(&needs))
    }

    /// Returns true if the frame at the playhead is between stages: a large one at rest with some stages there, but not
    /// all; others wait for it.
    fn is_between_stages(&self, needs: &Needs) -> bool {
        let index = self.focus.playhead;
        self.partial(index).is_some() && self.cache.error(index).is_none() && !self.serves(index, needs, Detail::Full)
    }

    /// Frame `index` as far as it has come, if it comes in stages.
    pub(super) fn partial(&self, index: usize) -> Option<&Arc<PreparedFrame>> {
        let frame = self.cache.full(index).or(self.cache.coarse(index))?;
        let is_large = frame.frame.points_in_file() > stages::STAGED_POINTS;
        let may_come_so = self.has_stages && self.effort.is_at_rest();
        (may_come_so && is_large && !self.is_settled(index)).then_some(frame)
    }

    fn waiters_job(&mut self) -> Option<Job> {
        let waiter = self
            .waiters
            .iter()
            .find(|waiter| waiter.outcome.is_none() && !self.is_group_in_flight(waiter.index))?;
        let (index, needs) = (waiter.index, waiter.needs);
        let bytes = self.cache.bytes_to_add(index, Detail::Full).unwrap_or(0);
        self.must_start(bytes)
            .then(|| self.start(index, needs, Detail::Full, bytes))
    }

    /// The first of the `ahead` frames that come next which is not there in `detail`.
    fn planned_job(&mut self, needs: &Needs, detail: Detail, ahead: usize) -> Option<Job> {
        let mut nearer_bytes = 0;
        for rank in 0..ahead {
            if rank > 0 && self.is_between_stages(needs) {
                return None;
            }
            let index = self.focus.upcoming(rank)?;
            if self.is_done(index, needs, detail) {
                nearer_bytes += self.cache.held_bytes(index);
                continue;
            }
            if self.existing(index, detail).is_none() && self.is_group_in_flight(index) {
                continue;
            }
            let first = self.first_of_group(index, rank, needs, detail);
            if let Some(job) = first.and_then(|first| self.start_if_it_fits(first, needs, detail, nearer_bytes)) {
                return Some(job);
            }
            let next_stage = self.next_stage(index, rank, detail);
            let job = self.start_if_it_fits(index, needs, detail, nearer_bytes)?;
            return Some(Job { next_stage, ..job });
        }
        None
    }

    /// Returns true if there is nothing to do for frame `index`: a worker is on it, it has failed or is there in
    /// `detail`.
    fn is_done(&self, index: usize, needs: &Needs, detail: Detail) -> bool {
        self.cache.error(index).is_some() || self.cache.is_in_flight(index) || self.serves(index, needs, detail)
    }

    /// Returns true if a worker is on a frame of the group of `index`, whose decoder then knows the references of the
    /// others.
    fn is_group_in_flight(&self, index: usize) -> bool {
        // Two workers in one group would decode the same frames twice.
        let frames = 0..self.cache.frame_count();
        let mut group = self.sequence.group(index);
        group.any(|frame| frames.contains(&frame) && self.cache.is_in_flight(frame))
    }

    /// The first missing frame of the group that frame `index`, which comes at `rank`, is the last of, as frames come
    /// backwards.
    fn first_of_group(&self, index: usize, rank: usize, needs: &Needs, detail: Detail) -> Option<usize> {
        let before = self.focus.upcoming(rank.checked_sub(1)?)?;
        let mut earlier = self.sequence.group(index).start..index;
        let is_missing = |&frame: &usize| self.focus.is_coming(frame) && !self.is_done(frame, needs, detail);
        earlier.find(is_missing).filter(|_| before > index)
    }

    /// Starts frame `index` if there is memory for it, where the frames that come before it take `nearer_bytes`.
    fn start_if_it_fits(&mut self, index: usize, needs: &Needs, detail: Detail, nearer_bytes: usize) -> Option<Job> {
        let rank = self.focus.rank(index);
        let bytes = self.cache.bytes_to_add(index, detail);
        let fits = match bytes {
            _ if rank == 0 => self.must_start(bytes.unwrap_or(0)),
            Some(bytes) => {
                let through_here = nearer_bytes + bytes + self.cache.held_bytes(index);
                through_here <= self.cache.budget_bytes()
                    && (self.has_space(bytes)
                        || (self.may_evict_for(rank, through_here) && self.free_space(bytes, rank)))
            }
            // As long as the memory of a frame is unknown, one at a time.
            None => self.cache.in_flight() == 0,
        };
        fits.then(|| self.start(index, *needs, detail, bytes.unwrap_or(0)))
    }

    /// Returns the next stage of frame `index` if it comes in stages.
    fn next_stage(&self, index: usize, rank: usize, detail: Detail) -> Option<NextStage> {
        let may_come_so = self.has_stages && self.effort.is_at_rest();
        if !may_come_so || rank > 0 || detail != Detail::Full {
            return None;
        }
        Some(match (self.cache.full(index), self.cache.coarse(index)) {
            (Some(_), _) => NextStage::Completion,
            (None, Some(coarse)) => NextStage::AllPoints(coarse.frame.points_in_file()),
            (None, None) => NextStage::Sample,
        })
    }

    /// Returns true if frame `index` is there as wanted.
    fn serves(&self, index: usize, needs: &Needs, detail: Detail) -> bool {
        if self.is_settled(index) {
            return true;
        }
        let full = self.cache.full(index).filter(|frame| frame.satisfies(needs));
        // If there are too many points to draw, reduced versions are made even of frames that are cached.
        let is_of_use = |frame: &PreparedFrame| detail != self.effort.at_best() || !detail.is_exceeded_by(&frame.frame);
        let coarse = self.cache.coarse(index).filter(|frame| frame.satisfies(needs));
        full.is_some_and(|frame| is_of_use(frame))
            || coarse.is_some_and(|frame| detail.is_met_by(&frame.frame) && is_of_use(frame))
    }

    /// Returns true if frame `index` has all that is needed, and no caller waits for more of it.
    pub(super) fn is_complete(&self, index: usize, needs: &Needs) -> bool {
        let is_waited_for = |waiter: &Waiter| waiter.index == index && waiter.outcome.is_none();
        let full = self.cache.full(index);
        full.is_some_and(|frame| frame.satisfies(needs)) && !self.waiters.iter().any(is_waited_for)
    }

    /// Returns true if frame `index` is at rest and stays as it is, as its missing parts were cancelled or do not fit
    /// into memory.
    fn is_settled(&self, index: usize) -> bool {
        self.effort.is_at_rest() && self.cache.is_settled(index)
    }

    /// The frame to show of those that are there and have the needed parts.
    pub(super) fn best(&self, index: usize, needs: &Needs) -> Option<&Arc<PreparedFrame>> {
        if self.is_settled(index) {
            return self.cache.full(index).or(self.cache.coarse(index));
        }
        let full = self.cache.full(index).filter(|frame| frame.satisfies(needs));
        let coarse = self.cache.coarse(index).filter(|frame| frame.satisfies(needs));
        match self.effort.at_best() {
            Detail::Full => full.or(coarse),
            detail @ Detail::AtMost(_) => {
                let is_drawn_in_time = |frame: &&Arc<PreparedFrame>| !detail.is_exceeded_by(&frame.frame);
                coarse
                    .filter(|frame| detail.is_met_by(&frame.frame))
                    .filter(is_drawn_in_time)
                    .or(full.filter(is_drawn_in_time))
                    .or(coarse)
                    .or(full)
            }
        }
    }

    /// A coarse copy that is still missing, as long as there is memory for it.
    fn coarse_job(&mut self, needs: &Needs) -> Option<Job> {
        if self.is_between_stages(needs) {
            return None;
        }
        let detail = self.detail_for_scrubbing()?;
        let count = self.cache.frame_count();
        for _ in 0..count.min(LOOK_AHEAD_FRAMES) {
            let index = self.next_coarse % count;
            let is_there = |frame: Option<&Arc<PreparedFrame>>| frame.is_some_and(|frame| frame.satisfies(needs));
            let done = index < self.focus.travel.first
                || self.cache.error(index).is_some()
                || self.is_group_in_flight(index)
                || is_there(self.cache.full(index))
                || is_there(self.cache.coarse(index));
            if done {
                self.next_coarse = index + 1;
                continue;
            }
            let bytes = self.cache.bytes_to_add(index, detail)?;
            let fits = self.cache.coarse_bytes() + bytes <= self.cache.coarse_budget_bytes()
                && self.free_space(bytes, ALWAYS_AHEAD_FRAMES);
            return fits.then(|| Job {
                is_for_scrubbing: true,
                ..self.start(index, *needs, detail, bytes)
            });
        }
        None
    }

    /// Returns the level of detail that coarse copies of all frames can have; `None` if they are not wanted, all frames
    /// fit as they are, or copies would have too few points to be of use.
    fn detail_for_scrubbing(&self) -> Option<Detail> {
        let (bytes_per_point, points) = self.cache.measure().filter(|_| self.keeps_coarse)?;
        let count = self.cache.frame_count();
        let all_bytes = bytes_per_point * points as f64 * count as f64;
        if count <= LOOK_AHEAD_FRAMES && all_bytes <= self.cache.budget_bytes() as f64 {
            return None;
        }
        let share = self.cache.coarse_budget_bytes() as f64 / count as f64;
        let affordable = (share / bytes_per_point).min(COARSE_POINTS.0);
        let is_of_use = affordable >= COARSE_POINTS.1 && 2.0 * affordable <= points as f64;
        is_of_use.then(|| Detail::at_most(affordable as u32))
    }

    fn has_space(&self, bytes: usize) -> bool {
        self.used_bytes().saturating_add(bytes) <= self.cache.budget_bytes()
    }

    /// Returns true if later frames may be evicted for the one of this rank, which with all nearer ones takes
    /// `through_here` bytes. In a loop only half of the budget streams, so that the other half is not read again.
    fn may_evict_for(&self, rank: usize, through_here: usize) -> bool {
        self.focus.travel.loop_mode == LoopMode::Off
            || rank <= ALWAYS_AHEAD_FRAMES
            || through_here <= self.cache.budget_bytes() / 2
    }

    /// Returns the existing frame that frame `index` can be prepared from without decoding it.
    fn existing(&self, index: usize, detail: Detail) -> Option<&Arc<PreparedFrame>> {
        let (full, coarse) = (self.cache.full(index), self.cache.coarse(index));
        match detail {
            Detail::Full => full,
            Detail::AtMost(_) => coarse.filter(|frame| detail.is_met_by(&frame.frame)).or(full),
        }
    }

    /// Frees memory for a frame that is made even if it alone exceeds the budget; then it has to be the only one in
    /// flight, so that the budget is exceeded by one frame at most.
    fn must_start(&mut self, bytes: usize) -> bool {
        self.free_space(bytes, 0) || self.cache.in_flight() == 0
    }

    fn start(&mut self, index: usize, needs: Needs, detail: Detail, bytes: usize) -> Job {
        self.cache.reserve(index, bytes);
        self.changed();
        Job {
            index,
            needs,
            detail,
            existing: self.existing(index, detail).cloned(),
            is_for_scrubbing: false,
            next_stage: None,
        }
    }

    /// Drops frames needed later than `rank` until `bytes` more fit; first of all the frame cached from finding the
    /// origin, which may never be requested.
    fn free_space(&mut self, bytes: usize, rank: usize) -> bool {
        if !self.has_space(bytes) {
            self.sequence.drop_cached();
        }
        let evicted = self.cache.evicted();
        let fits = self.cache.free_space(bytes, &self.focus, rank);
        if self.cache.evicted() != evicted {
            self.revision += 1;
        }
        fits
    }

    /// Between decoding and preparing: the needs to prepare the frame of `job` for, now that it takes about `bytes`, or
    /// `None` if it is no longer wanted. A worker that gets `None` drops the frame and calls [`Queue::cancel`].
    pub(super) fn still_wanted(&mut self, job: &Job, bytes: usize) -> Option<Needs> {
        if self.shutdown {
            return None;
        }
        let index = job.index;
        let is_full = job.detail == Detail::Full;
        let expected = is_full.then(|| self.cache.expected_bytes(index)).flatten();
        let reserved = expected.unwrap_or(0).max(bytes);
        let more = reserved.saturating_sub(self.cache.held_bytes(index));
        if let Some(waiter) = self
            .waiters
            .iter()
            .find(|waiter| waiter.index == index && waiter.outcome.is_none())
        {
            let needs = waiter.needs;
            self.free_space(more, 0);
            self.cache.reserve(index, reserved);
            self.note_peak();
            return Some(needs);
        }
        let needs = self.needs?;
        let rank = if job.is_for_scrubbing {
            ALWAYS_AHEAD_FRAMES
        } else {
            self.focus.rank(index)
        };
        let is_coming = rank < LOOK_AHEAD_FRAMES && self.focus.is_coming(index);
        let wanted = is_coming || job.is_for_scrubbing;
        if !wanted || (!self.free_space(more, rank) && rank > 0) {
            if is_full {
                self.cache.learn_bytes(index, bytes);
            }
            return None;
        }
        self.cache.reserve(index, reserved);
        self.note_peak();
        Some(needs)
    }

    /// The worker on `index` gave it up.
    pub(super) fn cancel(&mut self, index: usize) {
        self.cache.release(index);
        self.cache.take_outdated(index);
        self.cancelled += 1;
        self.changed();
    }

    /// The worker on a frame is done with it.
    pub(super) fn finish(&mut self, index: usize, outcome: Result<Arc<PreparedFrame>, Arc<FrameError>>) {
        self.cache.release(index);
        if self.cache.take_outdated(index) {
            return self.changed();
        }
        for waiter in &mut self.waiters {
            let answers = waiter.index == index
                && waiter.outcome.is_none()
                && outcome
                    .as_ref()
                    .map_or(true, |frame| !frame.is_sample() && frame.satisfies(&waiter.needs));
            if answers {
                waiter.outcome = Some(outcome.clone());
            }
        }
        match outcome {
            Ok(frame) => {
                let is_complete = self.needs.is_none_or(|needs| frame.satisfies(&needs));
                self.cache.insert(frame, is_complete);
            }
            Err(error) => {
                let is_for_more = matches!(*error, FrameError::Cancelled { .. } | FrameError::TooLarge { .. });
                let may_stay = is_for_more && self.effort.is_at_rest();
                if !may_stay || !self.cache.settle(index) {
                    self.cache.fail(error);
                }
            }
        }
        self.note_peak();
        self.trim();
        self.changed();
    }

    /// Evicts until the budget is met; the playhead's frame stays in any case.
    pub(super) fn trim(&mut self) {
        self.free_space(0, 0);
    }

    fn changed(&mut self) {
        self.revision += 1;
        self.note_peak();
    }

    fn note_peak(&mut self) {
        self.peak_bytes = self.peak_bytes.max(self.used_bytes());
    }
}
