//! Companion sequence that plays along with a first one: its frames are paired with those of the first one, on one
//! clock.
//!
//! **How it works.** The clock is the [`Player`](super::Player)'s of the first sequence. Before the clock moves, the
//! companion receives its next position; it asks its own loader for the frame due there and reports whether it is
//! available: playback waits for it as for the player's own. The loader prefetches in the clock's direction, between
//! the frames paired with the ends of the play range, and receives the duration of one of *its* frames, which differs
//! if the sequences have different frame rates.

use super::pairing::{Pair, PairBy, PairNumbers, PairTimes};
use super::player::{PlayerChange, new_warnings};
use crate::composition::can_draw;
use crate::scene::{Scene, Style};
use crate::sequence::{
    FrameEntry, FrameError, Loader, LoaderOptions, Needs, PreparedFrame, Sequence, SequenceError, Slot,
};
use crate::timeline::{Clock, Direction, LoopMode, PlayRange};
use std::collections::HashSet;
use std::sync::Arc;

/// Companion sequence shown alongside another one.
#[derive(Debug)]
pub struct Companion {
    leader: Arc<Sequence>,
    sequence: Arc<Sequence>,
    loader: Loader,
    by: PairBy,
    offset_frames: i64,
    times: Option<PairTimes>,
    numbers: Option<PairNumbers>,
    /// Frames of leader and companion that these are of.
    known_counts: [usize; 2],
    /// Changes of files that were taken notice of.
    known_changes: usize,
    pair: Pair,
    shown: Option<Arc<PreparedFrame>>,
    failure: Option<Arc<FrameError>>,
    /// Frames whose failures or warnings were reported.
    told: HashSet<usize>,
    requested: Option<(usize, Direction, Needs)>,
    way: Option<(LoopMode, PlayRange)>,
    is_playing: bool,
}

impl Companion {
    /// Opens `sequence` as a companion of `leader`, whose origin it takes if that keeps its detail. Frames are paired
    /// by time if both have timestamps, else by the numbers in their names if these overlap.
    pub fn new(leader: &Arc<Sequence>, sequence: Arc<Sequence>, options: LoaderOptions) -> Result<Self, SequenceError> {
        sequence.share_origin_with(leader);
        Ok(Self::with_loader(leader, Loader::new(sequence, options)?))
    }

    pub(super) fn with_loader(leader: &Arc<Sequence>, loader: Loader) -> Self {
        let mut companion = Self {
            leader: Arc::clone(leader),
            sequence: Arc::clone(loader.sequence()),
            loader,
            by: PairBy::Index,
            offset_frames: 0,
            times: None,
            numbers: None,
            known_counts: [0; 2],
            known_changes: 0,
            pair: Pair {
                nearest: 0,
                is_there: false,
            },
            shown: None,
            failure: None,
            told: HashSet::new(),
            requested: None,
            way: None,
            is_playing: false,
        };
        companion.look_at_entries();
        companion.by = match (&companion.times, &companion.numbers) {
            (Some(_), _) => PairBy::Time,
            (None, Some(_)) => PairBy::Number,
            (None, None) => PairBy::Index,
        };
        companion
    }

    /// Splits the memory budget `budget_bytes` between the frames of the leader and those of its companion; the shares
    /// add up to the whole.
    pub fn shares(budget_bytes: usize) -> [usize; 2] {
        // Half each: tests check it against both loaders on simulated disks.
        let of_companion = budget_bytes / 2;
        [budget_bytes - of_companion, of_companion]
    }

    /// The sequence.
    pub fn sequence(&self) -> &Arc<Sequence> {
        &self.sequence
    }

    /// Its loader.
    pub fn loader(&self) -> &Loader {
        &self.loader
    }

    /// The frame shown; `None` also where there is no frame at that time.
    pub fn shown(&self) -> Option<&Arc<PreparedFrame>> {
        self.shown.as_ref()
    }

    /// The frame that belongs to the clock's.
    pub fn frame(&self) -> Option<usize> {
        self.pair.frame()
    }

    /// The reason why the due frame is not shown, if it cannot be read.
    pub fn failure(&self) -> Option<&Arc<FrameError>> {
        self.failure.as_ref()
    }

    /// The frame that is waited for.
    pub fn waiting_for(&self) -> Option<usize> {
        let is_shown = |frame: &usize| self.shown.as_ref().is_some_and(|s| s.index == *frame);
        let frame = self.frame().filter(|frame| !is_shown(frame));
        frame.filter(|_| self.failure.is_none())
    }

    /// The pairing of frames.
    pub fn paired_by(&self) -> PairBy {
        self.by
    }

    /// The times by which they can; `None` where not all frames of both have one.
    pub fn times(&self) -> Option<&PairTimes> {
        self.times.as_ref()
    }

    /// The numbers by which they can; `None` where not all frames of both have one, or none is the same.
    pub fn numbers(&self) -> Option<&PairNumbers> {
        self.numbers.as_ref()
    }

    /// Returns the frame offset of the companion, in its own frames; positive if it is later.
    pub fn offset_frames(&self) -> i64 {
        self.offset_frames
    }

