//! The packets of Ouster: columns of pixels, laid out by the profile in the metadata.
//!
//! Ouster firmware user manual, "Lidar data packet format". All numbers are little endian. In the first profile each
//! column has its frame number and a flag if it is complete; in the others the packet has the former. A profile is a
//! row of [`PROFILES`]: the positions of each echo's numbers in a pixel.

use super::super::part::FrameId;
use super::super::points::MAX_VALUES;

/// Numbers of a pixel that lie at the same place in all pixels of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Bits {
    /// From the first bit of the pixel.
    at: usize,
    count: usize,
    /// Shift: the number of lower bits that are dropped from the transmitted number.
    shift: usize,
}

const fn bits(at: usize, count: usize) -> Bits {
    Bits { at, count, shift: 0 }
}

/// Ranges in units of 8 mm.
const fn coarse_range(at: usize) -> Bits {
    Bits {
        at,
        count: 15,
        shift: 3,
    }
}

/// Light of the sun without its lowest four bits.
const fn coarse_light(at: usize) -> Bits {
    Bits { at, count: 8, shift: 4 }
}

impl Bits {
    /// The number in `pixel`; missing bytes are zero.
    fn of(self, pixel: &[u8]) -> u32 {
        let bytes = pixel.iter().skip(self.at / 8).take(8).enumerate();
        let word = bytes.fold(0, |word, (index, &byte)| word | u64::from(byte) << (8 * index));
        let number = (word >> (self.at % 8)) & ((1 << self.count) - 1);
        (number << self.shift) as u32
    }
}

/// Bit layout of an echo in a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct EchoBits {
    /// Millimetres.
    range: Bits,
    /// In the order of [`Profile::values`].
    values: &'static [Bits],
}

/// Pixel layout of a packet: `udp_profile_lidar`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Profile {
    /// As metadata has it.
    name: &'static str,
    pixel_bytes: usize,
    /// Names of the numbers of an echo next to its range, the one to colour by first.
    values: &'static [&'static str],
    first: EchoBits,
    second: Option<EchoBits>,
}

/// The profile of firmware before 2.3, whose columns have their own header and footer.
pub(super) static LEGACY: &Profile = &PROFILES[0];

const FULL: &[&str] = &["intensity", "reflectivity", "near_ir"];
const LOW: &[&str] = &["reflectivity", "near_ir"];

const SINGLE_ECHO: EchoBits = EchoBits {
    range: bits(0, 19),
    values: &[bits(48, 16), bits(32, 8), bits(64, 16)],
};

const FIRST_OF_DUAL: EchoBits = EchoBits {
    range: bits(0, 19),
    values: &[bits(64, 16), bits(24, 8), bits(96, 16)],
};

const SECOND_OF_DUAL: EchoBits = EchoBits {
    range: bits(32, 19),
    values: &[bits(80, 16), bits(56, 8), bits(96, 16)],
};

const LOW_ECHO: EchoBits = EchoBits {
    range: coarse_range(0),
    values: &[bits(16, 8), coarse_light(24)],
};

const SECOND_OF_LOW: EchoBits = EchoBits {
    range: coarse_range(32),
    values: &[bits(48, 8), coarse_light(24)],
};

