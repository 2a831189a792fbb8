//! Ouster sensors: identification of their packets, by the sidecar metadata or by packet length, and the start of their
//! revolutions.

use super::metadata::{MAX_BYTES, Metadata, is_metadata, parse};
use super::profile::{PacketShape, may_be};
use super::{Scanner, Unpacking};
use crate::io::recordings::packets::companions::{Companions, told};
use crate::io::recordings::packets::link::Datagram;
use crate::io::recordings::packets::maker::{
    self, Claim, CompanionKind, Confidence, Maker, Position, Recogniser, Sensor, Step, Unpack,
};
use crate::io::recordings::packets::part::{FrameId, TurnPart};
use crate::io::recordings::packets::points::Points;
use crate::io::recordings::packets::seam::{Coverage, Seam, TURN};
use std::sync::Arc;
use std::time::Duration;

pub(in super::super) const MAKER: Maker = Maker {
    packets: "Ouster (default: port 7502)",
    companion: CompanionKind {
        max_bytes: MAX_BYTES,
        is_one: is_metadata,
        check: |text| parse(text).map(drop),
    },
    recogniser: |companions| {
        Box::new(OfOuster {
            companions: companions.clone(),
            sidecar: None,
        })
    },
};

/// Larger than any other packets between sensors and clients.
const MIN_BYTES: usize = 1024;

struct OfOuster {
    companions: Companions,
    /// Read once it is needed.
    sidecar: Option<Sidecar>,
}

/// Sidecar metadata of the packets, and the problems met while reading it.
struct Sidecar {
    /// The nearest by their names first.
    metadata: Vec<Metadata>,
    /// Problems of the files that are metadata, one sentence each.
    problems: Vec<String>,
}

impl Sidecar {
    fn read(companions: &Companions) -> Self {
        let (mut metadata, mut problems) = (Vec::new(), Vec::new());
        for (name, text) in companions.texts("json", MAX_BYTES) {
            if !is_metadata(&text) {
                continue;
            }
            match parse(&text) {
                Ok(read) => metadata.push(read),
                Err(fault) => problems.push(told(&name, &fault)),
            }
        }
        Self { metadata, problems }
    }

    /// The metadata of the sensor that sent a datagram, and whether it is of another one of the same kind.
    fn of(&self, datagram: &Datagram<'_>) -> Option<(&Metadata, bool)> {
        let fits = |metadata: &&Metadata| metadata.shape.packet_bytes() == datagram.byte_count;
        // Among equals, the first has the closest name.
        let rank = |metadata: &&Metadata| {
            let serial = metadata.shape.serial(datagram.bytes);
            let has_other_serial = serial.zip(metadata.serial).is_some_and(|(sent, known)| sent != known);
            let has_port = metadata.port == Some(datagram.port);
            (has_other_serial, !has_port)
        };
        let nearest = self.metadata.iter().filter(fits).min_by_key(rank)?;
        Some((nearest, rank(&nearest).0))
    }

    /// Describes the present metadata, where a sensor's is missing, as the end of a sentence.
    fn others(&self) -> String {
        match (self.problems.first(), self.metadata.as_slice()) {
            (Some(problem), _) => format!("; {problem}"),
            (None, []) => String::new(),
            (None, others) => {
                let sizes = others.iter().map(|metadata| metadata.shape.packet_bytes().to_string());
                let sizes: Vec<String> = sizes.collect();
                format!("; what is there is of packets of {} bytes", sizes.join(", "))
            }
        }
    }
}

impl Recogniser for OfOuster {
    fn may_be(&self, datagram: &Datagram<'_>) -> bool {
        datagram.byte_count >= MIN_BYTES
    }

    fn can_read(&mut self, datagram: &Datagram<'_>) -> Option<Claim> {
        if !self.may_be(datagram) {
            return None;
        }
        let sidecar = self.sidecar.get_or_insert_with(|| Sidecar::read(&self.companions));
        let confidence = match sidecar.of(datagram) {
            Some(_) => Confidence::Certain,
            None if may_be(datagram.byte_count) => Confidence::Likely,
            None => return None,
        };
        let sort = format!("an Ouster (packets of {} bytes)", datagram.byte_count);
        Some(Claim {
            confidence,
            sort: sort.into(),
        })
    }

    fn open(&mut self, datagram: &Datagram<'_>) -> Result<Box<dyn Sensor>, String> {
        let sidecar = self.sidecar.get_or_insert_with(|| Sidecar::read(&self.companions));
        let capture = self.companions.capture();
        let Some((metadata, is_of_another)) = sidecar.of(datagram) else {
            let others = capture.map(|_| sidecar.others()).unwrap_or_default();
            return Err(format!(
                "it has packets of {} bytes as sensors of Ouster send them: expected the metadata of the sensor \
                 {}{others}",
                datagram.byte_count,
                self.companions.expected("json", "udp://:7502?os1.json")
            ));
        };
        if let Some(capture) = capture.filter(|_| is_of_another) {
            log::warn!(
                "{}: the metadata next to it is of another sensor of the same kind, by its serial number",
                capture.display()
            );
        }
        Ok(Box::new(Head {
            shape: metadata.shape,
            columns: metadata.columns,
            seam: 0,
            scanner: Arc::new(Scanner::new(metadata.clone())),
        }))
    }
}

/// A rotating head, or one that numbers its frames without rotating.
struct Head {
    shape: PacketShape,
    /// Measurements of a revolution.
    columns: usize,
    /// The measurement at which frames begin.
    seam: u16,
    scanner: Arc<Scanner>,
}

impl Head {
    fn sends(&self, packet: &[u8]) -> bool {
        packet.len() == self.shape.packet_bytes()
    }
}

impl Sensor for Head {
    fn scanner(&self) -> Arc<dyn maker::Scanner> {
        Arc::clone(&self.scanner) as _
    }

    fn cover(&self, packet: &[u8], coverage: &mut Coverage) {
        if !self.sends(packet) {
            return;
        }
        for column in self.shape.columns(packet) {
            let azimuth = usize::from(column.measurement) * TURN as usize / self.columns;
            coverage.add(azimuth as i32);
        }
    }

    fn time(&self, packet: &[u8]) -> Option<Duration> {
        let column = self.sends(packet).then(|| self.shape.columns(packet).next())??;
        Some(Duration::from_nanos(column.time_ns))
    }

    fn set_seam(&mut self, seam: Seam) {
        self.seam = (seam.azimuth as usize * self.columns / TURN as usize) as u16;
    }

    fn step(&mut self, packet: &[u8]) -> Option<Step> {
        let frame = self.sends(packet).then(|| self.shape.frame_of(packet, self.seam))??;
        Some(Step::Frame(frame))
    }
}

impl maker::Scanner for Scanner {
    fn names(&self) -> &'static [&'static str] {
        self.value_names()
    }

    fn unpack(&self, part: TurnPart) -> Box<dyn Unpack + '_> {
        let frame = match part {
            TurnPart::Frame(frame) => frame,
            TurnPart::Cycles { .. } => FrameId { number: 0, seam: 0 },
        };
        Box::new(Unpacking::new(self, frame))
    }
}

impl Unpack for Unpacking<'_> {
    fn add(&mut self, packet: &[u8], _: Position, points: &mut Points) -> bool {
        self.packet(packet, points);
        true
    }
}
