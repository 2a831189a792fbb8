//! Frame cache: the state of every frame, and its memory: prepared frames, errors, work in flight, against a byte
//! budget.
//!
//! A frame may be here twice: with all its points, and as a *coarse* copy of fewer (see [`Detail`]), which stands in
//! for it while there is no time for all. Coarse copies may take a quarter of the budget for good: they are dropped
//! last, so that any frame of a long sequence can be shown at once.
//!
//! **How it works.** Bytes are counted in two sums: *resident* for prepared frames, *reserved* for frames that a worker
//! is preparing (as large as the frame was before, or as the largest seen). Before work starts, frames that are needed
//! later than its frame are evicted, the one needed last first, until both sums and the new reservation fit.
//!
//! **The frame needed last** is, without looping, the one farthest behind; in a loop, the one shown just now, because
//! the whole sequence comes before it again. A loop that does not fit then keeps up to half of the budget resident and
//! streams the rest through the other half, where evicting the least recently used would read every frame again on
//! every iteration.

use super::facts::Facts;
use super::stats::FrameState;
use crate::sequence::{Detail, FrameError, Needs, PreparedFrame};
use crate::timeline::{Direction, Travel};
use std::collections::BTreeSet;
use std::sync::Arc;

/// These many frames ahead of the playhead are prepared even if others of the loop, or coarse copies, have to go for
/// them.
pub(super) const ALWAYS_AHEAD_FRAMES: usize = 4;

/// Playhead position and direction: the order in which frames are needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Focus {
    pub(super) travel: Travel,
    pub(super) playhead: usize,
    pub(super) direction: Direction,
}

impl Focus {
    pub(super) fn rank(&self, index: usize) -> usize {
        self.travel.rank(self.playhead, self.direction, index)
    }

    pub(super) fn upcoming(&self, rank: usize) -> Option<usize> {
        self.travel.upcoming(self.playhead, self.direction, rank)
    }

    /// False for frames that lie behind and are not coming again.
    pub(super) fn is_coming(&self, index: usize) -> bool {
        self.upcoming(self.rank(index)) == Some(index)
    }
}

#[derive(Debug, Default)]
struct CacheEntry {
    full: Option<Arc<PreparedFrame>>,
    coarse: Option<Arc<PreparedFrame>>,
    error: Option<Arc<FrameError>>,
    /// Bytes reserved by the worker that is on it.
    reserved_bytes: Option<usize>,
    /// Size when it was last prepared, and for which of the needs that there were.
    known_bytes: Option<(u64, usize)>,
    /// The needs for which its missing parts were cancelled.
    settled: Option<u64>,
    /// Its file changed while a worker is on it.
    is_outdated: bool,
}

fn byte_size(frame: Option<&Arc<PreparedFrame>>) -> usize {
    frame.map_or(0, |frame| frame.byte_size())
}

/// All frames' entries and their memory.
#[derive(Debug)]
pub(super) struct Cache {
    entries: Vec<CacheEntry>,
    pub(super) facts: Facts,
    resident: BTreeSet<usize>,
    resident_bytes: usize,
    coarse: BTreeSet<usize>,
    coarse_bytes: usize,
    reserved_bytes: usize,
    in_flight: usize,
    /// Largest size of the frames prepared for the present needs with all their points.
    largest_bytes: Option<usize>,
    /// Maximum bytes per point in frames prepared for the present needs.
    bytes_per_point: Option<f64>,
    /// Maximum number of points of a file.
    largest_points: usize,
    /// Counts the needs that there were.
    needs_epoch: u64,
    failed: usize,
    evicted: u64,
    budget_bytes: usize,
}

impl Cache {
    pub(super) fn new(frame_count: usize, budget_bytes: usize) -> Self {
        Self {
            entries: std::iter::repeat_with(CacheEntry::default).take(frame_count).collect(),
            facts: Facts::default(),
            resident: BTreeSet::new(),
            resident_bytes: 0,
            coarse: BTreeSet::new(),
            coarse_bytes: 0,
            reserved_bytes: 0,
            in_flight: 0,
            largest_bytes: None,
            bytes_per_point: None,
            largest_points: 0,
            needs_epoch: 0,
            failed: 0,
            evicted: 0,
            budget_bytes,
        }
    }

    pub(super) fn frame_count(&self) -> usize {
        self.entries.len()
    }

    /// There are more frames now.
    pub(super) fn grow(&mut self, frame_count: usize) {
        if frame_count > self.entries.len() {
            self.entries.resize_with(frame_count, CacheEntry::default);
        }
    }

    /// Frame `index` with all its points.
    pub(super) fn full(&self, index: usize) -> Option<&Arc<PreparedFrame>> {
        self.entries.get(index)?.full.as_ref()
    }

    /// Frame `index` with fewer points than its file has.
    pub(super) fn coarse(&self, index: usize) -> Option<&Arc<PreparedFrame>> {
        self.entries.get(index)?.coarse.as_ref()
    }

