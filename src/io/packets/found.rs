//! What sensors are in a capture, and where each of their turns is.
//!
//! **How it works.** Packet by packet: the head of the datagram tells the sensor (who sent it, and to which port), and
//! its first bytes whether a turn begins in it. Datagrams in fragments are not joined for that, as their first fragment
//! says enough; later ones only move the end of the turn. What is kept is a row a turn.
//!
//! A turn begins where the azimuth passes 0 (Velodyne) or where the number of the frame changes (Ouster). Packets of
//! Ouster that come late are found with the frame that they are of, if it is the one before.

use super::super::contents::{Contents, Entry, Part, Topic};
use super::super::options::ReadOptions;
use super::capture::Packet;
use super::companions::{self, Beside};
use super::layout::Layout;
use super::link::{Content, Datagram};
use super::ouster::{self, Metadata};
use super::sensor::{Kind, LEAST_OUSTER_BYTES, LONGEST_TURN, MOST_PACKETS};
use super::turn::{Turn, TurnPart, TurnPlace};
use super::velodyne::DataPacket;
use std::collections::BTreeMap;
use std::net::IpAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// More sensors are none of a recording, but a network's whole traffic, or noise.
const MOST_SENSORS: usize = 64;

/// What is found in a capture.
pub(super) struct FoundSensors<'a> {
    path: &'a Path,
    options: &'a ReadOptions,
    sensors: BTreeMap<(IpAddr, u16), Sensor>,
    /// Read once it is needed.
    beside: Option<Beside>,
}

/// Who sends packets.
struct Sensor {
    kind: Kind,
    packets: u64,
    turns: Vec<Row>,
    /// Of an Ouster, the turn that its last packet is of.
    current: usize,
}

/// A turn.
struct Row {
    place: TurnPlace,
    time: Duration,
    packets: u64,
    layout: Arc<Layout>,
}

impl<'a> FoundSensors<'a> {
    /// Nothing yet, in the capture at `path`.
    pub(super) fn new(path: &'a Path, options: &'a ReadOptions) -> Self {
        Self {
            path,
            options,
            sensors: BTreeMap::new(),
            beside: None,
        }
    }

    /// Looks at the next packet, which `layout` tells of.
    pub(super) fn add(&mut self, packet: &Packet<'_>, layout: &Arc<Layout>) {
        let datagram = match packet.link.content(packet.bytes) {
            Content::Datagram(datagram) => datagram,
            Content::Fragment(fragment) => {
                let Some(first) = fragment.first() else {
                    self.move_end(fragment.of.0, packet.offset);
                    return;
                };
                first
            }
            Content::Other => return,
        };
        if let Some(data) = DataPacket::of(datagram.bytes) {
            let sensor = self.sensor(&datagram, |found| Some(found.velodyne(data)));
            if let Some(sensor) = sensor {
                sensor.velodyne(data, packet, layout);
            }
        } else if datagram.byte_count >= LEAST_OUSTER_BYTES {
            let sensor = self.sensor(&datagram, |found| found.ouster(&datagram));
            if let Some(sensor) = sensor {
                sensor.ouster(&datagram, packet, layout);
            }
        }
    }

    /// The sensor that sent `datagram`; `make` tells of a new one, if it is one.
    fn sensor(&mut self, datagram: &Datagram<'_>, make: impl FnOnce(&mut Self) -> Option<Kind>) -> Option<&mut Sensor> {
        let key = (datagram.source, datagram.port);
        if !self.sensors.contains_key(&key) {
            if self.sensors.len() == MOST_SENSORS {
                return None;
            }
            let kind = make(self)?;
            let sensor = Sensor {
                kind,
                packets: 0,
                turns: Vec::new(),
                current: 0,
            };
            self.sensors.insert(key, sensor);
        }
        self.sensors.get_mut(&key)
    }

    fn velodyne(&self, data: DataPacket<'_>) -> Kind {
        Kind::velodyne(data, || companions::calibration(self.path, self.options))
    }

    fn ouster(&mut self, datagram: &Datagram<'_>) -> Option<Kind> {
        let beside = self
            .beside
            .get_or_insert_with(|| companions::metadata(self.path, self.options));
        let fits = |metadata: &&Metadata| metadata.shape.packet_bytes() == datagram.byte_count;
        // Of equals the first is the nearest by its name.
        let rank = |metadata: &&Metadata| {
            let serial = metadata.shape.serial(datagram.bytes);
            let has_other_serial = serial.zip(metadata.serial).is_some_and(|(sent, known)| sent != known);
            let has_port = metadata.port == Some(datagram.port);
            (has_other_serial, !has_port)
        };
        match beside.metadata.iter().filter(fits).min_by_key(rank) {
            Some(metadata) => {
                if rank(&metadata).0 {
                    log::warn!(
                        "{}: the metadata beside it is of another sensor of the same kind, by its serial number",
                        self.path.display()
                    );
                }
                Some(Kind::ouster(metadata))
            }
            None if ouster::may_be(datagram.byte_count) => Some(Kind::Unread(companions::no_metadata(
                self.path,
                datagram.byte_count,
                beside,
            ))),
            None => None,
        }
    }

    /// A later fragment of what `source` sent is at `offset`.
    fn move_end(&mut self, source: IpAddr, offset: u64) {
        for (_, sensor) in self.sensors.range_mut((source, 0)..=(source, u16::MAX)) {
            // Packets of Velodyne are none that networks would take apart.
            if matches!(sensor.kind, Kind::Ouster { .. })
                && let Some(row) = sensor.turns.get_mut(sensor.current)
            {
                row.place.last = offset;
            }
        }
    }

