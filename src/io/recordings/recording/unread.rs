//! Topics of a recording without point clouds, for the message that refuses it.

/// Types whose messages hold points in another form, by the end of their names.
struct UnreadType {
    /// Without package, as in `LaserScan`.
    name: &'static str,
    /// Advice for getting a topic that is read.
    advice: &'static str,
}

const fn row(name: &'static str, advice: &'static str) -> UnreadType {
    UnreadType { name, advice }
}

const PACKETS: &str = "these are packets of the sensor: play the recording with its driver running, and record the \
    topic of type PointCloud2 that it publishes";

const UNREAD: [UnreadType; 17] = [
    row(
        "LaserScan",
        "a scan of one plane: play the recording through laser_geometry (the node laserscan_to_pointcloud of \
         pointcloud_to_laserscan), and record the topic of type PointCloud2 that it publishes",
    ),
    row(
        "MultiEchoLaserScan",
        "a scan of one plane: play the recording through laser_geometry, and record the topic of type PointCloud2 that \
         it publishes",
    ),
    row(
        "CompressedPointCloud2",
        "a compressed cloud: play the recording through `ros2 run point_cloud_transport republish --ros-args -p \
         in_transport:=draco -p out_transport:=raw` (or zlib, zstd, cloudini), and record the raw topic",
    ),
    row(
        "CompressedPointCloud",
        "a compressed cloud: decompress it with the library that wrote it, and record a topic of type PointCloud2",
    ),
    row(
        "PointCloud",
        "the older type of clouds: play the recording through point_cloud_converter, and record PointCloud2",
    ),
    row("VelodyneScan", PACKETS),
    row("PacketMsg", PACKETS),
    row("PandarScan", PACKETS),
    row("UdpFrame", PACKETS),
    row("RslidarScan", PACKETS),
    row("rslidarScan", PACKETS),
    row("RslidarPacket", PACKETS),
    row(
        "Octomap",
        "a map of cells: convert it with octomap_server, which publishes PointCloud2",
    ),
    row("OccupancyGrid", "a map of one plane, without points"),
    row("Marker", "shapes for RViz, not measured points"),
    row("MarkerArray", "shapes for RViz, not measured points"),
    row(
        "RadarScan",
        "radar returns: convert them with radar_pointcloud_converter, which publishes PointCloud2",
    ),
];

/// Topics that a sentence names.
const MAX_NAMED: usize = 16;

/// A topic and its messages.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct UnreadTopic {
    pub(super) name: String,
    /// Empty where the recording does not say it.
    pub(super) kind: String,
    pub(super) count: u64,
}

/// The content of a recording with these topics, none of which has a cloud, as the end of a sentence.
pub(super) fn describe(topics: &mut [UnreadTopic]) -> String {
    topics.sort();
    if topics.is_empty() {
        return "no topic is in it, it may not have been closed, or not been written to its end".to_owned();
    }
    let named: Vec<String> = topics.iter().take(MAX_NAMED).map(said).collect();
    let more = if topics.len() > MAX_NAMED { ", …" } else { "" };
    let mut text = format!("its topics are {}{more}", named.join(", "));
    let mut has_advice = false;
    for row in &UNREAD {
        if topics
            .iter()
            .any(|topic| topic.kind.rsplit('/').next() == Some(row.name))
        {
            for part in ["; ", row.name, ": ", row.advice] {
                text.push_str(part);
            }
            has_advice = true;
        }
    }
    if !has_advice {
        text += "; expected one of type sensor_msgs/PointCloud2, CustomMsg of Livox or foxglove.PointCloud, or images \
            of a depth camera";
    }
    text
}

/// `/imu (sensor_msgs/Imu, 200)`.
fn said(topic: &UnreadTopic) -> String {
    let UnreadTopic { name, kind, count } = topic;
    match kind.as_str() {
        "" => format!("{name} ({count})"),
        kind => format!("{name} ({kind}, {count})"),
    }
}
