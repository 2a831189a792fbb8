//! Reassembly of datagrams larger than the packets of a network.
//!
//! RFC 791 §3.2. The pieces of a datagram have a number in common and their offsets; they come in any order.
//! `etherparse` joins them; its pool of datagrams is not for untrusted captures, as its documentation says, since
//! incomplete datagrams would fill the memory. So at most [`MAX_OPEN`] datagrams wait here, each of 64 KiB at most. The
//! one that has waited longest is dropped for the next, and any that waits for longer than [`MAX_SPAN_BYTES`] of the
//! capture: its number may be used again by then. Dropped datagrams are counted.

use super::link::Fragment;
use etherparse::IpNumber;
use etherparse::defrag::IpDefragBuf;
use std::collections::{BTreeMap, VecDeque};
use std::net::IpAddr;

/// A LiDAR sends one datagram after the other: this many are open only where pieces are lost, or with many sensors.
const MAX_OPEN: usize = 32;

/// Pieces of a datagram follow one another within a few packets; numbers are used again after 65,536 datagrams.
const MAX_SPAN_BYTES: u64 = 4 << 20;

/// A datagram that is whole.
#[derive(Debug)]
pub(super) struct Joined {
    /// The bytes behind the header of IP.
    pub(super) bytes: Vec<u8>,
    /// Byte offset of the record of its earliest fragment in the file.
    pub(super) begin: u64,
}

/// The addresses and the number that all pieces of a datagram have in common.
type Key = (IpAddr, IpAddr, u32);

#[derive(Debug)]
struct Open {
    key: Key,
    begin: u64,
    pieces: IpDefragBuf,
}

/// Incomplete datagrams.
#[derive(Debug, Default)]
pub(super) struct Fragments {
    /// The oldest first.
    open: VecDeque<Open>,
    /// Datagrams that were given up, by their sender.
    lost: BTreeMap<IpAddr, u64>,
}

impl Fragments {
    /// Adds a piece whose record begins at `offset`; the datagram, once it is the last piece that was missing.
    pub(super) fn add(&mut self, fragment: &Fragment<'_>, offset: u64) -> Option<Joined> {
        while self
            .open
            .front()
            .is_some_and(|oldest| offset.saturating_sub(oldest.begin) > MAX_SPAN_BYTES)
        {
            self.give_up(0);
        }
        let found = self.open.iter().position(|open| open.key == fragment.of);
        let index = found.unwrap_or_else(|| {
            if self.open.len() == MAX_OPEN {
                self.give_up(0);
            }
            self.open.push_back(Open {
                key: fragment.of,
                begin: offset,
                pieces: IpDefragBuf::new(IpNumber::UDP, Vec::new(), Vec::new()),
            });
            self.open.len() - 1
        });
        let pieces = &mut self.open.get_mut(index)?.pieces;
        if pieces.add(fragment.offset, fragment.has_more, fragment.bytes).is_err() {
            // Contradictory pieces come from datagrams that were mixed up.
            self.give_up(index);
            return None;
        }
        if !pieces.is_complete() {
            return None;
        }
        self.open.remove(index).map(|open| Joined {
            begin: open.begin,
            bytes: open.pieces.take_bufs().0,
        })
    }

    fn give_up(&mut self, index: usize) {
        if let Some(open) = self.open.remove(index) {
            *self.lost.entry(open.key.0).or_default() += 1;
        }
    }

    /// Datagrams with missing pieces at the end of the capture or before, by their sender.
    pub(super) fn finish(mut self) -> BTreeMap<IpAddr, u64> {
        while !self.open.is_empty() {
            self.give_up(0);
        }
        self.lost
    }
}