    /// All sensors, and the turns of `wanted`; of the one that sent most packets if `None`.
    ///
    /// # Errors
    /// Why no sensor's packets can be read.
    pub(super) fn contents(self, wanted: Option<&str>) -> Result<Contents, String> {
        let mut problems = Vec::new();
        let mut read: Vec<(String, (IpAddr, u16), Sensor)> = Vec::new();
        for (key, mut sensor) in self.sensors {
            match &sensor.kind {
                Kind::Unread(problem) => problems.push(problem.clone()),
                Kind::Velodyne { .. } | Kind::Ouster { .. } => {
                    sensor.leave_out_rest_of_turn();
                    read.push((name(key), key, sensor));
                }
            }
        }
        if read.is_empty() && !problems.is_empty() {
            problems.truncate(1);
            return Err(problems.remove(0));
        }
        for problem in problems {
            log::warn!("{}: a sensor is left out: {problem}", self.path.display());
        }
        // Addresses are in the order of numbers, topics in that of names.
        read.sort_by(|left, right| left.0.cmp(&right.0));
        let most = read.iter().map(|(_, _, sensor)| sensor.packets).max();
        let chosen = read.iter().position(|(name, _, sensor)| match wanted {
            Some(wanted) => name == wanted,
            None => Some(sensor.packets) == most,
        });
        let topics = read.iter().enumerate().map(|(index, (name, _, sensor))| Topic {
            name: name.clone(),
            cloud_count: sensor.turns.len(),
            is_read: Some(index) == chosen,
        });
        let topics = topics.collect();
        let entries = chosen.map(|index| read.swap_remove(index));
        let entries = entries.map_or_else(Vec::new, |(name, key, sensor)| sensor.entries(&name, key));
        Ok(Contents { entries, topics })
    }
}

/// The topic of a sensor.
fn name((address, port): (IpAddr, u16)) -> String {
    std::net::SocketAddr::new(address, port).to_string()
}

impl Sensor {
    fn velodyne(&mut self, data: DataPacket<'_>, packet: &Packet<'_>, layout: &Arc<Layout>) {
        self.packets += 1;
        let Kind::Velodyne { turning, .. } = &mut self.kind else {
            return;
        };
        let begins_at = turning.begins_at(data);
        let last = self.turns.last_mut();
        let is_over = last
            .as_ref()
            .is_some_and(|row| row.packets >= MOST_PACKETS || packet.time.saturating_sub(row.time) >= LONGEST_TURN);
        let begins_at = begins_at.or(is_over.then_some(0));
        if let Some(row) = last
            && begins_at != Some(0)
        {
            row.packets += 1;
            row.place.last = packet.offset;
            if let TurnPart::Cycles { end, .. } = &mut row.place.part {
                *end = begins_at.unwrap_or(u8::MAX);
            }
        }
        if let Some(first) = begins_at {
            self.turns.push(Row {
                place: TurnPlace {
                    begin: packet.offset,
                    last: packet.offset,
                    part: TurnPart::Cycles { first, end: u8::MAX },
                },
                time: packet.time,
                packets: 1,
                layout: Arc::clone(layout),
            });
        }
    }

    fn ouster(&mut self, datagram: &Datagram<'_>, packet: &Packet<'_>, layout: &Arc<Layout>) {
        self.packets += 1;
        let Kind::Ouster { shape, .. } = self.kind else {
            return;
        };
        let is_whole = datagram.byte_count == shape.packet_bytes();
        let Some(frame) = shape.frame_id(datagram.bytes).filter(|_| is_whole) else {
            return;
        };
        let mut recent = self.turns.iter().enumerate().rev().take(2);
        let is_its = |(_, row): &(usize, &Row)| row.place.part == TurnPart::Frame(frame);
        if let Some((index, _)) = recent.find(is_its) {
            let row = &mut self.turns[index];
            row.packets += 1;
            row.place.last = packet.offset;
            self.current = index;
            return;
        }
        self.current = self.turns.len();
        self.turns.push(Row {
            place: TurnPlace {
                begin: packet.offset,
                last: packet.offset,
                part: TurnPart::Frame(frame),
            },
            time: packet.time,
            packets: 1,
            layout: Arc::clone(layout),
        });
    }

    /// A capture begins in the middle of a turn. The rest of that turn is no frame where it is less than half of one:
    /// the view would be set up for it.
    fn leave_out_rest_of_turn(&mut self) {
        if let [first, second, _, ..] = self.turns.as_slice()
            && first.packets * 2 < second.packets
        {
            self.turns.remove(0);
        }
    }

    fn entries(self, name: &str, sensor: (IpAddr, u16)) -> Vec<Entry> {
        let (Kind::Velodyne { scanner, .. } | Kind::Ouster { scanner, .. }) = self.kind else {
            return Vec::new();
        };
        let entry = |(index, row): (usize, Row)| Entry {
            name: format!("{name} {index}"),
            time: Some(row.time),
            part: Part::Turn(Turn {
                place: row.place,
                sensor,
                scanner: Arc::clone(&scanner),
                layout: row.layout,
            }),
        };
        self.turns.into_iter().enumerate().map(entry).collect()
    }
}
