//! Packets of makers that are not read: recognised so that a refusal names them.

/// A maker, or a kind of its packets.
#[derive(Debug)]
pub(super) struct Unread {
    /// A noun in the plural: `Hesai packets`.
    pub(super) name: &'static str,
    /// Advice for reading the points, after a colon; empty for packets without points.
    pub(super) advice: &'static str,
    /// Predicate that returns true if a datagram that was sent to this port is of this kind.
    is_one: fn(u16, &[u8]) -> bool,
}

const UNREAD: &[Unread] = &[
    Unread {
        name: "RoboSense packets",
        advice: "export PCD from RSView, or play the capture into rslidar_sdk and record the PointCloud2 topic as a \
            bag",
        is_one: |_, bytes| {
            const BEGINS: [&[u8]; 4] = [
                b"\x55\xaa\x05\x0a\x5a\xa5\x50\xa0",
                b"\x55\xaa\x05\x5a",
                b"\x55\xaa\x5a\xa5",
                b"\xa5\xff\x00\x5a\x11\x11\x55\x55",
            ];
            BEGINS.iter().any(|begin| bytes.starts_with(begin))
        },
    },
    Unread {
        name: "Hesai packets (Pandar, XT, QT, AT or JT)",
        advice: "export PCD or LAS from PandarView 2, or play the capture into HesaiLidar_ROS_2.0 and record the \
            PointCloud2 topic as a bag",
        is_one: |_, bytes| {
            // Pandar40P packets start with blocks, all others with a header.
            let is_pandar_40 = matches!(bytes.len(), 1256 | 1262 | 1266) && bytes.starts_with(b"\xff\xee");
            bytes.starts_with(b"\xee\xff") || is_pandar_40
        },
    },
    Unread {
        name: "Livox packets (Mid-360 or HAP)",
        advice: "record with Livox Viewer 2 and export LAS or PCD, or record a bag with livox_ros_driver2, whose \
            CustomMsg and PointCloud2 are read",
        is_one: |port, bytes| {
            let states_length = bytes.len() >= 36
                && bytes[0] == 0
                && usize::from(u16::from_le_bytes([bytes[1], bytes[2]])) == bytes.len();
            states_length || ((56_000..58_000).contains(&port) && bytes.len() >= 500)
        },
    },
    Unread {
        name: "Livox packets (Mid-40, Horizon, Tele-15 or Avia)",
        advice: "record with Livox Viewer and export LAS or CSV, or record a bag with livox_ros_driver, whose \
            CustomMsg \
            and PointCloud2 are read",
        is_one: |port, bytes| (55_000..=62_000).contains(&port) && bytes.first() == Some(&5) && bytes.len() >= 400,
    },
    Unread {
        name: "Seyond (Innovusion) packets",
        advice: "export PCD with the viewer or the SDK of Seyond",
        is_one: |_, bytes| bytes.starts_with(b"\x6a\x17"),
    },
    Unread {
        name: "Quanergy packets",
        advice: "play the capture into quanergy_client_ros and record the PointCloud2 topic as a bag",
        is_one: |_, bytes| bytes.starts_with(b"\x75\xbd\x7e\x97"),
    },
    Unread {
        name: "SICK packets (multiScan or picoScan)",
        advice: "play the capture into sick_scan_xd and record the PointCloud2 topic as a bag",
        is_one: |_, bytes| bytes.starts_with(b"\x02\x02\x02\x02"),
    },
    Unread {
        name: "Velodyne position packets, which have no points",
        advice: "",
        is_one: |port, bytes| port == 8308 && matches!(bytes.len(), 512 | 554),
    },
    Unread {
        name: "Ouster IMU packets, which have no points",
        advice: "",
        is_one: |_, bytes| bytes.len() == 48,
    },
];

/// The maker of a datagram that was sent to `port`.
pub(super) fn unread(port: u16, bytes: &[u8]) -> Option<&'static Unread> {
    UNREAD.iter().find(|maker| (maker.is_one)(port, bytes))
}
