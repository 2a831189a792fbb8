//! Location of a LiDAR revolution within a capture.

use super::layout::Layout;
use super::maker::Scanner;
use super::part::TurnPart;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

/// A LiDAR revolution in a packet capture.
#[derive(Clone)]
pub struct Turn {
    pub(super) place: TurnPlace,
    /// Source address of the packets, and the port that they were sent to.
    pub(super) sensor: (IpAddr, u16),
    pub(super) scanner: Arc<dyn Scanner>,
    /// Packet layout that applies from its first packet on.
    pub(super) layout: Arc<Layout>,
}

/// Packet range of a revolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TurnPlace {
    /// File offsets of the records of its first and of its last packet.
    pub(super) begin: u64,
    pub(super) last: u64,
    pub(super) part: TurnPart,
}

/// A stopped head has no revolutions: then this time, or this number of packets, is one frame.
pub(super) const LONGEST_TURN: Duration = Duration::from_secs(2);
pub(super) const MAX_PACKETS: u64 = 1 << 14;

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
    /// Compares the packet ranges for equality; the results of decoding them depend on the files next to the capture.
    fn eq(&self, other: &Self) -> bool {
        (self.place, self.sensor) == (other.place, other.sensor)
    }
}

impl Eq for Turn {}
