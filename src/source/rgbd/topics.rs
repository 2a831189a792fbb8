//! ROS depth image topics: detection of depths, colours and cameras, and of the transform between cameras.
//!
//! Of several topics with depths, the one that is named by `--topic` is read, otherwise the one with the most messages.
//! Colours come from the topic that shares the most of its name. Cameras are identified by the `CameraInfo` that
//! accompanies the images; images in one frame of reference and of one size belong to one camera, pixel by pixel,
//! others are linked by `tf_static`. Bags of `librealsense` have extensions of their own: no frames of reference, but
//! the pose of each stream relative to one of them (`…/tf/0`), and the unit of depths as an option.
//!
//! Poses locate the depth camera in the root of the links that `tf` publishes ([`MovingFrames`]).

use super::calibration::{Calibration, Intrinsics};
use super::camera_info::{intrinsics, transform_between};
use super::depth_code::DepthCode;
use super::depth_scale::Units;
use super::error::RgbdError;
use super::layouts::{FoundRecording, FrameImages};
use super::moving_frames::MovingFrames;
use super::pairs::nearest;
use super::recorder::Recorder;
use super::stored_image::{ImageMessage, StoredImage};
use crate::io;
use crate::io::ReadOptions;
use crate::io::recordings::recording;
use crate::io::recordings::recording::camera::{
    CameraInfo, CameraMessage, CameraTopic, CameraTopics, ImageHead, Link, Window, camera_info, extrinsics, head,
    links, number,
};
use crate::messages::grouped;
use crate::source::OpenOptions;
use glam::DAffine3;
use std::cmp::Reverse;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// Millimetres (REP 118); floats are metres.
const UNITS_PER_METRE: f64 = 1000.0;

/// Returns true if the image topic is from a bag written by `librealsense`.
fn is_realsense(topic: &str) -> bool {
    topic.starts_with("/device_")
}

/// Recordings that may hold point clouds as well: any file may be one.
pub(super) const RECORDER: Recorder = Recorder {
    extensions: &[],
    can_read: |_| true,
    find,
};

/// The recording in the file at `path` and the naming convention it follows; `None` if it has no depth images, or if it
/// has point clouds and no topic was named. Unreadable files are left to the readers of clouds.
fn find(path: &Path, options: &OpenOptions) -> Result<Option<(&'static str, FoundRecording)>, RgbdError> {
    let named = options.topic.as_deref();
    let Ok(topics) = io::cameras(path, named.is_some(), &options.read) else {
        return Ok(None);
    };
    let messages = RosRecording {
        path,
        all: &topics,
        read: &options.read,
    };
    let streams = messages.streams();
    let is_meant = |stream: &&Stream<'_>| stream.head.is_depth() && named.is_none_or(|name| stream.topic.name == name);
    let depth = streams.iter().filter(is_meant).max_by_key(|stream| {
        let name = stream.topic.name.to_ascii_lowercase();
        // 16-bit infrared images look like depths. Of equals the first name.
        (
            name.contains("depth"),
            stream.topic.messages.len(),
            stream.is_raw(),
            Reverse(name),
        )
    });
    let Some(depth) = depth else { return Ok(None) };
    let layout = if is_realsense(&depth.topic.name) {
        "RealSense"
    } else {
        "ROS"
    };
    let mut found = messages.found(depth, color_of(depth, &streams), options)?;
    let unread = streams
        .iter()
        .filter(|other| other.head.is_depth() && other.topic.name != depth.topic.name);
    let unread: Vec<&str> = unread.map(|stream| stream.topic.name.as_str()).collect();
    if named.is_none() && !unread.is_empty() {
        found.notes.push(format!(
            "depth images of topic {} are read; others are read with --topic: {}",
            depth.topic.name,
            unread.join(", ")
        ));
    }
    Ok(Some((layout, found)))
}

/// A topic of images, and the data before the first of them.
struct Stream<'a> {
    topic: &'a CameraTopic,
    head: ImageHead,
}

impl Stream<'_> {
    fn is_raw(&self) -> bool {
        self.topic.kind == CameraMessage::Image
    }

    /// Returns true if two cameras have the same frame of reference.
    fn is_framed_as(&self, other: &Self) -> bool {
        let frame = &self.head.frame_id;
        !is_realsense(&self.topic.name) && !frame.is_empty() && *frame == other.head.frame_id
    }
}

/// Returns the number of leading name parts that two names have in common.
fn shared_parts(left: &str, right: &str) -> usize {
    let parts = left.split('/').zip(right.split('/'));
    parts.take_while(|(left, right)| left == right).count()
}

