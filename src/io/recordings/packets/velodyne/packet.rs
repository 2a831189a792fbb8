//! Data packets of Velodyne: 12 blocks of 32 measurements, a time and two bytes of the factory.
//!
//! VLP-16 user manual 63-9243 §9.3, HDL-64E S3 manual 63-HDL64ES3 appendix E, VLS-128 manual 63-9483 §9.3.

use super::super::seam::TURN;

/// All data packets are as long.
pub(super) const PACKET_BYTES: usize = 1206;

/// Blocks of a packet.
pub(super) const BLOCKS: usize = 12;

/// Measurements of a block.
pub(super) const SHOTS: usize = 32;

const BLOCK_BYTES: usize = 100;

/// Flag at the beginning of each block: the bank of 32 lasers that measured.
const BANKS: [[u8; 2]; 4] = [[0xff, 0xee], [0xff, 0xdd], [0xff, 0xcc], [0xff, 0xbb]];

/// A data packet.
#[derive(Debug, Clone, Copy)]
pub(super) struct DataPacket<'a>(&'a [u8; PACKET_BYTES]);

/// A block of a packet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<'a> {
    /// Bank of 32 lasers; `None` if there are no measurements.
    pub(super) bank: Option<usize>,
    /// Hundredths of a degree, clockwise from above, below [`TURN`].
    pub(super) azimuth: i32,
    shots: &'a [u8],
}

/// A measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shot {
    /// In units of the model; 0 where nothing came back.
    pub(super) distance: u16,
    /// Calibrated: up to 100 for diffuse reflectors, above for retroreflectors.
    pub(super) reflectivity: u8,
}

impl<'a> DataPacket<'a> {
    /// A data packet, if `bytes` are one.
    pub(super) fn of(bytes: &'a [u8]) -> Option<Self> {
        let bytes: &[u8; PACKET_BYTES] = bytes.try_into().ok()?;
        bytes.starts_with(&BANKS[0]).then_some(Self(bytes))
    }

    /// Block `index`. Precondition: it is below [`BLOCKS`].
    pub(super) fn block(self, index: usize) -> Block<'a> {
        let bytes = &self.0[index * BLOCK_BYTES..(index + 1) * BLOCK_BYTES];
        Block {
            bank: BANKS.iter().position(|bank| bytes.starts_with(bank)),
            azimuth: i32::from(u16::from_le_bytes([bytes[2], bytes[3]])) % TURN,
            shots: &bytes[4..],
        }
    }

    /// Microseconds since the hour, of the first shot.
    pub(super) fn time_us(self) -> u32 {
        u32::from_le_bytes([self.0[1200], self.0[1201], self.0[1202], self.0[1203]])
    }

    /// Returns the return mode: the echoes that are reported; not for the HDL-64E.
    pub(super) fn return_mode(self) -> u8 {
        self.0[1204]
    }

    /// The model; not of the HDL-64E.
    pub(super) fn product(self) -> u8 {
        self.0[1205]
    }
}

impl Block<'_> {
    /// Measurement `index`. Precondition: it is below [`SHOTS`].
    pub(super) fn shot(self, index: usize) -> Shot {
        let bytes = &self.shots[index * 3..index * 3 + 3];
        Shot {
            distance: u16::from_le_bytes([bytes[0], bytes[1]]),
            reflectivity: bytes[2],
        }
    }
}
