//! Formats whose frames lie in them as whole files or messages.

use super::format::{Format, Holding, Magic, Traits};
use crate::cloud::LengthUnit;

const RECORDING: Traits = Traits {
    holds: Holding::Messages,
    // REP 103, and the documents of Foxglove.
    unit: Some(LengthUnit::Metre),
    ..Traits::PLAIN
};

/// MCAP recording.
pub(super) const MCAP: Format = Format::new(&Traits {
    name: "MCAP",
    extensions: &["mcap"],
    magic: &[Magic::start(b"\x89MCAP0\r\n")],
    ..RECORDING
});

/// ROS 1 bag.
pub(super) const BAG: Format = Format::new(&Traits {
    name: "ROS bag",
    extensions: &["bag"],
    magic: &[Magic::start(b"#ROSBAG")],
    ..RECORDING
});

/// ROS 2 bag in `SQLite`.
pub(super) const DB3: Format = Format::new(&Traits {
    name: "ROS 2 bag",
    extensions: &["db3"],
    magic: &[Magic::start(b"SQLite format 3\0")],
    ..RECORDING
});

/// ZIP archive of files of the other formats.
pub(super) const ZIP: Format = Format::new(&Traits {
    name: "ZIP",
    extensions: &["zip"],
    magic: &[Magic::start(b"PK\x03\x04"), Magic::start(b"PK\x05\x06")],
    holds: Holding::Members,
    ..Traits::PLAIN
});

/// TAR archive, compressed or not.
pub(super) const TAR: Format = Format::new(&Traits {
    name: "TAR",
    extensions: &["tar", "tgz", "gz"],
    magic: &[
        Magic::start(b"\x1f\x8b"),
        // Where the header of a member says what it is.
        Magic {
            offset: 257,
            bytes: b"ustar",
        },
    ],
    holds: Holding::Members,
    ..Traits::PLAIN
});
