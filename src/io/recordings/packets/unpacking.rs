//! From the packets of a revolution to its points, for any sensor.

use super::maker::{Position, Scanner, Unpack};
use super::part::TurnPart;
use super::points::Points;
use crate::cloud::RawCloud;
use crate::io::recordings::containers::CAPTURE;

/// Decodes the packets of a revolution into points.
pub(super) struct Unpacking<'a> {
    unpack: Box<dyn Unpack + 'a>,
    pub(super) points: Points,
    /// That were of the sensor, so far.
    pub(super) packets: u64,
}

impl<'a> Unpacking<'a> {
    pub(super) fn new(scanner: &'a dyn Scanner, part: TurnPart) -> Self {
        Self {
            unpack: scanner.unpack(part),
            points: Points::new(scanner.names()),
            packets: 0,
        }
    }

    /// Adds a datagram sent by the sensor.
    pub(super) fn add(&mut self, bytes: &[u8], position: Position) {
        self.packets += u64::from(self.unpack.add(bytes, position, &mut self.points));
    }

    /// The cloud of all points.
    pub(super) fn finish(self) -> RawCloud {
        let mut cloud = self.points.finish();
        cloud.unit = CAPTURE.unit();
        cloud.convention = CAPTURE.convention();
        cloud
    }
}
