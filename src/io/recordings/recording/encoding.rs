//! Encodings of messages with point clouds.

use super::serialisation::Serialisation;
use super::{foxglove, livox, pointcloud2};
use crate::cloud::RawCloud;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use std::time::Duration;

/// Encoding of a message with a point cloud: its type, and the serialisation of its fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// `sensor_msgs/PointCloud2` as ROS writes it.
    Ros(Serialisation),
    /// `CustomMsg` of Livox as ROS writes it.
    Livox(Serialisation),
    /// `foxglove.PointCloud` in Protocol Buffers.
    Protobuf,
    /// `foxglove.PointCloud` in JSON.
    Json,
}

impl Encoding {
    /// Acquisition time of the cloud, if `start`, the first bytes of the message, has it.
    pub(super) fn stamp(self, start: &[u8]) -> Option<Duration> {
        match self {
            Self::Ros(serialisation) | Self::Livox(serialisation) => serialisation.stamp(start),
            Self::Protobuf => foxglove::protobuf_stamp(start),
            Self::Json => foxglove::json_stamp(start),
        }
    }

    /// The cloud of a message.
    pub(super) fn decode(self, message: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
        match self {
            Self::Ros(serialisation) => pointcloud2::decode(message, serialisation, options),
            Self::Livox(serialisation) => livox::decode(message, serialisation, options),
            Self::Protobuf => foxglove::decode_protobuf(message, options),
            Self::Json => foxglove::decode_json(message, options),
        }
    }
}

/// The encoding of messages of type `kind`, if they are point clouds; names are from ROS 1, ROS 2 and Foxglove.
pub(super) fn encoding_of(kind: &str, encoding: &str) -> Option<Encoding> {
    match (kind, encoding) {
        ("sensor_msgs/PointCloud2" | "sensor_msgs/msg/PointCloud2", _) => {
            Serialisation::of(encoding).map(Encoding::Ros)
        }
        (kind, _) if livox::is_type(kind) => Serialisation::of(encoding).map(Encoding::Livox),
        ("foxglove.PointCloud", "protobuf") => Some(Encoding::Protobuf),
        ("foxglove.PointCloud", "json") => Some(Encoding::Json),
        _ => None,
    }
}
