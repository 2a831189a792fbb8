//! Makers of sensors whose packets are read: what a row of the table of makers ([`super::makers`]) has.
//!
//! A [`Recogniser`] says of a datagram how certain it is of a sensor of the maker, and opens that [`Sensor`], which
//! finds where turns begin. Its [`Scanner`] is all that is needed to make points of the packets of a turn, by
//! [`Unpack`].

use super::companions::Companions;
use super::link::Datagram;
use super::part::{FrameId, TurnPart};
use super::points::Points;
use super::seam::{Coverage, Seam};
use crate::io::error::Fault;
use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::Arc;
use std::time::Duration;

/// A maker whose packets are read.
pub(super) struct Maker {
    /// For people: the maker, and what its packets are known by.
    pub(super) packets: &'static str,
    /// The file that packets of some of its sensors cannot be read without.
    pub(super) companion: CompanionKind,
    /// What knows its packets, where `Companions` are the files beside them.
    pub(super) recogniser: fn(&Companions) -> Box<dyn Recogniser>,
}

/// A file that packets of some sensors cannot be read without.
pub(super) struct CompanionKind {
    pub(super) most_bytes: u64,
    /// Whether a text is one, or was meant as one.
    pub(super) is_one: fn(&str) -> bool,
    /// What is wrong with a text, if something is.
    pub(super) check: fn(&str) -> Result<(), Fault>,
}

/// Knows the packets of a maker in a capture, or of those that come to a port.
pub(super) trait Recogniser: Send {
    /// Whether a datagram may be of a sensor of the maker: asked of every one.
    fn may_be(&self, datagram: &Datagram<'_>) -> bool;

    /// How certain a datagram is of a sensor of the maker; `None` of none.
    fn can_read(&mut self, datagram: &Datagram<'_>) -> Option<Claim>;

    /// The sensor that sent a datagram.
    ///
    /// # Errors
    /// Why its packets cannot be read, as a sentence.
    fn open(&mut self, datagram: &Datagram<'_>) -> Result<Box<dyn Sensor>, String>;
}

/// A maker's claim to a datagram.
pub(super) struct Claim {
    pub(super) confidence: Confidence,
    pub(super) sort: Sort,
}

/// How certain a maker is of a datagram, the less certain first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Confidence {
    /// By its length, which packets of others may have as well.
    Likely,
    /// By its first bytes, or by a file beside it.
    Certain,
}

/// A sender for people, as far as one packet tells: equal for all packets of a sensor.
pub(super) type Sort = Cow<'static, str>;

/// A sensor, packet by packet. Packets that it does not send say nothing.
pub(super) trait Sensor: Send {
    /// What makes points of its packets.
    fn scanner(&self) -> Arc<dyn Scanner>;

    /// Notes the azimuths that a packet measured.
    fn cover(&self, packet: &[u8], coverage: &mut Coverage);

    /// The time of a packet by the sensor's own clock.
    fn time(&self, packet: &[u8]) -> Option<Duration>;

    /// Turns begin at `seam` from the next packet on.
    fn set_seam(&mut self, seam: Seam);

    /// What the next packet is to the turns.
    fn step(&mut self, packet: &[u8]) -> Option<Step>;
}

/// What a packet is to the turns of its sensor.
pub(super) enum Step {
    /// Cycles, at one of which a turn begins, if one does: 0 is the first.
    Cycles(Option<u8>),
    /// Columns of a frame that has a number.
    Frame(FrameId),
}

/// A sensor, and all that is needed to make points of its packets.
pub(super) trait Scanner: Debug + Send + Sync {
    /// The names of what is known of a point beside its place, the one to colour by first.
    fn names(&self) -> &'static [&'static str];

    /// What makes points of the packets of a turn.
    fn unpack(&self, part: TurnPart) -> Box<dyn Unpack + '_>;
}

/// Makes points of the packets of a turn.
pub(super) trait Unpack {
    /// Appends the points of a packet, of as much of it as is of the turn; false where the sensor did not send it.
    fn add(&mut self, packet: &[u8], position: Position, points: &mut Points) -> bool;
}

/// Which packet of a turn it is; one may be both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Position {
    pub(super) is_first: bool,
    pub(super) is_last: bool,
}
