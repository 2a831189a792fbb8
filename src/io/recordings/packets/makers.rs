//! Makers whose packets are read, a row each, and which of all makers has sent a packet.
//!
//! To add a maker: a folder with its [`Maker`], and a row of the table. One whose packets are only recognised is a row
//! in [`super::unread`].

use super::companions::Companions;
use super::link::Datagram;
use super::maker::{Confidence, Maker, Recogniser, Sensor, Sort};
use super::unread::{Unread, unread};
use super::{ouster, velodyne};
use crate::messages::listed;

/// Supported makers; among those that are equally certain of a datagram, the first takes precedence.
pub(super) const MAKERS: &[Maker] = &[velodyne::MAKER, ouster::MAKER];

/// All makers, as far as the packets of one capture or one port are concerned.
pub(super) struct Makers(Vec<Box<dyn Recogniser>>);

/// Sender of a packet.
pub(super) enum Sender {
    /// A sensor of a maker whose packets are read.
    Read { maker: usize, sort: Sort },
    /// One whose packets are not.
    Unread(&'static Unread),
}

impl Makers {
    /// Creates the recognisers of all makers, where `companions` are the companion files of the packets.
    pub(super) fn new(companions: &Companions) -> Self {
        Self(MAKERS.iter().map(|maker| (maker.recogniser)(companions)).collect())
    }

    /// Returns true if a datagram may be from a supported sensor.
    pub(super) fn may_be(&self, datagram: &Datagram<'_>) -> bool {
        self.0.iter().any(|maker| maker.may_be(datagram))
    }

    /// Returns the sender of a datagram: the maker that is certain of it, otherwise a likely one.
    pub(super) fn sender(&mut self, datagram: &Datagram<'_>) -> Option<Sender> {
        let mut likely = None;
        for (maker, recogniser) in self.0.iter_mut().enumerate() {
            let Some(claim) = recogniser.can_read(datagram) else {
                continue;
            };
            let sender = Sender::Read {
                maker,
                sort: claim.sort,
            };
            if claim.confidence == Confidence::Certain {
                return Some(sender);
            }
            likely.get_or_insert(sender);
        }
        unread(datagram.port, datagram.bytes).map(Sender::Unread).or(likely)
    }

    /// The sensor of `maker` that sent a datagram.
    ///
    /// # Errors
    /// Why its packets cannot be read.
    pub(super) fn open(&mut self, maker: usize, datagram: &Datagram<'_>) -> Result<Box<dyn Sensor>, String> {
        self.0[maker].open(datagram)
    }
}

/// Display text of the makers whose packets are read.
pub(super) fn all_packets() -> String {
    let packets: Vec<String> = MAKERS.iter().map(|maker| maker.packets.to_owned()).collect();
    listed(&packets, "and")
}
