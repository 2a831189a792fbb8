//! Writes captures: UDP in IP in Ethernet, in every container.

use pointreel::cloud::RawCloud;
use pointreel::io::{self, Part, ReadOptions};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A file with packets in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Container {
    Pcap,
    PcapBigNanoseconds,
    PcapNg,
    PcapNgBig,
}

/// The first bytes of packets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Link {
    Ethernet,
    Vlan,
    Cooked,
    /// Its second version.
    Cooked2,
    Raw,
}

pub(crate) const ALL_CONTAINERS: [Container; 4] = [
    Container::Pcap,
    Container::PcapBigNanoseconds,
    Container::PcapNg,
    Container::PcapNgBig,
];

/// Sender, and target port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sender {
    pub(crate) host: u8,
    pub(crate) port: u16,
}

pub(crate) const SENDER: Sender = Sender { host: 201, port: 2368 };

/// A capture that grows.
pub(crate) struct Writer {
    pub(crate) container: Container,
    pub(crate) link: Link,
    pub(crate) bytes: Vec<u8>,
    /// The largest packet of the network.
    pub(crate) mtu: usize,
    /// Of the next datagram.
    number: u16,
}

/// The largest packet of the network.
const MTU: usize = 1500;

/// When captures begin, in seconds since 1970.
pub(crate) const BEGIN_S: u64 = 1_700_000_000;

impl Writer {
    pub(crate) fn new(container: Container, link: Link) -> Self {
        let mut writer = Self {
            container,
            link,
            bytes: Vec::new(),
            mtu: MTU,
            number: 1,
        };
        let link = match link {
            Link::Ethernet | Link::Vlan => 1u16,
            Link::Cooked => 113,
            Link::Cooked2 => 276,
            Link::Raw => 101,
        };
        match container {
            Container::Pcap | Container::PcapBigNanoseconds => {
                let is_little = container == Container::Pcap;
                writer.u32(if is_little { 0xa1b2_c3d4 } else { 0xa1b2_3c4d });
                writer.u16(2);
                writer.u16(4);
                for number in [0, 0, 262_144, u32::from(link)] {
                    writer.u32(number);
                }
            }
            Container::PcapNg | Container::PcapNgBig => {
                let mut section = writer.like();
                section.u32(0x1a2b_3c4d);
                section.u16(1);
                section.u16(0);
                section.bytes.extend([0xff; 8]);
                let section = section.bytes;
                writer.block(0x0a0d_0d0a, &section);
                let mut interface = writer.like();
                interface.u16(link);
                interface.u16(0);
                interface.u32(0);
                // Nanoseconds.
                interface.u16(9);
                interface.u16(1);
                interface.bytes.extend([9, 0, 0, 0]);
                interface.u32(0);
                let interface = interface.bytes;
                writer.block(1, &interface);
            }
        }
        writer
    }

    fn like(&self) -> Self {
        Self {
            container: self.container,
            link: self.link,
            bytes: Vec::new(),
            mtu: MTU,
            number: 0,
        }
    }

    fn is_big(&self) -> bool {
        matches!(self.container, Container::PcapBigNanoseconds | Container::PcapNgBig)
    }

    fn u16(&mut self, number: u16) {
        let raw = if self.is_big() {
            number.to_be_bytes()
        } else {
            number.to_le_bytes()
        };
        self.bytes.extend(raw);
    }

    fn u32(&mut self, number: u32) {
        let raw = if self.is_big() {
            number.to_be_bytes()
        } else {
            number.to_le_bytes()
        };
        self.bytes.extend(raw);
    }

    pub(crate) fn block(&mut self, kind: u32, body: &[u8]) {
        let padding = body.len().next_multiple_of(4) - body.len();
        let length = (12 + body.len() + padding) as u32;
        self.u32(kind);
        self.u32(length);
        self.bytes.extend(body);
        self.bytes.extend(vec![0; padding]);
        self.u32(length);
    }

    /// Appends a captured packet of a link.
    pub(crate) fn packet(&mut self, time: Duration, bytes: &[u8]) {
        self.packet_of_length(time, bytes, bytes.len());
    }

    /// Appends a packet that had `sent_bytes` when sent; `bytes` were captured.
    pub(crate) fn packet_of_length(&mut self, time: Duration, bytes: &[u8], sent_bytes: usize) {
        let (length, sent) = (bytes.len() as u32, sent_bytes as u32);
        match self.container {
            Container::Pcap | Container::PcapBigNanoseconds => {
                let ticks = if self.is_big() {
                    time.subsec_nanos()
                } else {
                    time.subsec_micros()
                };
                for number in [time.as_secs() as u32, ticks, length, sent] {
                    self.u32(number);
                }
                self.bytes.extend(bytes);
            }
            Container::PcapNg | Container::PcapNgBig => {
                let nanos = time.as_nanos() as u64;
                let mut body = self.like();
                for number in [0, (nanos >> 32) as u32, nanos as u32, length, sent] {
                    body.u32(number);
                }
                body.bytes.extend(bytes);
                let body = body.bytes;
                self.block(6, &body);
            }
        }
    }

