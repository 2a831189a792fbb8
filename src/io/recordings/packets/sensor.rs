//! Sensors that packets tell of.

use super::ouster::{self, Metadata, PacketShape};
use super::seam::{Coverage, Seam, TURN};
use super::turn::Scanner;
use super::velodyne::{self, Calibration, DataPacket, Model, Turning};
use std::sync::Arc;
use std::time::Duration;

/// A head that stands turns no more: then so much time is one frame, and so many packets are.
pub(super) const LONGEST_TURN: Duration = Duration::from_secs(2);
pub(super) const MOST_PACKETS: u64 = 1 << 14;

/// Larger than what else is sent between sensors and those who listen.
pub(super) const LEAST_OUSTER_BYTES: usize = 1024;

/// What sends packets.
pub(super) enum Kind {
    Velodyne {
        turning: Turning,
        scanner: Arc<Scanner>,
    },
    Ouster {
        shape: PacketShape,
        /// Measurements of a revolution.
        columns: usize,
        /// The measurement at which frames begin.
        seam: u16,
        scanner: Arc<Scanner>,
    },
    /// Its packets cannot be read; why.
    Unread(String),
}

impl Kind {
    /// The sensor of Velodyne that sent `packet`; `calibration` is asked for where it needs one.
    pub(super) fn velodyne(packet: DataPacket<'_>, calibration: impl FnOnce() -> Result<Calibration, String>) -> Self {
        let model = match Model::of(packet) {
            Ok(model) => model,
            Err(byte) => {
                return Self::Unread(format!(
                    "it has packets of a sensor of Velodyne whose model is {byte:#04x}, expected one of VLP-16 (0x22), \
                     Puck Hi-Res (0x24), HDL-32E (0x21), VLP-32C (0x28), VLS-128 (0xa1), or an HDL-64E; other makers, \
                     such as LSLiDAR, send packets of the same form: convert the capture to PCD with their program"
                ));
            }
        };
        let calibration = match (model == Model::Hdl64).then(calibration).transpose() {
            Ok(calibration) => calibration,
            Err(problem) => return Self::Unread(problem),
        };
        Self::Velodyne {
            turning: Turning::new(model),
            scanner: Arc::new(Scanner::Velodyne(velodyne::Scanner::new(model, calibration))),
        }
    }

    /// Notes the azimuths that a packet measured.
    pub(super) fn cover(&self, packet: &[u8], coverage: &mut Coverage) {
        match self {
            Self::Velodyne { turning, .. } => {
                let data = DataPacket::of(packet).into_iter();
                let azimuths = data.flat_map(|data| turning.azimuths(data));
                azimuths.for_each(|azimuth| coverage.add(azimuth));
            }
            Self::Ouster { shape, columns, .. } if packet.len() == shape.packet_bytes() => {
                for column in shape.columns(packet) {
                    let azimuth = usize::from(column.measurement) * TURN as usize / columns;
                    coverage.add(azimuth as i32);
                }
            }
            Self::Ouster { .. } | Self::Unread(_) => {}
        }
    }

    /// The time of a packet by the sensor's own clock.
    pub(super) fn time(&self, packet: &[u8]) -> Option<Duration> {
        match self {
            Self::Velodyne { .. } => {
                let data = DataPacket::of(packet)?;
                Some(Duration::from_micros(data.time_us().into()))
            }
            Self::Ouster { shape, .. } if packet.len() == shape.packet_bytes() => {
                let column = shape.columns(packet).next()?;
                Some(Duration::from_nanos(column.time_ns))
            }
            Self::Ouster { .. } | Self::Unread(_) => None,
        }
    }

    /// Revolutions begin at `seam` from the next packet on.
    pub(super) fn set_seam(&mut self, of_all: Seam) {
        match self {
            Self::Velodyne { turning, .. } => turning.set_seam(of_all),
            Self::Ouster { columns, seam, .. } => *seam = (of_all.azimuth as usize * *columns / TURN as usize) as u16,
            Self::Unread(_) => {}
        }
    }

    /// The sensor of Ouster that `metadata` tells of.
    pub(super) fn ouster(metadata: &Metadata) -> Self {
        Self::Ouster {
            shape: metadata.shape,
            columns: metadata.columns,
            seam: 0,
            scanner: Arc::new(Scanner::Ouster(Box::new(ouster::Scanner::new(metadata.clone())))),
        }
    }
}
