//! The packets of Ouster: columns of pixels, laid out as the profile in the metadata says.
//!
//! Ouster firmware user manual, "Lidar data packet format". All numbers are little endian. In the first profile each
//! column says of itself which frame it is of and whether it is whole; in the others the packet says the former.

/// How the pixels of a packet are laid out: `udp_profile_lidar`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Profile {
    /// `LEGACY`.
    Legacy,
    /// `RNG19_RFL8_SIG16_NIR16`.
    Single,
    /// `RNG19_RFL8_SIG16_NIR16_DUAL`.
    Dual,
    /// `RNG15_RFL8_NIR8`.
    Low,
}

/// How long the packets of a sensor are, and where in them is what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct PacketShape {
    pub(super) profile: Profile,
    /// Pixels of a column: one for each beam.
    pub(super) pixels: usize,
    /// Columns of a packet.
    pub(super) columns: usize,
}

/// A column of a packet, which is whole.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column<'a> {
    /// Nanoseconds since whatever moment the sensor counts from.
    pub(super) time_ns: u64,
    /// Which of the turn's columns it is.
    pub(super) measurement: u16,
    pub(super) pixels: &'a [u8],
}

/// What came back of a shot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Echo {
    /// 0 where nothing came back.
    pub(super) range_mm: u32,
    pub(super) reflectivity: u8,
    /// Photons; none in [`Profile::Low`].
    pub(super) signal: u16,
    /// Light of the sun.
    pub(super) near_infrared: u16,
}

/// All of them, by the names that metadata has.
const PROFILES: [(&str, Profile); 4] = [
    ("LEGACY", Profile::Legacy),
    ("RNG19_RFL8_SIG16_NIR16", Profile::Single),
    ("RNG19_RFL8_SIG16_NIR16_DUAL", Profile::Dual),
    ("RNG15_RFL8_NIR8", Profile::Low),
];

impl Profile {
    /// The profile of this name.
    pub(super) fn of(name: &str) -> Option<Self> {
        PROFILES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|&(_, profile)| profile)
    }

    /// The names of those that are read.
    pub(super) fn names() -> String {
        PROFILES.map(|(name, _)| name).join(", ")
    }

    /// The names of what is known of a point beside its place, in the order of the values.
    pub(super) fn value_names(self) -> &'static [&'static str] {
        match self {
            Self::Low => &["reflectivity", "near_ir"],
            Self::Legacy | Self::Single | Self::Dual => &["intensity", "reflectivity", "near_ir"],
        }
    }

    fn pixel_bytes(self) -> usize {
        match self {
            Self::Legacy | Self::Single => 12,
            Self::Dual => 16,
            Self::Low => 4,
        }
    }

    /// Before all columns, before each, behind each, and behind all.
    fn frame_bytes(self) -> [usize; 4] {
        match self {
            Self::Legacy => [0, 16, 4, 0],
            Self::Single | Self::Dual | Self::Low => [32, 12, 0, 32],
        }
    }

    /// The echoes of a pixel, which has as many bytes as one of the profile.
    pub(super) fn echoes(self, pixel: &[u8]) -> [Option<Echo>; 2] {
        let byte = |at: usize| pixel.get(at).copied().unwrap_or(0);
        let short = |at: usize| u16::from_le_bytes([byte(at), byte(at + 1)]);
        let range = |at: usize, bits: u32| {
            let word = u32::from_le_bytes([byte(at), byte(at + 1), byte(at + 2), byte(at + 3)]);
            word & ((1 << bits) - 1)
        };
        let first = match self {
            Self::Legacy => Echo {
                range_mm: range(0, 20),
                reflectivity: byte(4),
                signal: short(6),
                near_infrared: short(8),
            },
            Self::Single => Echo {
                range_mm: range(0, 19),
                reflectivity: byte(4),
                signal: short(6),
                near_infrared: short(8),
            },
            Self::Dual => Echo {
                range_mm: range(0, 19),
                reflectivity: byte(3),
                signal: short(8),
                near_infrared: short(12),
            },
            // Units of 8 mm, and of 16 of what the other profiles have.
            Self::Low => Echo {
                range_mm: u32::from(short(0) & 0x7fff) << 3,
                reflectivity: byte(2),
                signal: 0,
                near_infrared: u16::from(byte(3)) << 4,
            },
        };
        let second = Echo {
            range_mm: range(4, 19),
            reflectivity: byte(7),
            signal: short(10),
            near_infrared: first.near_infrared,
        };
        [Some(first), (self == Self::Dual).then_some(second)]
    }
}

impl PacketShape {
    /// Bytes of a packet.
    pub(in super::super) fn packet_bytes(self) -> usize {
        let [before, _, _, behind] = self.profile.frame_bytes();
        before + self.columns * self.column_bytes() + behind
    }

    fn column_bytes(self) -> usize {
        let [_, before, behind, _] = self.profile.frame_bytes();
        before + self.pixels * self.profile.pixel_bytes() + behind
    }

    /// Which frame a packet is of, from its first bytes.
    pub(in super::super) fn frame_id(self, packet: &[u8]) -> Option<u16> {
        let at = match self.profile {
            Profile::Legacy => 10,
            Profile::Single | Profile::Dual | Profile::Low => 2,
        };
        Some(u16::from_le_bytes(packet.get(at..at + 2)?.try_into().ok()?))
    }

    /// The serial number of the sensor, where packets have it.
    pub(in super::super) fn serial(self, packet: &[u8]) -> Option<u64> {
        if self.profile == Profile::Legacy {
            return None;
        }
        let mut raw = [0; 8];
        raw[..5].copy_from_slice(packet.get(7..12)?);
        Some(u64::from_le_bytes(raw))
    }

    /// The columns of frame `frame` in a packet. Precondition: it has [`PacketShape::packet_bytes`].
    pub(super) fn columns(self, packet: &[u8], frame: u16) -> impl Iterator<Item = Column<'_>> {
        let [before, head, foot, _] = self.profile.frame_bytes();
        let columns = packet
            .get(before..)
            .unwrap_or_default()
            .chunks_exact(self.column_bytes());
        let is_of_frame = self.frame_id(packet) == Some(frame);
        columns.take(self.columns).filter_map(move |column| {
            let short = |at: usize| Some(u16::from_le_bytes(column.get(at..at + 2)?.try_into().ok()?));
            let is_whole = match self.profile {
                Profile::Legacy => short(10)? == frame && column.ends_with(&[0xff; 4]),
                Profile::Single | Profile::Dual | Profile::Low => is_of_frame && short(10)? & 1 == 1,
            };
            is_whole.then_some(Column {
                time_ns: u64::from_le_bytes(column.get(..8)?.try_into().ok()?),
                measurement: short(8)?,
                pixels: column.get(head..column.len() - foot)?,
            })
        })
    }

    /// Bytes of a pixel.
    pub(super) fn pixel_bytes(self) -> usize {
        self.profile.pixel_bytes()
    }
}

/// Whether packets of `byte_count` bytes may be of a sensor of Ouster, whatever its metadata says.
pub(in super::super) fn may_be(byte_count: usize) -> bool {
    let shapes = PROFILES.iter().flat_map(|&(_, profile)| {
        [16, 32, 64, 128].into_iter().map(move |pixels| PacketShape {
            profile,
            pixels,
            columns: 16,
        })
    });
    shapes.into_iter().any(|shape| shape.packet_bytes() == byte_count)
}