    pub(super) fn error(&self, index: usize) -> Option<&Arc<FrameError>> {
        self.entries.get(index)?.error.as_ref()
    }

    pub(super) fn is_in_flight(&self, index: usize) -> bool {
        self.entries[index].reserved_bytes.is_some()
    }

    pub(super) fn in_flight(&self) -> usize {
        self.in_flight
    }

    pub(super) fn budget_bytes(&self) -> usize {
        self.budget_bytes
    }

    pub(super) fn set_budget_bytes(&mut self, budget_bytes: usize) {
        self.budget_bytes = budget_bytes;
    }

    /// Prepared frames, coarse copies and reservations.
    pub(super) fn used_bytes(&self) -> usize {
        self.resident_bytes + self.coarse_bytes + self.reserved_bytes
    }

    pub(super) fn resident_bytes(&self) -> usize {
        self.resident_bytes
    }

    pub(super) fn coarse_bytes(&self) -> usize {
        self.coarse_bytes
    }

    pub(super) fn coarse_frames(&self) -> usize {
        self.coarse.len()
    }

    /// Bytes that coarse copies may take for good.
    pub(super) fn coarse_budget_bytes(&self) -> usize {
        self.budget_bytes / 4
    }

    pub(super) fn resident_frames(&self) -> usize {
        self.resident.len()
    }

    pub(super) fn failed_frames(&self) -> usize {
        self.failed
    }

    pub(super) fn evicted(&self) -> u64 {
        self.evicted
    }

    /// Returns the bytes that frame `index` holds or reserves now, excluding coarse copies.
    pub(super) fn held_bytes(&self, index: usize) -> usize {
        let entry = &self.entries[index];
        byte_size(entry.full.as_ref()) + entry.reserved_bytes.unwrap_or(0)
    }

    /// Returns the number of bytes that frame `index` is expected to take in `detail` beyond its present size; `None`
    /// while no frame was prepared for the present needs.
    pub(super) fn bytes_to_add(&self, index: usize, detail: Detail) -> Option<usize> {
        let entry = &self.entries[index];
        let reserved = entry.reserved_bytes.unwrap_or(0);
        let (expected, held) = match detail {
            Detail::Full => (self.expected_bytes(index), byte_size(entry.full.as_ref())),
            Detail::AtMost(points) => {
                let bytes = |per_point: f64| (per_point * f64::from(points.get())).ceil() as usize;
                (self.bytes_per_point.map(bytes), byte_size(entry.coarse.as_ref()))
            }
        };
        expected.map(|bytes| bytes.saturating_sub(held + reserved))
    }

    /// Returns the expected size of frame `index` with all its points, in bytes.
    pub(super) fn expected_bytes(&self, index: usize) -> Option<usize> {
        let per_point = |bytes: f64| (bytes * self.largest_points as f64) as usize;
        self.entries[index]
            .known_bytes
            .and_then(|(epoch, bytes)| (epoch == self.needs_epoch).then_some(bytes))
            .or(self.largest_bytes)
            .or_else(|| self.bytes_per_point.map(per_point))
    }

    /// Bytes that a point takes, and the most points that a frame has, as far as known.
    pub(super) fn measure(&self) -> Option<(f64, usize)> {
        self.bytes_per_point.map(|bytes| (bytes, self.largest_points))
    }

    /// The needs have changed: known sizes are no longer valid.
    pub(super) fn forget_sizes(&mut self) {
        self.needs_epoch += 1;
        self.largest_bytes = None;
        self.bytes_per_point = None;
    }

    /// Evicts frames that are needed later than `rank`, the one needed last first, until `bytes` more fit into the
    /// budget. False if they still do not. The playhead's frame is never evicted. Coarse copies go if they take more
    /// than their share, or for a frame that is needed soon.
    pub(super) fn free_space(&mut self, bytes: usize, focus: &Focus, rank: usize) -> bool {
        while self.used_bytes().saturating_add(bytes) > self.budget_bytes {
            let last = |frames: &BTreeSet<usize>| {
                focus
                    .travel
                    .needed_last_first(frames, focus.playhead, focus.direction)
                    .next()
                    .filter(|&index| focus.rank(index) > rank)
            };
            let is_over = self.coarse_bytes > self.coarse_budget_bytes();
            let coarse = || last(&self.coarse).filter(|_| is_over || rank <= ALWAYS_AHEAD_FRAMES);
            match (last(&self.resident), coarse()) {
                (Some(full), Some(coarse)) if is_over && focus.rank(coarse) > focus.rank(full) => {
                    self.evict_coarse(coarse);
                }
                (Some(full), _) => self.evict(full),
                (None, Some(coarse)) => self.evict_coarse(coarse),
                (None, None) => return false,
            }
        }
        true
    }

    fn evict(&mut self, index: usize) {
        if let Some(frame) = self.entries.get_mut(index).and_then(|entry| entry.full.take()) {
            self.resident.remove(&index);
            self.resident_bytes -= frame.byte_size();
            self.evicted += 1;
        }
    }