    /// The packets of a datagram, as the network carries them.
    pub(crate) fn packets_of(&mut self, sender: Sender, payload: &[u8]) -> Vec<Vec<u8>> {
        let mut udp = Vec::new();
        for number in [sender.port, sender.port, payload.len() as u16 + 8, 0] {
            udp.extend(number.to_be_bytes());
        }
        udp.extend(payload);
        self.number = self.number.wrapping_add(1);
        let piece_bytes = (self.mtu - 20) / 8 * 8;
        let count = udp.len().div_ceil(piece_bytes);
        let pieces = udp.chunks(piece_bytes).enumerate();
        pieces
            .map(|(index, piece)| {
                let mut packet = match self.link {
                    Link::Ethernet => [vec![0; 12], vec![8, 0]].concat(),
                    Link::Vlan => [vec![0; 12], vec![0x81, 0, 0, 7, 8, 0]].concat(),
                    Link::Cooked => [vec![0; 14], vec![8, 0]].concat(),
                    Link::Cooked2 => [vec![8, 0], vec![0; 18]].concat(),
                    Link::Raw => Vec::new(),
                };
                let more = if index + 1 < count { 0x2000 } else { 0 };
                let offset = (index * piece_bytes / 8) as u16;
                packet.extend([0x45, 0]);
                packet.extend((20 + piece.len() as u16).to_be_bytes());
                packet.extend(self.number.to_be_bytes());
                packet.extend((more | offset).to_be_bytes());
                packet.extend([64, 17, 0, 0, 192, 168, 1, sender.host, 192, 168, 1, 100]);
                packet.extend(piece);
                packet
            })
            .collect()
    }

    /// Appends a datagram, this many microseconds after the capture began.
    pub(crate) fn datagram(&mut self, after_us: u64, sender: Sender, payload: &[u8]) {
        for packet in self.packets_of(sender, payload) {
            self.packet(time(after_us), &packet);
        }
    }
}

/// This many microseconds after captures begin.
pub(crate) fn time(after_us: u64) -> Duration {
    Duration::from_secs(BEGIN_S) + Duration::from_micros(after_us)
}

/// Files in a folder that is removed with it.
pub(crate) struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    pub(crate) fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// The clouds of all frames in a file.
pub(crate) fn clouds(path: &Path) -> Vec<RawCloud> {
    let options = ReadOptions::default();
    let entries = io::list(path, &options).unwrap();
    let parts = entries.iter().map(|entry| &entry.part);
    parts
        .map(|part: &Part| io::read_part(path, part, &options).unwrap())
        .collect()
}

/// The numbers of this name.
pub(crate) fn scalar<'a>(cloud: &'a RawCloud, name: &str) -> &'a [f32] {
    let mut fields = cloud.attributes.scalars.iter();
    &fields
        .find(|field| field.name == name)
        .unwrap_or_else(|| panic!("no {name}"))
        .values
}

/// The expected point.
#[derive(Debug, Clone)]
pub(crate) struct Expected {
    pub(crate) position: [f64; 3],
    pub(crate) ring: f32,
    /// Seconds since the first point of the frame.
    pub(crate) time_s: f64,
    pub(crate) return_number: f32,
    /// By name.
    pub(crate) values: Vec<(&'static str, f32)>,
}

/// Compares a cloud with the expected points, in their order. Single precision has a millionth of the
/// largest coordinate.
pub(crate) fn check(cloud: &RawCloud, expected: &[Expected], within_m: f64) {
    assert_eq!(cloud.positions.len(), expected.len());
    assert_eq!(cloud.attributes.other_length(expected.len()), None);
    let first = expected.iter().map(|point| point.time_s).fold(f64::INFINITY, f64::min);
    let (times, rings) = (scalar(cloud, "time"), scalar(cloud, "ring"));
    let has_returns = expected.iter().any(|point| point.return_number > 1.0);
    for (index, point) in expected.iter().enumerate() {
        let found = cloud.positions.get(index).to_array();
        let is_near = |axis: usize| (found[axis] - point.position[axis]).abs() <= within_m;
        assert!((0..3).all(is_near), "point {index}: {found:?}, expected {point:?}");
        assert_eq!(rings[index], point.ring, "ring of point {index}, expected {point:?}");
        let time_s = f64::from(times[index]);
        assert!(
            (time_s - (point.time_s - first)).abs() < 2e-8,
            "time of point {index}: {time_s}, expected {point:?}"
        );
        for (name, value) in &point.values {
            assert_eq!(scalar(cloud, name)[index], *value, "{name} of point {index}");
        }
        if has_returns {
            assert_eq!(
                scalar(cloud, "return_number")[index],
                point.return_number,
                "point {index}"
            );
        }
    }
}
