//! What is known of every frame, and the memory of it: prepared frames, errors, work in flight, against a byte budget.
//!
//! **How it works.** Bytes are counted in two sums: *resident* for prepared frames, *reserved* for frames that a worker is
//! making (as large as the frame was before, or as the largest seen). Before work starts, frames that are needed later
//! than its frame are evicted, the one needed last first, until both sums and the new reservation fit.
//!
//! **What is needed last** is, without looping, what lies farthest behind; in a loop, what was shown just now, because the
//! whole sequence comes before it again. A loop that does not fit then keeps up to half of the budget resident and streams
//! the rest through the other half, where evicting the least recently used would read every frame again on every turn.

use super::stats::FrameState;
use crate::sequence::travel::{Direction, Travel};
use crate::sequence::{FrameError, Needs, PreparedFrame};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Where the playhead is and where it goes: the order in which frames are needed.
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
struct Entry {
    prepared: Option<Arc<PreparedFrame>>,
    error: Option<Arc<FrameError>>,
    /// Bytes reserved by the worker that is on it.
    reserved_bytes: Option<usize>,
    /// Size when it was last prepared, and for which of the needs that there were.
    known_bytes: Option<(u64, usize)>,
}

/// All frames' entries and their memory.
#[derive(Debug)]
pub(super) struct Cache {
    entries: Vec<Entry>,
    resident: BTreeSet<usize>,
    resident_bytes: usize,
    reserved_bytes: usize,
    in_flight: usize,
    /// Of the frames prepared for the present needs.
    largest_bytes: Option<usize>,
    /// Counts the needs that there were.
    needs_epoch: u64,
    failed: usize,
    evicted: u64,
    budget_bytes: usize,
}

impl Cache {
    pub(super) fn new(frame_count: usize, budget_bytes: usize) -> Self {
        Self {
            entries: std::iter::repeat_with(Entry::default)
                .take(frame_count)
                .collect(),
            resident: BTreeSet::new(),
            resident_bytes: 0,
            reserved_bytes: 0,
            in_flight: 0,
            largest_bytes: None,
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
            self.entries.resize_with(frame_count, Entry::default);
        }
    }

    pub(super) fn prepared(&self, index: usize) -> Option<&Arc<PreparedFrame>> {
        self.entries.get(index)?.prepared.as_ref()
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

    /// Prepared frames and reservations.
    pub(super) fn used_bytes(&self) -> usize {
        self.resident_bytes + self.reserved_bytes
    }

    pub(super) fn resident_bytes(&self) -> usize {
        self.resident_bytes
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

    /// Bytes that frame `index` holds or reserves now.
    pub(super) fn held_bytes(&self, index: usize) -> usize {
        let entry = &self.entries[index];
        entry.prepared.as_ref().map_or(0, |frame| frame.byte_size())
            + entry.reserved_bytes.unwrap_or(0)
    }

    /// How large frame `index` is expected to be; `None` while no frame was prepared for the present needs.
    pub(super) fn expected_bytes(&self, index: usize) -> Option<usize> {
        self.entries[index]
            .known_bytes
            .and_then(|(epoch, bytes)| (epoch == self.needs_epoch).then_some(bytes))
            .or(self.largest_bytes)
    }

    /// The needs have changed: what is known of sizes is known no more.
    pub(super) fn forget_sizes(&mut self) {
        self.needs_epoch += 1;
        self.largest_bytes = None;
    }

    /// Evicts frames that are needed later than `rank`, the one needed last first, until `bytes` more fit into the
    /// budget. False if they still do not. The playhead's frame is never evicted.
    pub(super) fn make_room(&mut self, bytes: usize, focus: &Focus, rank: usize) -> bool {
        loop {
            if self.used_bytes().saturating_add(bytes) <= self.budget_bytes {
                return true;
            }
            let victim = focus
                .travel
                .needed_last_first(&self.resident, focus.playhead, focus.direction)
                .next()
                .filter(|&index| focus.rank(index) > rank);
            match victim {
                Some(index) => self.evict(index),
                None => return false,
            }
        }
    }

    fn evict(&mut self, index: usize) {
        if let Some(frame) = self.entries[index].prepared.take() {
            self.resident.remove(&index);
            self.resident_bytes -= frame.byte_size();
            self.evicted += 1;
        }
    }

    /// A worker starts on frame `index` and will need `bytes` beyond what the frame holds.
    pub(super) fn reserve(&mut self, index: usize, bytes: usize) {
        let entry = &mut self.entries[index];
        match entry.reserved_bytes.replace(bytes) {
            Some(before) => self.reserved_bytes -= before,
            None => self.in_flight += 1,
        }
        self.reserved_bytes += bytes;
    }

    /// The worker is done with frame `index`, whatever came of it.
    pub(super) fn release(&mut self, index: usize) {
        if let Some(bytes) = self.entries[index].reserved_bytes.take() {
            self.reserved_bytes -= bytes;
            self.in_flight -= 1;
        }
    }

    /// Remembers how large frame `index` is.
    pub(super) fn learn_bytes(&mut self, index: usize, bytes: usize) {
        self.entries[index].known_bytes = Some((self.needs_epoch, bytes));
        self.largest_bytes = Some(self.largest_bytes.map_or(bytes, |most| most.max(bytes)));
    }

    /// Keeps a prepared frame in place of the one before.
    pub(super) fn insert(&mut self, prepared: Arc<PreparedFrame>) {
        let index = prepared.index;
        let bytes = prepared.byte_size();
        self.learn_bytes(index, bytes);
        let before = self.entries[index].prepared.replace(prepared);
        self.resident_bytes -= before.map_or(0, |frame| frame.byte_size());
        self.resident_bytes += bytes;
        self.resident.insert(index);
    }

    /// Remembers why frame `index` cannot be shown.
    pub(super) fn fail(&mut self, error: Arc<FrameError>) {
        let index = error.index();
        if self.entries[index].error.replace(error).is_none() {
            self.failed += 1;
        }
    }

    /// State of every frame, in order. O(n).
    pub(super) fn states(&self, needs: Option<&Needs>) -> Vec<FrameState> {
        let state = |entry: &Entry| match entry {
            Entry { error: Some(_), .. } => FrameState::Failed,
            Entry {
                prepared: Some(frame),
                ..
            } if needs.is_none_or(|needs| frame.satisfies(needs)) => FrameState::Ready,
            Entry {
                reserved_bytes: Some(_),
                ..
            } => FrameState::Loading,
            Entry {
                prepared: Some(_), ..
            } => FrameState::Stale,
            _ => FrameState::Absent,
        };
        self.entries.iter().map(state).collect()
    }
}