/// All that are read.
static PROFILES: [Profile; 11] = [
    Profile {
        name: "LEGACY",
        pixel_bytes: 12,
        values: FULL,
        first: EchoBits {
            range: bits(0, 20),
            values: SINGLE_ECHO.values,
        },
        second: None,
    },
    Profile {
        name: "RNG19_RFL8_SIG16_NIR16",
        pixel_bytes: 12,
        values: FULL,
        first: SINGLE_ECHO,
        second: None,
    },
    Profile {
        name: "RNG19_RFL8_SIG16_NIR16_DUAL",
        pixel_bytes: 16,
        values: FULL,
        first: FIRST_OF_DUAL,
        second: Some(SECOND_OF_DUAL),
    },
    Profile {
        name: "RNG15_RFL8_NIR8",
        pixel_bytes: 4,
        values: LOW,
        first: LOW_ECHO,
        second: None,
    },
    Profile {
        name: "RNG15_RFL8_NIR8_DUAL",
        pixel_bytes: 8,
        values: LOW,
        first: LOW_ECHO,
        second: Some(SECOND_OF_LOW),
    },
    Profile {
        name: FUSA,
        pixel_bytes: 8,
        values: LOW,
        first: LOW_ECHO,
        second: Some(SECOND_OF_LOW),
    },
    Profile {
        name: "FIVE_WORD_PIXEL",
        pixel_bytes: 20,
        values: FULL,
        first: FIRST_OF_DUAL,
        second: Some(SECOND_OF_DUAL),
    },
    Profile {
        name: "RNG15_RFL8_WIN8",
        pixel_bytes: 4,
        values: &["reflectivity", "window"],
        first: EchoBits {
            range: coarse_range(0),
            values: &[bits(16, 8), bits(24, 8)],
        },
        second: None,
    },
    Profile {
        name: "RNG15_RFL8_NIR8_ZONE16",
        pixel_bytes: 8,
        values: &["reflectivity", "near_ir", "zone_mask"],
        first: EchoBits {
            range: coarse_range(0),
            values: &[bits(16, 8), coarse_light(24), bits(32, 16)],
        },
        second: None,
    },
    Profile {
        name: "RNG19_RFL8_SIG16_NIR16_ZONE16",
        pixel_bytes: 12,
        values: &["intensity", "reflectivity", "near_ir", "zone_mask"],
        first: EchoBits {
            range: bits(0, 19),
            values: &[bits(48, 16), bits(32, 8), bits(64, 16), bits(80, 16)],
        },
        second: None,
    },
    Profile {
        name: "RNG19_RFL8_SIG16_ZONE16_DUAL",
        pixel_bytes: 16,
        values: &["intensity", "reflectivity", "zone_mask"],
        first: EchoBits {
            range: bits(0, 19),
            values: &[bits(64, 16), bits(24, 8), bits(96, 16)],
        },
        second: Some(EchoBits {
            range: bits(32, 19),
            values: &[bits(80, 16), bits(56, 8), bits(96, 16)],
        }),
    },
];

/// The profile of sensors for functional safety, whose packets have another header unless metadata says otherwise.
pub(super) const FUSA: &str = "FUSA_RNG15_RFL8_NIR8_DUAL";

/// Packet layout of a sensor: the length of its packets and the offsets in them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PacketShape {
    pub(super) profile: &'static Profile,
    /// True if packets have the header of functional safety (`header_type` is `FUSA`).
    pub(super) is_fusa: bool,
    /// Pixels of a column: one for each beam.
    pub(super) pixels: usize,
    /// Columns of a packet.
    pub(super) columns: usize,
}

/// A column of a packet, which is whole.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column<'a> {
    /// Timestamp in nanoseconds since the sensor's epoch.
    pub(super) time_ns: u64,
    /// Index of the column within the revolution.
    pub(super) measurement: u16,
    /// The frame that the sensor counts it to.
    frame: u32,
    pub(super) pixels: &'a [u8],
}

/// Echo: one return of a laser shot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Echo {
    /// 0 where nothing came back.
    pub(super) range_mm: u32,
    /// In the order of [`Profile::value_names`].
    pub(super) values: [f32; MAX_VALUES],
}

impl Profile {
    /// The profile of this name.
    pub(super) fn of(name: &str) -> Option<&'static Self> {
        PROFILES.iter().find(|profile| profile.name == name)
    }

    /// The names of those that are read.
    pub(super) fn names() -> String {
        let names: Vec<&str> = PROFILES.iter().map(|profile| profile.name).collect();
        names.join(", ")
    }

    fn is_legacy(&self) -> bool {
        self.name == LEGACY.name
    }

    /// Names of the per-point attributes other than the position, in the order of the values.
    pub(super) fn value_names(&self) -> &'static [&'static str] {
        self.values
    }

    /// Before all columns, before each, behind each, and behind all.
    fn frame_bytes(&self) -> [usize; 4] {
        if self.is_legacy() {
            [0, 16, 4, 0]
        } else {
            [32, 12, 0, 32]
        }
    }

    /// The echoes of a pixel, which has the size of the profile's pixels.
    pub(super) fn echoes(&self, pixel: &[u8]) -> [Option<Echo>; 2] {
        let echo = |at: &EchoBits| {
            let mut values = [0.0; MAX_VALUES];
            for (value, bits) in values.iter_mut().zip(at.values) {
                *value = bits.of(pixel) as f32;
            }
            Echo {
                range_mm: at.range.of(pixel),
                values,
            }
        };
        [Some(echo(&self.first)), self.second.as_ref().map(echo)]
    }
}

