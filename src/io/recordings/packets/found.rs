//! The sensors in a capture, and the places of their revolutions.
//!
//! **How it works.** Two walks. The first ([`FoundSensors::probe`]) examines the beginning of the capture: its sensors,
//! their azimuth ranges ([`super::seam`]), and the correctness of its clock ([`super::clock`]). The second
//! ([`FoundSensors::add`]) records the start and end of each revolution, one row each. Datagrams in fragments are
//! joined in both ([`super::fragments`]).
//!
//! A revolution begins where the azimuth passes the seam (Velodyne) or where the number of the frame changes (Ouster).
//! Late packets of Ouster are assigned to their frame, if it is the one before. Datagrams that no sensor sent are
//! counted for messages ([`super::traffic`]).

use super::capture::Packet;
use super::clock::{self, Clock, Fractions, Samples};
use super::companions::Companions;
use super::fragments::Fragments;
use super::layout::Layout;
use super::link::{Content, Datagram};
use super::maker::{self, Step};
use super::makers::{Makers, Sender};
use super::part::TurnPart;
use super::rows::{Row, Rows};
use super::seam::Coverage;
use super::traffic::{Traffic, said_cut};
use super::turn::Turn;
use crate::io::contents::{Contents, Entry, Part, Topic};
use crate::io::options::ReadOptions;
use std::collections::BTreeMap;
use std::net::IpAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// More sensors are none of a recording, but a network's whole traffic, or noise.
const MAX_SENSORS: usize = 64;

/// Sensors found in a capture.
pub(super) struct FoundSensors {
    makers: Makers,
    sensors: BTreeMap<(IpAddr, u16), Sensor>,
    fragments: Fragments,
    traffic: Traffic,
}

/// A sender of packets.
struct Sensor {
    /// Why its packets cannot be read, if they cannot.
    kind: Result<Box<dyn maker::Sensor>, String>,
    coverage: Coverage,
    samples: Samples,
    rows: Rows,
}

/// A datagram that is whole, and its place in the capture.
struct Received<'a> {
    datagram: Datagram<'a>,
    time: Duration,
    /// Byte offset of the record of its first fragment in the file, and of its last one.
    begin: u64,
    last: u64,
}

impl FoundSensors {
    /// Nothing yet, in the capture at `path`.
    pub(super) fn new(path: &Path, options: &ReadOptions) -> Self {
        let companions = Companions::Sidecar {
            capture: path.to_owned(),
            options: *options,
        };
        Self {
            makers: Makers::new(&companions),
            sensors: BTreeMap::new(),
            fragments: Fragments::default(),
            traffic: Traffic::default(),
        }
    }

    /// Looks at a packet of the beginning of the capture.
    pub(super) fn probe(&mut self, packet: &Packet<'_>) {
        self.receive(packet, |found, received| {
            if let Some(sensor) = found.sensor(&received.datagram) {
                sensor.probe(received);
            }
        });
    }

    /// Ends the first walk: revolutions are cut where the sensors do not measure. The clock of the capture.
    pub(super) fn end_probe(&mut self, fractions: Fractions) -> Clock {
        self.fragments = Fragments::default();
        self.traffic = Traffic::default();
        for sensor in self.sensors.values_mut() {
            if let Ok(kind) = &mut sensor.kind {
                kind.set_seam(sensor.coverage.seam());
            }
        }
        let samples: Vec<Samples> = self.sensors.values().map(|sensor| sensor.samples).collect();
        clock::of(fractions, &samples)
    }

    /// Looks at the next packet, which `layout` tells of.
    pub(super) fn add(&mut self, packet: &Packet<'_>, layout: &Arc<Layout>) {
        self.receive(packet, |found, received| match found.sensor(&received.datagram) {
            Some(sensor) => sensor.add(received, layout),
            None => found.traffic.add(&received.datagram),
        });
    }