    fn evict_coarse(&mut self, index: usize) {
        if let Some(frame) = self.entries.get_mut(index).and_then(|entry| entry.coarse.take()) {
            self.coarse.remove(&index);
            self.coarse_bytes -= frame.byte_size();
            self.evicted += 1;
        }
    }

    /// A worker starts on frame `index` and will need `bytes` beyond the frame's present size.
    pub(super) fn reserve(&mut self, index: usize, bytes: usize) {
        let entry = &mut self.entries[index];
        match entry.reserved_bytes.replace(bytes) {
            Some(before) => self.reserved_bytes -= before,
            None => self.in_flight += 1,
        }
        self.reserved_bytes += bytes;
    }

    /// The worker is done with frame `index`, with any result.
    pub(super) fn release(&mut self, index: usize) {
        if let Some(bytes) = self.entries[index].reserved_bytes.take() {
            self.reserved_bytes -= bytes;
            self.in_flight -= 1;
        }
    }

    /// Remembers how large frame `index` is.
    pub(super) fn learn_bytes(&mut self, index: usize, bytes: usize) {
        self.entries[index].known_bytes = Some((self.needs_epoch, bytes));
        self.largest_bytes = Some(self.largest_bytes.map_or(bytes, |max| max.max(bytes)));
    }

    /// Frame `index` stays as it is until other needs are requested: its missing parts were cancelled. False if nothing
    /// is there.
    pub(super) fn settle(&mut self, index: usize) -> bool {
        let entry = &mut self.entries[index];
        let is_there = entry.full.is_some() || entry.coarse.is_some();
        entry.settled = is_there.then_some(self.needs_epoch);
        is_there
    }

    /// Returns true if frame `index` is settled: it is to stay as it is.
    pub(super) fn is_settled(&self, index: usize) -> bool {
        let entry = self.entries.get(index);
        entry.is_some_and(|entry| entry.settled == Some(self.needs_epoch))
    }

    /// Inserts a prepared frame into the cache, replacing the previous one of its kind. One that lacks requested parts
    /// gives no information about sizes.
    pub(super) fn insert(&mut self, prepared: Arc<PreparedFrame>, is_complete: bool) {
        let index = prepared.index;
        let bytes = prepared.byte_size();
        self.facts.note(&prepared);
        self.largest_points = self.largest_points.max(prepared.frame.points_in_file());
        if is_complete && !prepared.frame.is_empty() {
            let per_point = bytes as f64 / prepared.frame.len() as f64;
            let max = self.bytes_per_point.map_or(per_point, |max| max.max(per_point));
            self.bytes_per_point = Some(max);
        }
        if prepared.is_sample() {
            let before = self.entries[index].coarse.replace(prepared);
            self.coarse_bytes -= byte_size(before.as_ref());
            self.coarse_bytes += bytes;
            self.coarse.insert(index);
        } else {
            if is_complete {
                self.learn_bytes(index, bytes);
            }
            let before = self.entries[index].full.replace(prepared);
            self.resident_bytes -= byte_size(before.as_ref());
            self.resident_bytes += bytes;
            self.resident.insert(index);
        }
    }

    /// Forgets the known sizes of frame `index`; a result in progress is dropped.
    pub(super) fn forget(&mut self, index: usize) {
        self.evict(index);
        self.evict_coarse(index);
        let Some(entry) = self.entries.get_mut(index) else {
            return;
        };
        entry.is_outdated = entry.reserved_bytes.is_some();
        (entry.known_bytes, entry.settled) = (None, None);
        if entry.error.take().is_some() {
            self.failed -= 1;
        }
    }

    /// Returns true if the file of frame `index` changed since a worker began to read it.
    pub(super) fn take_outdated(&mut self, index: usize) -> bool {
        std::mem::take(&mut self.entries[index].is_outdated)
    }

    /// Remembers why frame `index` cannot be shown.
    pub(super) fn fail(&mut self, error: Arc<FrameError>) {
        let index = error.index();
        if self.entries[index].error.replace(error).is_none() {
            self.failed += 1;
        }
    }

    /// State of every frame, in order. O(n).
    pub(super) fn states(&self, needs: Option<&Needs>, first: usize) -> Vec<FrameState> {
        let satisfies = |frame: &Option<Arc<PreparedFrame>>| {
            let frame = frame.as_ref();
            frame.is_some_and(|frame| needs.is_none_or(|needs| frame.satisfies(needs)))
        };
        let state = |(index, entry): (usize, &CacheEntry)| {
            let is_in_memory = entry.full.is_some() || entry.coarse.is_some();
            if index < first && !is_in_memory {
                FrameState::Gone
            } else if entry.error.is_some() {
                FrameState::Failed
            } else if satisfies(&entry.full) {
                FrameState::Ready
            } else if satisfies(&entry.coarse) {
                FrameState::Coarse
            } else if entry.reserved_bytes.is_some() {
                FrameState::Loading
            } else if is_in_memory {
                FrameState::Stale
            } else {
                FrameState::Absent
            }
        };
        self.entries.iter().enumerate().map(state).collect()
    }
}
