//! The revolutions of a sensor in a capture, a row each.

use super::layout::Layout;
use super::part::TurnPart;
use super::turn::{LONGEST_TURN, MAX_PACKETS, TurnPlace};
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// A revolution.
pub(super) struct Row {
    pub(super) place: TurnPlace,
    pub(super) time: Duration,
    packets: u64,
    pub(super) layout: Arc<Layout>,
}

/// The revolutions of a sensor.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) all: Vec<Row>,
    /// Packet count over all revolutions.
    pub(super) packets: u64,
    /// True if revolutions are split by time alone because the head does not rotate.
    is_cut_by_time: bool,
}

impl Row {
    /// A revolution that begins with a packet, whose first and last records are at `records`.
    pub(super) fn new(records: Range<u64>, part: TurnPart, time: Duration, layout: &Arc<Layout>) -> Self {
        Self {
            place: TurnPlace {
                begin: records.start,
                last: records.end,
                part,
            },
            time,
            packets: 1,
            layout: Arc::clone(layout),
        }
    }
}

impl Rows {
    /// Adds a packet of cycles, in which a revolution begins at `begins_at`; `row` is the one that begins with it.
    pub(super) fn add_cycles(&mut self, begins_at: Option<u8>, row: impl FnOnce(TurnPart) -> Row) {
        self.packets += 1;
        let row = row(TurnPart::Cycles { first: 0, end: u8::MAX });
        let last = self.all.last_mut();
        let is_over = last
            .as_ref()
            .is_some_and(|last| last.packets >= MAX_PACKETS || row.time.saturating_sub(last.time) >= LONGEST_TURN);
        self.is_cut_by_time |= is_over && begins_at.is_none();
        let begins_at = begins_at.or(is_over.then_some(0));
        if let Some(last) = last
            && begins_at != Some(0)
        {
            last.packets += 1;
            last.place.last = row.place.last;
            if let TurnPart::Cycles { end, .. } = &mut last.place.part {
                *end = begins_at.unwrap_or(u8::MAX);
            }
        }
        if let Some(first) = begins_at {
            let part = TurnPart::Cycles { first, end: u8::MAX };
            let place = TurnPlace { part, ..row.place };
            self.all.push(Row { place, ..row });
        }
    }

    /// Adds a packet of a frame that has a number; `row` is the frame if it begins with it.
    pub(super) fn add_frame(&mut self, row: Row) {
        self.packets += 1;
        // Late packets belong to the previous frame: all with the same frame number form one frame.
        let mut recent = self.all.iter_mut().rev().take(2);
        match recent.find(|known| known.place.part == row.place.part) {
            Some(known) => {
                known.packets += 1;
                known.place.begin = known.place.begin.min(row.place.begin);
                known.place.last = known.place.last.max(row.place.last);
            }
            None => self.all.push(row),
        }
    }

    /// Drops the first and the last revolution if they are less than half complete, since a capture begins and ends
    /// mid-revolution; returns a sentence that reports it.
    pub(super) fn drop_stubs(&mut self) -> Option<String> {
        let whole = self.whole_packets()?;
        // The automatic settings would otherwise be chosen for a partial revolution.
        let is_stub = |row: Option<&Row>| row.is_some_and(|row| row.packets * 2 < whole);
        let is_last = is_stub(self.all.last());
        let is_first = is_stub(self.all.first());
        let counts = |row: Option<&Row>| row.map_or(0, |row| row.packets);
        let (first, last) = (counts(self.all.first()), counts(self.all.last()));
        if is_last {
            self.all.pop();
        }
        if is_first {
            self.all.remove(0);
        }
        match (is_first, is_last) {
            (false, false) => None,
            (true, false) => Some(format!(
                "the first revolution is incomplete ({first} of about {whole} packets) and is skipped"
            )),
            (false, true) => Some(format!(
                "the last revolution is incomplete ({last} of about {whole} packets) and is skipped"
            )),
            (true, true) => Some(format!(
                "the first and the last revolution are incomplete ({first} and {last} of about {whole} packets) and \
                 are skipped"
            )),
        }
    }

    /// Packets of a whole revolution: the median of those that have one before and behind, or the longer one of two.
    /// `None` where no revolution is one.
    fn whole_packets(&self) -> Option<u64> {
        if self.is_cut_by_time {
            return None;
        }
        let mut packets: Vec<u64> = self.all.iter().map(|row| row.packets).collect();
        match packets.len() {
            0 | 1 => None,
            2 => packets.into_iter().max(),
            count => {
                let inner = &mut packets[1..count - 1];
                inner.sort_unstable();
                inner.get(inner.len() / 2).copied()
            }
        }
    }
}
