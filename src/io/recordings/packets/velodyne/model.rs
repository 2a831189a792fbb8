//! The models of Velodyne: directions and firing times of their lasers.
//!
//! Angles are from the manuals, in the order of the packets: VLP-16 and Puck Hi-Res 63-9243 table 9-1 with their
//! vertical corrections, HDL-32E 63-9113 appendix, VLP-32C 63-9325 table 9-3, VLS-128 63-9483 appendix. Times of shots
//! are from the same manuals, "Precision azimuth calculation". The intersection of beams is in the drawings of the
//! sensors.

use super::packet::{DataPacket, SHOTS};
use super::tables;

/// Direction of a laser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Laser {
    /// Above the horizon.
    pub(super) elevation_deg: f64,
    /// To be added to the azimuth of the head.
    pub(super) azimuth_deg: f64,
    /// To be added to the height of its hits.
    pub(super) height_m: f64,
}

/// A sensor model, identified by its packets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Model {
    /// VLP-16, Puck, Puck LITE.
    Vlp16,
    /// High-resolution variant, with lasers that are closer together.
    PuckHiRes,
    /// HDL-32E.
    Hdl32,
    /// Ultra Puck.
    Vlp32,
    /// Alpha Prime.
    Vls128,
    /// HDL-64E, whose angles are each sensor's own.
    Hdl64,
}

impl Model {
    /// The model that sent `packet`.
    ///
    /// # Errors
    /// The byte that tells of it, where it is of none that is known.
    pub(super) fn of(packet: DataPacket<'_>) -> Result<Self, u8> {
        // The HDL-64E has other data where others state their model, but names its banks.
        let has_bank = |bank: usize| (0..4).any(|index| packet.block(index).bank == Some(bank));
        match packet.product() {
            _ if has_bank(1) && !has_bank(2) && !is_dual_vls(packet) => Ok(Self::Hdl64),
            0x21 => Ok(Self::Hdl32),
            0x22 | 0x25 => Ok(Self::Vlp16),
            0x24 => Ok(Self::PuckHiRes),
            0x28 => Ok(Self::Vlp32),
            0xa1 => Ok(Self::Vls128),
            other => Err(other),
        }
    }

    /// Its lasers in the order of the packets; none where they are each sensor's own.
    pub(super) fn lasers(self) -> Vec<Laser> {
        let with_height = |&(elevation_deg, height_mm): &(f64, f64)| Laser {
            elevation_deg,
            azimuth_deg: 0.0,
            height_m: height_mm / 1000.0,
        };
        // The manuals give the heights of lasers for the VLP-16 only. The drawings of the others show where beams meet,
        // from which heights follow. Beams that meet before the axis cross it above and below the origin.
        let meeting = |focus_mm: f64, elevation_deg: f64, azimuth_deg: f64| Laser {
            elevation_deg,
            azimuth_deg,
            height_m: -focus_mm / 1000.0 * elevation_deg.to_radians().tan(),
        };
        match self {
            Self::Vlp16 => tables::VLP_16.iter().map(with_height).collect(),
            Self::PuckHiRes => tables::PUCK_HI_RES.iter().map(with_height).collect(),
            Self::Hdl32 => tables::HDL_32E.map(|elevation| meeting(28.83, elevation, 0.0)).to_vec(),
            Self::Vlp32 => tables::VLP_32C
                .map(|(elevation, azimuth)| meeting(42.4, elevation, azimuth))
                .to_vec(),
            Self::Vls128 => tables::VLS_128
                .map(|(elevation, azimuth)| meeting(58.63, elevation, azimuth))
                .to_vec(),
            Self::Hdl64 => Vec::new(),
        }
    }

    /// Metres of a unit of distance.
    pub(super) fn unit_m(self) -> f64 {
        match self {
            Self::Vlp32 | Self::Vls128 => 0.004,
            Self::Vlp16 | Self::PuckHiRes | Self::Hdl32 | Self::Hdl64 => 0.002,
        }
    }

    /// Blocks with the shots of all lasers, and of one echo.
    pub(super) fn banks(self) -> usize {
        match self {
            Self::Vlp16 | Self::PuckHiRes | Self::Hdl32 | Self::Vlp32 => 1,
            Self::Hdl64 => 2,
            Self::Vls128 => 4,
        }
    }

    /// From the first shot of such blocks to the first of the next ones.
    pub(super) fn cycle_us(self) -> f64 {
        match self {
            // Two cycles: 32 shots of 16 lasers.
            Self::Vlp16 | Self::PuckHiRes => 110.592,
            Self::Hdl32 => 46.08,
            Self::Vlp32 => 55.296,
            Self::Hdl64 => 48.0,
            Self::Vls128 => 53.3,
        }
    }

    /// When shot `index` of bank `bank` is fired, since the first one of its cycle.
    pub(super) fn shot_us(self, bank: usize, index: usize) -> f64 {
        match self {
            Self::Vlp16 | Self::PuckHiRes => 55.296 * (index / 16) as f64 + 2.304 * (index % 16) as f64,
            Self::Hdl32 => 1.152 * index as f64,
            Self::Vlp32 => 2.304 * (index / 2) as f64,
            // Both banks fire together, four lasers of each at a time.
            Self::Hdl64 => 6.0 * (index / 4) as f64 + [0.0, 1.26, 2.46, 3.66][index % 4],
            // Eight at a time, with a pause after half of them.
            Self::Vls128 => {
                let group = (bank * SHOTS + index) / 8;
                2.665 * (group + group / 8) as f64
            }
        }
    }

    /// Returns true if the head rotates between the shots of a cycle as far as azimuths are concerned. The calibration
    /// of the HDL-64E includes the rotation in the angles of its lasers.
    pub(super) fn turns_between_shots(self) -> bool {
        self != Self::Hdl64
    }

    /// Returns the index of the laser that fires shot `index` of bank `bank`.
    pub(super) fn laser(self, bank: usize, index: usize) -> usize {
        match self {
            Self::Vlp16 | Self::PuckHiRes => index % 16,
            Self::Hdl32 | Self::Vlp32 => index,
            Self::Hdl64 | Self::Vls128 => bank * SHOTS + index,
        }
    }

    /// Returns the number of echoes per shot that `packet` reports.
    pub(super) fn returns(self, packet: DataPacket<'_>) -> usize {
        /// Two echoes; with how sure they are.
        const DUAL: [u8; 2] = [0x39, 0x3a];
        let is_dual = match self {
            // Four blocks with the same azimuth are both banks twice.
            Self::Hdl64 => packet.block(0).azimuth == packet.block(2).azimuth,
            _ => DUAL.contains(&packet.return_mode()),
        };
        if is_dual { 2 } else { 1 }
    }
}

/// The VLS-128 tells both echoes of a bank before the next bank, so that its third bank is beyond the first four
/// blocks.
fn is_dual_vls(packet: DataPacket<'_>) -> bool {
    packet.product() == 0xa1 && packet.block(0).bank == packet.block(1).bank
}