    /// Chooses the pairing of frames; without times or numbers it is the index.
    pub fn pair_by(&mut self, by: PairBy) {
        self.by = by;
    }

    /// Shows frames so much later, or earlier if it is negative.
    pub fn set_offset_frames(&mut self, offset_frames: i64) {
        self.offset_frames = offset_frames;
    }

    /// Records how long a frame with this number of points took to draw, milliseconds.
    pub fn note_picture_ms(&self, points: usize, picture_ms: f64) {
        if self.is_playing {
            self.loader.note_drawn(points, picture_ms);
        }
    }

    /// Asks for the frame paired with `clock`, and for the next ones. True if nothing is to be waited for: it is here,
    /// cannot be read, or there is none.
    pub fn prepare(&mut self, clock: &Clock, is_playing: bool, style: &Style) -> bool {
        self.look_at_entries();
        if self.sequence.is_empty() {
            return true;
        }
        self.is_playing = is_playing;
        let frames = clock.range().of(clock.frame_count());
        let ends = [frames.start, frames.end.saturating_sub(1)].map(|frame| self.pair_of(frame));
        let range = PlayRange::default()
            .beginning_at(ends[0].nearest)
            .ending_at(ends[1].nearest);
        let way = (clock.loop_mode(), range);
        if self.way != Some(way) {
            self.loader.set_loop_mode(way.0);
            self.loader.set_range(range);
            self.way = Some(way);
        }
        let interval = clock.frame_interval().div_f64(self.frames_per_frame());
        self.loader.set_interval(is_playing.then_some(interval));
        let needs = Scene::needs(style);
        self.pair = self.pair_of(clock.frame());
        let request = (self.pair.nearest, clock.direction(), needs);
        if self.requested != Some(request) {
            self.loader.request(request.0, request.1, &needs);
            self.requested = Some(request);
        }
        let Some(frame) = self.frame() else {
            return true;
        };
        match self.loader.get(frame, &needs) {
            Slot::Ready(_) | Slot::Coarse(_) | Slot::Partial(_) | Slot::Failed(_) => true,
            Slot::Stale(frame) => can_draw(&frame, style),
            Slot::Pending => false,
        }
    }

    /// Shows the frame that [`Companion::prepare`] has requested, if it is here. The previous frame stays until then.
    pub fn show(&mut self, style: &Style) -> PlayerChange {
        let mut change = PlayerChange::default();
        let before = self.shown.as_ref().map(Arc::as_ptr);
        let was_waiting = self.waiting_for();
        let failed_before = self.failure.take().map(|error| error.index());
        match self.frame() {
            None => self.shown = None,
            Some(index) => match self.loader.get(index, &Scene::needs(style)) {
                Slot::Ready(frame) | Slot::Coarse(frame) | Slot::Partial(frame) => {
                    self.shown = Some(frame);
                }
                Slot::Stale(frame)
                    if can_draw(&frame, style) || self.shown.as_ref().is_some_and(|s| s.index == index) =>
                {
                    self.shown = Some(frame);
                }
                Slot::Stale(_) | Slot::Pending => {}
                Slot::Failed(error) => {
                    if self.told.insert(index) {
                        change.new_failure = Some(Arc::clone(&error));
                    }
                    self.failure = Some(error);
                }
            },
        }
        if let Some(frame) = &self.shown {
            change.new_warnings = new_warnings(frame, &mut self.told);
        }
        change.visible = before != self.shown.as_ref().map(Arc::as_ptr)
            || was_waiting != self.waiting_for()
            || failed_before != self.failure.as_ref().map(|error| error.index());
        change
    }

    fn pair_of(&self, index: usize) -> Pair {
        match (self.by, &self.times, &self.numbers) {
            (PairBy::Time, Some(times), _) => times.pair(index, self.offset_frames),
            (PairBy::Number, _, Some(numbers)) => numbers.pair(index, self.offset_frames),
            _ => Pair::by_index(index, self.offset_frames, self.sequence.len()),
        }
    }

    fn frames_per_frame(&self) -> f64 {
        match &self.times {
            // Frames are never prepared at rates outside this range, and durations are limited.
            Some(times) if self.by == PairBy::Time => times.frames_per_frame().clamp(1e-3, 1e3),
            _ => 1.0,
        }
    }

    /// Both may have grown.
    fn look_at_entries(&mut self) {
        let changed = self.sequence.changed_since(self.known_changes);
        if !changed.is_empty() {
            self.known_changes += changed.len();
            self.loader.forget(&changed);
        }
        let counts = [self.leader.len(), self.sequence.len()];
        if counts == self.known_counts {
            return;
        }
        self.loader.grow();
        self.known_counts = counts;
        let (a, b) = (self.leader.entries(), self.sequence.entries());
        let times = |entries: &[Arc<FrameEntry>]| -> Vec<_> { entries.iter().map(|entry| entry.time).collect() };
        self.times = PairTimes::of(&times(&a), &times(&b));
        let numbers = |entries: &[Arc<FrameEntry>]| -> Vec<_> { entries.iter().map(|entry| entry.number).collect() };
        self.numbers = PairNumbers::of(&numbers(&a), &numbers(&b));
    }
}

#[cfg(test)]
#[path = "companion_tests.rs"]
mod tests;
