//! Camera messages: images, camera intrinsics, and the transforms between frames of reference.
//!
//! The messages are ROS messages (`sensor_msgs`, `tf2_msgs`), of both versions, and additional ones of `librealsense`
//! in its own bags. Grouping the topics that belong together is left to the readers of a recording.

mod bayer;
mod compressed;
mod messages;
mod pixels;
mod topics;
mod yuv;

pub(crate) use messages::{CameraInfo, ImageHead, Link, Window, camera_info, extrinsics, head, links, number};
pub(crate) use topics::{CameraMessage, CameraTopic, CameraTopics};

use super::message::Message;
use crate::raster::Raster;

/// The image of a message; the error is the end of a sentence.
pub(super) fn image(bytes: &[u8], message: &Message, kind: CameraMessage, max_bytes: u64) -> Result<Raster, String> {
    const CUT: &str = "the message ends before its last field: it is truncated or damaged";
    if kind == CameraMessage::CompressedImage {
        let image = messages::compressed(bytes, message).ok_or(CUT)?;
        return compressed::raster(&image, max_bytes);
    }
    pixels::raster(&messages::raw(bytes, message).ok_or(CUT)?, max_bytes)
}

/// The image of bytes that no message is around: pixels as `sensor_msgs/Image` calls them, in rows without gaps; the
/// error is the end of a sentence.
pub(crate) fn bare_image(
    encoding: &str,
    size_px: [u32; 2],
    big_endian: bool,
    data: &[u8],
    max_bytes: u64,
) -> Result<Raster, String> {
    let image = messages::RawImage {
        head: ImageHead {
            frame_id: String::new(),
            encoding: encoding.to_owned(),
        },
        size_px,
        big_endian,
        step: pixels::row_bytes(encoding, size_px[0])?,
        data,
    };
    pixels::raster(&image, max_bytes)
}
