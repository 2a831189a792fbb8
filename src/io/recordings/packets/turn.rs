//! Where a turn of a laser scanner is in a capture.

use super::frame_id::FrameId;
use super::layout::Layout;
use super::{ouster, velodyne};
use std::net::IpAddr;
use std::sync::Arc;

/// A turn of a laser scanner in a capture of packets.
#[derive(Clone)]
pub struct Turn {
    pub(super) place: TurnPlace,
    /// Who sent it, and the port that it was sent to.
    pub(super) sensor: (IpAddr, u16),
    pub(super) scanner: Arc<Scanner>,
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

/// What of these packets is the turn's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TurnPart {
    /// From this cycle of the first packet to before that cycle of the last one.
    Cycles { first: u8, end: u8 },
    /// The columns of a frame.
    Frame(FrameId),
}

/// A sensor, and all that is needed to make points of its packets.
#[derive(Debug)]
pub(super) enum Scanner {
    Velodyne(velodyne::Scanner),
    Ouster(Box<ouster::Scanner>),
}

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
