//! Datagrams that are larger than the packets of a network, put together again.
//!
//! RFC 791 §3.2. The pieces of a datagram have a number in common and say where they belong. `etherparse` joins them;
//! its pool of datagrams is none for captures of strangers, as its text says, since pieces whose others never come
//! would fill the memory. So at most [`MOST_OPEN`] datagrams wait here, each of 64 KiB at most, and the one that has
//! waited longest is given up for the next.

use super::link::Fragment;
use etherparse::IpNumber;
use etherparse::defrag::IpDefragBuf;
use std::collections::VecDeque;
use std::net::IpAddr;

/// Scanners send one datagram after the other: as many as that wait only where pieces are lost, or from many scanners.
const MOST_OPEN: usize = 32;

/// What all pieces of a datagram have in common.
type Key = (IpAddr, IpAddr, u32);

/// Datagrams of which not all pieces have come.
#[derive(Debug, Default)]
pub(super) struct Fragments {
    /// The oldest first.
    open: VecDeque<(Key, IpDefragBuf)>,
}

impl Fragments {
    /// What was sent behind the header of IP, once `fragment` is the last piece of it that was missing.
    pub(super) fn add(&mut self, fragment: &Fragment<'_>) -> Option<Vec<u8>> {
        let found = self.open.iter().position(|(key, _)| *key == fragment.of);
        let index = found.unwrap_or_else(|| {
            if self.open.len() == MOST_OPEN {
                self.open.pop_front();
            }
            let joined = IpDefragBuf::new(IpNumber::UDP, Vec::new(), Vec::new());
            self.open.push_back((fragment.of, joined));
            self.open.len() - 1
        });
        let (_, joined) = self.open.get_mut(index)?;
        if joined.add(fragment.offset, fragment.has_more, fragment.bytes).is_err() {
            // Pieces that contradict one another are of datagrams that were mixed up.
            self.open.remove(index);
            return None;
        }
        if !joined.is_complete() {
            return None;
        }
        self.open.remove(index).map(|(_, joined)| joined.take_bufs().0)
    }
}
