//! Where a turn of a laser scanner is in a capture.

use super::layout::Layout;
use super::maker::Scanner;
use super::part::TurnPart;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

/// A turn of a laser scanner in a capture of packets.
#[derive(Clone)]
pub struct Turn {
    pub(super) place: TurnPlace,
    /// Who sent it, and the port that it was sent to.
    pub(super) sensor: (IpAddr, u16),
    pub(super) scanner: Arc<dyn Scanner>,
    /// What tells of the packets from its first one on.
    pub(super) layout: Arc<Layout>,
}

/// Which packets a turn is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TurnPlace {
    /// Where the record of its first packet begins in the file, and that of its last one.
    pub(super) begin: u64,
    pub(super) last: u64,
    pub(super) part: TurnPart,
}

/// A head that stands turns no more: then so much time is one frame, and so many packets are.
pub(super) const LONGEST_TURN: Duration = Duration::from_secs(2);
pub(super) const MOST_PACKETS: u64 = 1 << 14;

impl std::fmt::Debug for Turn {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Turn")
            .field("place", &self.place)
            .field("sensor", &self.sensor)
            .finish_non_exhaustive()
    }
}

impl PartialEq for Turn {
    /// The same packets; what is made of them is left to the files beside the capture.
    fn eq(&self, other: &Self) -> bool {
        (self.place, self.sensor) == (other.place, other.sensor)
    }
}

impl Eq for Turn {}
