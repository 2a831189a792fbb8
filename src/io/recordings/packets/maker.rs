//! Makers of sensors whose packets are read: the content of a row of the table of makers ([`super::makers`]).
//!
//! A [`Recogniser`] rates how certain a datagram is of a sensor of the maker, and opens that [`Sensor`], which finds
//! the starts of revolutions. Its [`Scanner`] has everything needed to decode the packets of a revolution into points,
//! by [`Unpack`].

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
    /// Display text: the maker, and the name of its packets.
    pub(super) packets: &'static str,
    /// The file that packets of some of its sensors cannot be read without.
    pub(super) companion: CompanionKind,
    /// Creates the recogniser of the maker's packets, where `Companions` are their companion files.
    pub(super) recogniser: fn(&Companions) -> Box<dyn Recogniser>,
}

/// A file that packets of some sensors cannot be read without.
pub(super) struct CompanionKind {
    pub(super) max_bytes: u64,
    /// Returns true if a text is such a companion, or was meant as one.
    pub(super) is_one: fn(&str) -> bool,
    /// Validates a text; the error is the problem with it, if there is one.
    pub(super) check: fn(&str) -> Result<(), Fault>,
}

/// Knows the packets of a maker in a capture, or of those that come to a port.
pub(super) trait Recogniser: Send {
    /// Returns true if a datagram may be from a sensor of the maker: called for every datagram.
    fn may_be(&self, datagram: &Datagram<'_>) -> bool;

    /// Returns the maker's claim to a datagram, with its confidence; `None` if it is from none of its sensors.
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

/// Confidence of a maker's claim to a datagram, the less certain first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Confidence {
    /// By its length, which packets of others may have as well.
    Likely,
    /// By its first bytes, or by a companion file.
    Certain,
}

/// Display name of a sender, as far as known from one packet: equal for all packets of a sensor.
pub(super) type Sort = Cow<'static, str>;

/// A sensor, packet by packet. Packets that it does not send say nothing.
pub(super) trait Sensor: Send {
    /// Returns the scanner that converts its packets to points.
    fn scanner(&self) -> Arc<dyn Scanner>;

    /// Notes the azimuths that a packet measured.
    fn cover(&self, packet: &[u8], coverage: &mut Coverage);

    /// The time of a packet by the sensor's own clock.
    fn time(&self, packet: &[u8]) -> Option<Duration>;

    /// Revolutions begin at `seam` from the next packet on.
    fn set_seam(&mut self, seam: Seam);

    /// Returns the step of the next packet within the revolutions.
    fn step(&mut self, packet: &[u8]) -> Option<Step>;
}

/// Step of a packet within the revolutions of its sensor.
pub(super) enum Step {
    /// Cycles, with the one at which a revolution begins, if one does: 0 is the first.
    Cycles(Option<u8>),
    /// Columns of a frame that has a number.
    Frame(FrameId),
}

/// A sensor, and all that is needed to make points of its packets.
pub(super) trait Scanner: Debug + Send + Sync {
    /// Returns the names of the attributes of a point in addition to its position, the one to colour by first.
    fn names(&self) -> &'static [&'static str];

    /// Returns the unpacker that converts the packets of a revolution to points.
    fn unpack(&self, part: TurnPart) -> Box<dyn Unpack + '_>;
}

/// Decodes the packets of a revolution into points.
pub(super) trait Unpack {
    /// Appends the points of the part of a packet in the revolution; false where the sensor did not send it.
    fn add(&mut self, packet: &[u8], position: Position, points: &mut Points) -> bool;
}

/// Position of a packet in a revolution, first or last; one may be both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Position {
    pub(super) is_first: bool,
    pub(super) is_last: bool,
}
