//! Sensors of Velodyne: recognition of their packets, and the starts of their revolutions.

use super::calibration::{Calibration, MAX_BYTES, is_calibration, parse};
use super::model::Model;
use super::packet::DataPacket;
use super::{NAMES, Scanner, Turning, Unpacking};
use crate::io::recordings::packets::companions::{Companions, told};
use crate::io::recordings::packets::link::Datagram;
use crate::io::recordings::packets::maker::{
    self, Claim, CompanionKind, Confidence, Maker, Position, Recogniser, Sensor, Step, Unpack,
};
use crate::io::recordings::packets::part::TurnPart;
use crate::io::recordings::packets::points::Points;
use crate::io::recordings::packets::seam::{Coverage, Seam};
use std::sync::Arc;
use std::time::Duration;

pub(in super::super) const MAKER: Maker = Maker {
    packets: "Velodyne (1206 bytes, default: port 2368)",
    companion: CompanionKind {
        max_bytes: MAX_BYTES,
        is_one: is_calibration,
        check: |text| parse(text).map(drop),
    },
    recogniser: |companions| Box::new(OfVelodyne(companions.clone())),
};

struct OfVelodyne(Companions);

impl OfVelodyne {
    /// The calibration of an HDL-64E.
    ///
    /// # Errors
    /// Its expected location, or the fault of the present one.
    fn calibration(&self) -> Result<Calibration, String> {
        let mut texts = self.0.texts("xml", MAX_BYTES);
        if let Some((name, text)) = texts.find(|(_, text)| is_calibration(text)) {
            return parse(&text).map_err(|fault| told(&name, &fault));
        }
        let name = if self.0.capture().is_some() { " db.xml" } else { "" };
        Err(format!(
            "it has packets of an HDL-64E, whose lasers are calibrated one by one: expected its calibration{name} {}",
            self.0.expected("xml", "udp://:2368?db.xml")
        ))
    }
}

impl Recogniser for OfVelodyne {
    fn may_be(&self, datagram: &Datagram<'_>) -> bool {
        DataPacket::of(datagram.bytes).is_some()
    }

    fn can_read(&mut self, datagram: &Datagram<'_>) -> Option<Claim> {
        let sort = match Model::of(DataPacket::of(datagram.bytes)?) {
            Ok(model) => format!("a Velodyne {model:?}"),
            Err(byte) => format!("an unknown model of Velodyne ({byte:#04x})"),
        };
        Some(Claim {
            confidence: Confidence::Certain,
            sort: sort.into(),
        })
    }

    fn open(&mut self, datagram: &Datagram<'_>) -> Result<Box<dyn Sensor>, String> {
        let packet = DataPacket::of(datagram.bytes).ok_or("it has no packet of Velodyne")?;
        let model = Model::of(packet).map_err(|byte| {
            format!(
                "it has packets of a sensor of Velodyne whose model is {byte:#04x}, expected one of VLP-16 (0x22), \
                 Puck Hi-Res (0x24), HDL-32E (0x21), VLP-32C (0x28), VLS-128 (0xa1), or an HDL-64E; other makers, such \
                 as LSLiDAR, send packets of the same form: convert the capture to PCD with their program"
            )
        })?;
        let calibration = (model == Model::Hdl64).then(|| self.calibration()).transpose()?;
        Ok(Box::new(Head {
            turning: Turning::new(model),
            scanner: Arc::new(Scanner::new(model, calibration)),
        }))
    }
}

/// A rotating head.
struct Head {
    turning: Turning,
    scanner: Arc<Scanner>,
}

impl Sensor for Head {
    fn scanner(&self) -> Arc<dyn maker::Scanner> {
        Arc::clone(&self.scanner) as _
    }

    fn cover(&self, packet: &[u8], coverage: &mut Coverage) {
        let data = DataPacket::of(packet).into_iter();
        let azimuths = data.flat_map(|data| self.turning.azimuths(data));
        azimuths.for_each(|azimuth| coverage.add(azimuth));
    }

    fn time(&self, packet: &[u8]) -> Option<Duration> {
        let data = DataPacket::of(packet)?;
        Some(Duration::from_micros(data.time_us().into()))
    }

    fn set_seam(&mut self, seam: Seam) {
        self.turning.set_seam(seam);
    }

    fn step(&mut self, packet: &[u8]) -> Option<Step> {
        let data = DataPacket::of(packet)?;
        Some(Step::Cycles(self.turning.begins_at(data)))
    }
}

impl maker::Scanner for Scanner {
    fn names(&self) -> &'static [&'static str] {
        NAMES
    }

    fn unpack(&self, part: TurnPart) -> Box<dyn Unpack + '_> {
        let (first, end) = match part {
            TurnPart::Cycles { first, end } => (first, end),
            TurnPart::Frame(_) => (0, u8::MAX),
        };
        Box::new(Cycles {
            unpacking: Unpacking::new(self),
            first,
            end,
        })
    }
}

/// The cycles of a revolution.
struct Cycles<'a> {
    unpacking: Unpacking<'a>,
    /// The cycle of the first packet at which the revolution begins, and the cycle of the last packet before which it
    /// ends.
    first: u8,
    end: u8,
}

impl Unpack for Cycles<'_> {
    fn add(&mut self, packet: &[u8], position: Position, points: &mut Points) -> bool {
        let Some(data) = DataPacket::of(packet) else {
            return false;
        };
        let from = if position.is_first { self.first.into() } else { 0 };
        let to = if position.is_last { self.end.into() } else { usize::MAX };
        self.unpacking.packet(data, from..to, points);
        true
    }
}
