//! Formats whose frames lie in them as whole files or messages.

use crate::cloud::{AxisConvention, LengthUnit};
use crate::io::format::{Format, Holding, Magic, Traits};

const RECORDING: Traits = Traits {
    holds: Holding::Parts,
    // REP 103, and the Foxglove documentation.
    unit: Some(LengthUnit::Metre),
    ..Traits::PLAIN
};

/// MCAP recording.
pub(in crate::io) const MCAP: Format = Format::new(&Traits {
    name: "MCAP",
    extensions: &["mcap"],
    magic: &[Magic::start(b"\x89MCAP0\r\n")],
    ..RECORDING
});

/// ROS 1 bag.
pub(in crate::io) const BAG: Format = Format::new(&Traits {
    name: "ROS bag",
    extensions: &["bag"],
    magic: &[Magic::start(b"#ROSBAG")],
    ..RECORDING
});

/// ROS 2 bag in `SQLite`.
pub(in crate::io) const DB3: Format = Format::new(&Traits {
    name: "ROS 2 bag",
    extensions: &["db3"],
    magic: &[Magic::start(b"SQLite format 3\0")],
    ..RECORDING
});

/// LiDAR packet captures (pcap), as `tcpdump` and Wireshark write them.
pub(in crate::io) const CAPTURE: Format = Format::new(&Traits {
    name: "packet capture",
    extensions: &["pcap", "pcapng"],
    magic: &[
        // Microseconds or nanoseconds, in either byte order; and the variant with longer records.
        Magic::start(b"\xd4\xc3\xb2\xa1"),
        Magic::start(b"\xa1\xb2\xc3\xd4"),
        Magic::start(b"\x4d\x3c\xb2\xa1"),
        Magic::start(b"\xa1\xb2\x3c\x4d"),
        Magic::start(b"\x34\xcd\xb2\xa1"),
        Magic::start(b"\x0a\x0d\x0d\x0a"),
    ],
    holds: Holding::Parts,
    // According to the manuals of the sensors.
    convention: Some(AxisConvention::UsuallyZUp),
    unit: Some(LengthUnit::Metre),
    ..Traits::PLAIN
});

/// ZIP archive of files of the other formats.
pub(in crate::io) const ZIP: Format = Format::new(&Traits {
    name: "ZIP",
    extensions: &["zip"],
    magic: &[Magic::start(b"PK\x03\x04"), Magic::start(b"PK\x05\x06")],
    holds: Holding::Parts,
    ..Traits::PLAIN
});

/// TAR archive, compressed or not.
pub(in crate::io) const TAR: Format = Format::new(&Traits {
    name: "TAR",
    extensions: &["tar", "tgz", "gz"],
    magic: &[
        Magic::start(b"\x1f\x8b"),
        // The field of a member's header that identifies the format.
        Magic {
            offset: 257,
            bytes: b"ustar",
        },
    ],
    holds: Holding::Parts,
    ..Traits::PLAIN
});