impl PacketShape {
    /// Bytes of a packet.
    pub(super) fn packet_bytes(self) -> usize {
        let [before, _, _, behind] = self.profile.frame_bytes();
        before + self.columns * self.column_bytes() + behind
    }

    fn column_bytes(self) -> usize {
        let [_, before, behind, _] = self.profile.frame_bytes();
        before + self.pixels * self.profile.pixel_bytes + behind
    }

    /// The number of the frame that a packet is of, from its first bytes.
    fn frame_number(self, packet: &[u8]) -> Option<u32> {
        if self.is_fusa {
            return Some(u32::from_le_bytes(packet.get(4..8)?.try_into().ok()?));
        }
        let at = if self.profile.is_legacy() { 10 } else { 2 };
        let raw = packet.get(at..at + 2)?.try_into().ok()?;
        Some(u16::from_le_bytes(raw).into())
    }

    /// The frame that a packet is of, where frames begin at measurement `seam`.
    pub(super) fn frame_of(self, packet: &[u8], seam: u16) -> Option<FrameId> {
        if seam == 0 {
            let number = self.frame_number(packet)?;
            return Some(FrameId { number, seam });
        }
        let column = self.columns(packet).next()?;
        let number = self.number_of(&column, seam);
        Some(FrameId { number, seam })
    }

    /// The frame that a column is of, where frames begin at measurement `seam`.
    fn number_of(self, column: &Column<'_>, seam: u16) -> u32 {
        let is_before = column.measurement < seam;
        let number = column.frame.wrapping_sub(u32::from(is_before));
        if self.is_fusa { number } else { number & 0xffff }
    }

    /// The serial number of the sensor, where packets have it.
    pub(super) fn serial(self, packet: &[u8]) -> Option<u64> {
        if self.profile.is_legacy() {
            return None;
        }
        let at = if self.is_fusa { 11 } else { 7 };
        let mut raw = [0; 8];
        raw[..5].copy_from_slice(packet.get(at..at + 5)?);
        Some(u64::from_le_bytes(raw))
    }

    /// The whole columns of a packet. Precondition: it has [`PacketShape::packet_bytes`].
    pub(super) fn columns(self, packet: &[u8]) -> impl Iterator<Item = Column<'_>> {
        let [before, head, foot, _] = self.profile.frame_bytes();
        let columns = packet
            .get(before..)
            .unwrap_or_default()
            .chunks_exact(self.column_bytes());
        let frame = self.frame_number(packet);
        columns.take(self.columns).filter_map(move |column| {
            let short = |at: usize| Some(u16::from_le_bytes(column.get(at..at + 2)?.try_into().ok()?));
            let (is_whole, frame) = if self.profile.is_legacy() {
                (column.ends_with(&[0xff; 4]), u32::from(short(10)?))
            } else {
                (short(10)? & 1 == 1, frame?)
            };
            is_whole.then_some(Column {
                time_ns: u64::from_le_bytes(column.get(..8)?.try_into().ok()?),
                measurement: short(8)?,
                frame,
                pixels: column.get(head..column.len() - foot)?,
            })
        })
    }

    /// Returns true if a column belongs to `frame`.
    pub(super) fn is_of(self, column: &Column<'_>, frame: FrameId) -> bool {
        self.number_of(column, frame.seam) == frame.number
    }

    /// Bytes of a pixel.
    pub(super) fn pixel_bytes(self) -> usize {
        self.profile.pixel_bytes
    }
}

/// Returns true if packets of `byte_count` bytes may come from an Ouster sensor, regardless of its metadata.
pub(super) fn may_be(byte_count: usize) -> bool {
    let shapes = PROFILES.iter().flat_map(|profile| {
        [16, 32, 64, 128].into_iter().map(move |pixels| PacketShape {
            profile,
            is_fusa: false,
            pixels,
            columns: 16,
        })
    });
    shapes.into_iter().any(|shape| shape.packet_bytes() == byte_count)
}