/// The stream that the colours of `depth` are from.
fn color_of<'a>(depth: &Stream<'_>, streams: &'a [Stream<'a>]) -> Option<&'a Stream<'a>> {
    let candidates = streams.iter().filter(|stream| !stream.head.is_depth());
    candidates.max_by_key(|stream| {
        let name = &stream.topic.name;
        let is_colored = stream.head.is_colored();
        let is_framed = stream.is_framed_as(depth);
        let shared = shared_parts(name, &depth.topic.name);
        (
            is_colored,
            is_framed,
            shared,
            stream.is_raw(),
            stream.topic.messages.len(),
            Reverse(name),
        )
    })
}

struct RosRecording<'a> {
    path: &'a Path,
    all: &'a CameraTopics,
    read: &'a ReadOptions,
}

impl RosRecording<'_> {
    fn of_kind(&self, kind: CameraMessage) -> impl Iterator<Item = &CameraTopic> {
        self.all.topics.iter().filter(move |topic| topic.kind == kind)
    }

    /// Returns the result of `parse` for the first valid message of `topic`.
    fn first<T>(&self, topic: &CameraTopic, parse: impl Fn(&[u8], &io::Message) -> Option<T>) -> Option<T> {
        /// Some drivers begin with empty messages; a topic of thousands of broken ones is not read to its end.
        const MAX_TRIED: usize = 16;
        let mut tried = topic.messages.iter().take(MAX_TRIED);
        tried.find_map(|(_, message)| recording::read_parsed(self.path, message, self.read, &parse))
    }

    /// The topics of images.
    fn streams(&self) -> Vec<Stream<'_>> {
        let images = self
            .all
            .topics
            .iter()
            .filter(|topic| matches!(topic.kind, CameraMessage::Image | CameraMessage::CompressedImage));
        images
            .filter_map(|topic| {
                let head = self.first(topic, |bytes, message| head(bytes, message, topic.kind))?;
                Some(Stream { topic, head })
            })
            .collect()
    }

    /// The camera of the images of `stream`: of the topic that shares the most of its name, and its frame of reference
    /// or all but the end of its name.
    fn info(&self, stream: &Stream<'_>) -> Option<CameraInfo> {
        let name = &stream.topic.name;
        let parts = name.split('/').count();
        let infos = self.of_kind(CameraMessage::CameraInfo).filter_map(|topic| {
            let info = self.first(topic, camera_info)?;
            let shared = shared_parts(&topic.name, name);
            let is_framed = !is_realsense(name) && info.frame_id == stream.head.frame_id;
            // The first part is the empty one before the first slash.
            let is_sibling = shared > 1 && shared + 2 >= parts;
            (is_framed || is_sibling).then_some((shared, is_framed, info))
        });
        infos
            .max_by_key(|&(shared, is_framed, _)| (shared, is_framed))
            .map(|(.., info)| info)
    }

    /// Returns the transform from the camera of `depth` to the camera of `color`; `None` if nothing states it.
    fn color_from_depth(&self, depth: &Stream<'_>, color: &Stream<'_>) -> Option<DAffine3> {
        if is_realsense(&depth.topic.name) {
            let place = |stream: &Stream<'_>| {
                let prefix = stream.topic.name.strip_suffix("/image/data")?;
                let is_its = |topic: &&CameraTopic| {
                    topic
                        .name
                        .strip_prefix(prefix)
                        .is_some_and(|rest| rest.starts_with("/tf/"))
                };
                self.first(self.of_kind(CameraMessage::Extrinsics).find(is_its)?, extrinsics)
            };
            // From the stream that all others are relative to, to each of them.
            return Some(place(color)? * place(depth)?.inverse());
        }
        let links = self.links(CameraMessage::StaticTransforms);
        transform_between(&links, &depth.head.frame_id, &color.head.frame_id)
    }

    /// The links in messages of this kind.
    fn links(&self, kind: CameraMessage) -> Vec<Link> {
        let messages = self.of_kind(kind).flat_map(|topic| &topic.messages);
        let messages = messages.map(|(_, message)| message);
        // Thousands of small messages are stored in a few chunks: read together, each chunk is unpacked once.
        let links = recording::read_all_parsed(self.path, messages, self.read, links);
        links.into_iter().flatten().collect()
    }

    /// Returns the moving frames. Bags of `librealsense` have no frames of reference.
    fn moving_frames(&self, depth: &Stream<'_>) -> MovingFrames {
        let moving = self.links(CameraMessage::Transforms);
        if moving.is_empty() || is_realsense(&depth.topic.name) {
            return MovingFrames::default();
        }
        MovingFrames::of(self.links(CameraMessage::StaticTransforms), moving)
    }

    /// Units of depth images per metre, where a `RealSense` says it.
    fn units_per_metre(&self) -> Option<f64> {
        let is_unit = |topic: &&CameraTopic| {
            topic
                .name
                .to_ascii_lowercase()
                .replace(' ', "_")
                .contains("depth_units")
        };
        let unit = self.first(self.of_kind(CameraMessage::Number).find(is_unit)?, number)?;
        (unit.is_finite() && unit > 0.0).then_some(1.0 / unit)
    }

    fn image(&self, stream: &Stream<'_>, index: usize) -> StoredImage {
        StoredImage::Message(ImageMessage {
            path: self.path.into(),
            topic: stream.topic.name.as_str().into(),
            kind: stream.topic.kind,
            message: stream.topic.messages[index].1.clone(),
        })
    }

    /// The frames of `depth` with the colours of `color`.
    fn found(
        &self,
        depth: &Stream<'_>,
        color: Option<&Stream<'_>>,
        options: &OpenOptions,
    ) -> Result<FoundRecording, RgbdError> {
        let mut notes = Vec::new();
        let calibration = match self.info(depth) {
            Some(info) => self.calibration(depth, &info, color, &mut notes)?,
            // If the user specifies the camera, none is needed.
            None if options.rgbd.intrinsics.is_some() => {
                Calibration::of_depth(Intrinsics::pinhole([1.0, 1.0, 0.0, 0.0], None), "--intrinsics")
            }
            None => {
                return Err(RgbdError::Options {
                    reason: format!(
                        "no CameraInfo says which camera took the images of topic {}: name it by --intrinsics \
                         fx,fy,cx,cy or a file",
                        depth.topic.name
                    ),
                });
            }
        };
        let calibration = Arc::new(calibration);
        let depths = &depth.topic.messages;
        let moving = self.moving_frames(depth);
        let mut used = HashSet::new();
        let frames: Vec<FrameImages> = depths
            .iter()
            .enumerate()
            .map(|(index, &(time, _))| {
                let partner = color.and_then(|color| {
                    let colors = &color.topic.messages;
                    Some((color, nearest(colors.len(), |at| colors[at].0, time)?))
                });
                used.extend(partner.map(|(_, at)| at));
                FrameImages {
                    depth: self.image(depth, index),
                    color: partner.map(|(color, at)| self.image(color, at)),
                    time: Some(time),
                    world_from_camera: moving.world_from(&depth.head.frame_id, time),
                    calibration: Arc::clone(&calibration),
                }
            })
            .collect();
        let alone = frames.iter().filter(|frame| frame.color.is_none()).count();
        if let Some(color) = color.filter(|_| alone > 0) {
            notes.push(format!(
                "{} of {} depth images have no colour image of {} within 20 ms: their points have no colours",
                grouped(alone),
                grouped(frames.len()),
                color.topic.name
            ));
        }
        Ok(FoundRecording {
            frames,
            code: DepthCode::per_metre(UNITS_PER_METRE),
            units: Units::Certain,
            assumptions: Vec::new(),
            notes,
            damage: self
                .all
                .damage
                .iter()
                .map(|damage| format!("{}: {damage}", self.path.display()))
                .collect(),
        })
    }

    /// The size of the images of a camera, where it matters which part of them is sent.
    fn sent_px(&self, stream: &Stream<'_>, info: &CameraInfo) -> Option<[u32; 2]> {
        let is_part = info.window != Window::default();
        is_part.then(|| self.image(stream, 0).size_px(self.read)).flatten()
    }

    fn calibration(
        &self,
        depth: &Stream<'_>,
        info: &CameraInfo,
        color: Option<&Stream<'_>>,
        notes: &mut Vec<String>,
    ) -> Result<Calibration, RgbdError> {
        let mut calibration = Calibration::of_depth(
            intrinsics(&depth.topic.name, info, self.sent_px(depth, info), notes)?,
            format!("the CameraInfo of topic {}", depth.topic.name),
        );
        calibration.units_per_metre = self.units_per_metre();
        let Some(color) = color else { return Ok(calibration) };
        let size = |stream: &Stream<'_>| self.image(stream, 0).size_px(self.read);
        let is_one = color.is_framed_as(depth);
        if is_one && size(color) == size(depth) {
            return Ok(calibration);
        }
        let Some(color_info) = self.info(color) else {
            notes.push(format!(
                "no CameraInfo says which camera took the images of topic {}: they are taken for the depth camera's",
                color.topic.name
            ));
            return Ok(calibration);
        };
        let color_from_depth = if is_one {
            Some(DAffine3::IDENTITY)
        } else {
            self.color_from_depth(depth, color)
        };
        if color_from_depth.is_none() {
            notes.push(format!(
                "nothing says where the camera of topic {} is from that of {} (tf_static has no way between their \
                 frames): they are taken to be in one place",
                color.topic.name, depth.topic.name
            ));
        }
        let lens = intrinsics(&color.topic.name, &color_info, self.sent_px(color, &color_info), notes)?;
        calibration.color = Some((lens, color_from_depth.unwrap_or(DAffine3::IDENTITY)));
        Ok(calibration)
    }
}
