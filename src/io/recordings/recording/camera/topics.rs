//! Topics of cameras, and the kinds of their messages.

use super::super::message::Message;
use std::time::Duration;

/// Kind of message that a camera topic carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CameraMessage {
    /// `sensor_msgs/Image`.
    Image,
    /// `sensor_msgs/CompressedImage`.
    CompressedImage,
    /// `sensor_msgs/CameraInfo`.
    CameraInfo,
    /// `tf2_msgs/TFMessage` that holds for all times.
    StaticTransforms,
    /// `tf2_msgs/TFMessage`, valid at its time stamps.
    Transforms,
    /// `geometry_msgs/Transform`: the extrinsics of a stream of a `RealSense`.
    Extrinsics,
    /// `std_msgs/Float32`: an option of a sensor of a `RealSense`.
    Number,
}

impl CameraMessage {
    /// Returns the kind of camera message of this type on this topic; `None` if no camera publishes it.
    pub(in crate::io::recordings::recording) fn of(kind: &str, topic: &str) -> Option<Self> {
        // ROS 2 names have one more path component.
        let (package, name) = kind.split_once('/')?;
        let name = name.strip_prefix("msg/").unwrap_or(name);
        Some(match (package, name) {
            ("sensor_msgs", "Image") => Self::Image,
            ("sensor_msgs", "CompressedImage") => Self::CompressedImage,
            ("sensor_msgs", "CameraInfo") => Self::CameraInfo,
            ("tf2_msgs", "TFMessage") | ("tf", "tfMessage") => match topic.trim_start_matches('/') {
                "tf_static" => Self::StaticTransforms,
                "tf" => Self::Transforms,
                _ => return None,
            },
            ("geometry_msgs", "Transform") if topic.contains("/tf/") => Self::Extrinsics,
            ("std_msgs", "Float32") if topic.contains("/option/") => Self::Number,
            _ => return None,
        })
    }

    /// Returns true if messages begin with a `std_msgs/Header`.
    pub(in crate::io::recordings::recording) fn has_header(self) -> bool {
        matches!(self, Self::Image | Self::CompressedImage | Self::CameraInfo)
    }
}

/// A topic of a camera, with its messages in the order of time.
#[derive(Debug)]
pub(crate) struct CameraTopic {
    pub(crate) name: String,
    pub(crate) kind: CameraMessage,
    pub(crate) messages: Vec<(Duration, Message)>,
}

impl CameraTopic {
    pub(in crate::io::recordings::recording) fn new(name: &str, kind: CameraMessage) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            messages: Vec::new(),
        }
    }
}

/// Camera topics of a recording.
#[derive(Debug, Default)]
pub(crate) struct CameraTopics {
    /// All topics, in the order of their names.
    pub(crate) topics: Vec<CameraTopic>,
    /// Truncations and damage of the recording, one sentence each.
    pub(crate) damage: Vec<String>,
}
