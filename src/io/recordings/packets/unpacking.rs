//! From the packets of a turn to its points, whichever sensor sent them.

use super::super::containers::CAPTURE;
use super::frame_id::FrameId;
use super::points::Points;
use super::turn::{Scanner, TurnPart};
use super::velodyne::DataPacket;
use super::{ouster, velodyne};
use crate::cloud::RawCloud;

/// Makes points of the packets of a turn.
pub(super) struct Unpacking<'a> {
    maker: Maker<'a>,
    pub(super) points: Points,
    /// That were of the sensor, so far.
    pub(super) packets: u64,
}

enum Maker<'a> {
    Velodyne {
        unpacking: velodyne::Unpacking<'a>,
        /// The cycle of the first packet that the turn begins with, and the one of the last packet that it ends before.
        first: u8,
        end: u8,
    },
    Ouster(ouster::Unpacking<'a>),
}

/// Which packet of a turn it is; one may be both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Position {
    pub(super) is_first: bool,
    pub(super) is_last: bool,
}

impl<'a> Unpacking<'a> {
    pub(super) fn new(scanner: &'a Scanner, part: TurnPart) -> Self {
        let (maker, names) = match scanner {
            Scanner::Velodyne(scanner) => {
                let (first, end) = match part {
                    TurnPart::Cycles { first, end } => (first, end),
                    TurnPart::Frame(_) => (0, u8::MAX),
                };
                let unpacking = velodyne::Unpacking::new(scanner);
                (Maker::Velodyne { unpacking, first, end }, velodyne::NAMES)
            }
            Scanner::Ouster(scanner) => {
                let frame = match part {
                    TurnPart::Frame(frame) => frame,
                    TurnPart::Cycles { .. } => FrameId { number: 0, seam: 0 },
                };
                (Maker::Ouster(ouster::Unpacking::new(scanner, frame)), scanner.names())
            }
        };
        Self {
            maker,
            points: Points::new(names),
            packets: 0,
        }
    }

    /// What the sensor sent in a datagram.
    pub(super) fn add(&mut self, bytes: &[u8], position: Position) {
        match &mut self.maker {
            Maker::Velodyne { unpacking, first, end } => {
                let Some(data) = DataPacket::of(bytes) else {
                    return;
                };
                let from = if position.is_first { usize::from(*first) } else { 0 };
                let to = if position.is_last {
                    usize::from(*end)
                } else {
                    usize::MAX
                };
                unpacking.packet(data, from..to, &mut self.points);
            }
            Maker::Ouster(unpacking) => unpacking.packet(bytes, &mut self.points),
        }
        self.packets += 1;
    }

    /// The cloud of all points.
    pub(super) fn finish(self) -> RawCloud {
        let mut cloud = self.points.finish();
        cloud.unit = CAPTURE.unit();
        cloud.convention = CAPTURE.convention();
        cloud
    }
}
