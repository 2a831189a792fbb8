//! Sensors that packets tell of.

use super::ouster::{self, Metadata, PacketShape};
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
                     Puck Hi-Res (0x24), HDL-32E (0x21), VLP-32C (0x28), VLS-128 (0xa1), or an HDL-64E"
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

    /// The sensor of Ouster that `metadata` tells of.
    pub(super) fn ouster(metadata: &Metadata) -> Self {
        Self::Ouster {
            shape: metadata.shape,
            scanner: Arc::new(Scanner::Ouster(Box::new(ouster::Scanner::new(metadata.clone())))),
        }
    }
}