    /// Hands `packet`, or the datagram that it is the last piece of, to `each`.
    fn receive(&mut self, packet: &Packet<'_>, each: impl FnOnce(&mut Self, &Received<'_>)) {
        match packet.link.content(packet.bytes) {
            Content::Datagram(datagram) if datagram.bytes.len() < datagram.byte_count => {
                self.traffic.add_cut(&datagram, packet.bytes.len());
            }
            Content::Datagram(datagram) => {
                let received = Received {
                    datagram,
                    time: packet.time,
                    begin: packet.offset,
                    last: packet.offset,
                };
                each(self, &received);
            }
            Content::Fragment(fragment) if packet.is_cut => {
                if let Some(first) = fragment.first() {
                    self.traffic.add_cut(&first, packet.bytes.len());
                }
            }
            Content::Fragment(fragment) => {
                let joined = self.fragments.add(&fragment, packet.offset);
                if let Some(joined) = joined
                    && let Some(datagram) = Datagram::of(fragment.of.0, &joined.bytes)
                {
                    let received = Received {
                        datagram,
                        time: packet.time,
                        begin: joined.begin,
                        last: packet.offset,
                    };
                    each(self, &received);
                }
            }
            Content::Other => self.traffic.add_other(),
        }
    }

    /// The sensor that sent `datagram`, if it is one that is known.
    fn sensor(&mut self, datagram: &Datagram<'_>) -> Option<&mut Sensor> {
        let key = (datagram.source, datagram.port);
        if !self.makers.may_be(datagram) {
            return None;
        }
        if !self.sensors.contains_key(&key) {
            if self.sensors.len() == MAX_SENSORS {
                return None;
            }
            let Some(Sender::Read { maker, .. }) = self.makers.sender(datagram) else {
                return None;
            };
            let sensor = Sensor {
                kind: self.makers.open(maker, datagram),
                coverage: Coverage::default(),
                samples: Samples::default(),
                rows: Rows::default(),
            };
            self.sensors.insert(key, sensor);
        }
        self.sensors.get_mut(&key)
    }

    /// All sensors, and the revolutions of `wanted`; of the one that sent most packets if `None`.
    ///
    /// # Errors
    /// Why no sensor's packets can be read.
    pub(super) fn contents(self, wanted: Option<&str>, clock: Clock) -> Result<Contents, String> {
        let mut problems = Vec::new();
        let mut read: Vec<(String, (IpAddr, u16), Sensor)> = Vec::new();
        let mut notes: Vec<String> = clock.note().map(str::to_owned).into_iter().collect();
        let lost = self.fragments.finish();
        for (key, sensor) in self.sensors {
            match &sensor.kind {
                Err(problem) => problems.push(problem.clone()),
                Ok(_) => read.push((name(key), key, sensor)),
            }
        }
        if read.is_empty() {
            if let Some(problem) = problems.into_iter().next() {
                return Err(problem);
            }
            let mut without_frames = self.traffic.describe();
            let count: u64 = lost.values().sum();
            if count > 0 {
                without_frames.push_str("; ");
                without_frames.push_str(&said_lost(count));
            }
            return Ok(Contents {
                notes,
                without_frames,
                ..Contents::default()
            });
        }
        notes.extend(problems.iter().map(|problem| format!("a sensor is skipped: {problem}")));
        notes.extend(self.traffic.notes());
        // Addresses are sorted numerically, topics by name.
        read.sort_by(|left, right| left.0.cmp(&right.0));
        let max = read.iter().map(|(_, _, sensor)| sensor.rows.packets).max();
        let chosen = read.iter().position(|(name, _, sensor)| match wanted {
            Some(wanted) => name == wanted,
            None => Some(sensor.rows.packets) == max,
        });
        for (index, (name, key, sensor)) in read.iter_mut().enumerate() {
            let stubs = sensor.rows.drop_stubs();
            if Some(index) == chosen {
                let cut = self.traffic.cut_of(*key);
                let lost = lost.get(&key.0).copied();
                let skipped = [
                    stubs,
                    lost.map(said_lost),
                    cut.map(|cut| said_cut(cut.count, cut.captured_bytes)),
                ];
                notes.extend(skipped.into_iter().flatten().map(|note| format!("{name}: {note}")));
            }
        }
        let topics = read.iter().enumerate().map(|(index, (name, _, sensor))| Topic {
            name: name.clone(),
            cloud_count: sensor.rows.all.len(),
            is_read: Some(index) == chosen,
        });
        let topics = topics.collect();
        let entries = chosen.map(|index| read.swap_remove(index));
        let entries = entries.map_or_else(Vec::new, |(name, key, sensor)| sensor.entries(&name, key));
        Ok(Contents {
            entries,
            topics,
            notes,
            ..Contents::default()
        })
    }
}

/// The topic of a sensor.
fn name((address, port): (IpAddr, u16)) -> String {
    std::net::SocketAddr::new(address, port).to_string()
}

fn said_lost(count: u64) -> String {
    format!("fragments of {count} datagrams are missing: these packets are skipped")
}

impl Sensor {
    /// Notes the azimuths of a packet, and its times.
    fn probe(&mut self, received: &Received<'_>) {
        let bytes = received.datagram.bytes;
        let Ok(kind) = &self.kind else { return };
        kind.cover(bytes, &mut self.coverage);
        if let Some(measured) = kind.time(bytes) {
            self.samples.add(received.time, measured);
        }
    }

    fn add(&mut self, received: &Received<'_>, layout: &Arc<Layout>) {
        let bytes = received.datagram.bytes;
        let row = |part| Row::new(received.begin..received.last, part, received.time, layout);
        let Ok(kind) = &mut self.kind else { return };
        match kind.step(bytes) {
            Some(Step::Cycles(begins_at)) => self.rows.add_cycles(begins_at, row),
            Some(Step::Frame(frame)) => self.rows.add_frame(row(TurnPart::Frame(frame))),
            None => {}
        }
    }

    fn entries(self, name: &str, sensor: (IpAddr, u16)) -> Vec<Entry> {
        let Ok(kind) = self.kind else { return Vec::new() };
        let scanner = kind.scanner();
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
        self.rows.all.into_iter().enumerate().map(entry).collect()
    }
}
