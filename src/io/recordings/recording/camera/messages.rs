//! The fields of the messages of cameras.

use super::super::bytes::Bytes;
use super::super::encoding::Encoding;
use super::super::message::Message;
use super::super::serialisation::Serialisation;
use super::topics::CameraMessage;
use glam::{DAffine3, DQuat, DVec3};
use std::time::Duration;

/// `sensor_msgs/Image`.
pub(super) struct RawImage<'a> {
    pub(super) head: ImageHead,
    pub(super) size_px: [u32; 2],
    pub(super) big_endian: bool,
    /// Bytes of a row.
    pub(super) step: u32,
    pub(super) data: &'a [u8],
}

/// `sensor_msgs/CompressedImage`.
pub(super) struct PackedImage<'a> {
    pub(super) head: ImageHead,
    pub(super) data: &'a [u8],
}

/// Header of an image: everything before its bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ImageHead {
    /// The frame of reference of the camera.
    pub(crate) frame_id: String,
    /// Pixel encoding, as one or several words.
    pub(crate) encoding: String,
}

impl ImageHead {
    /// Returns true if it is a depth image, as far as its encoding states it.
    pub(crate) fn is_depth(&self) -> bool {
        let kind = self.encoding.split([';', ' ']).next().unwrap_or_default();
        matches!(kind, "16UC1" | "mono16" | "32FC1") || self.encoding.contains("compressedDepth")
    }

    /// Returns true if it is a colour image, as far as its encoding states it.
    pub(crate) fn is_colored(&self) -> bool {
        let words = self.encoding.to_ascii_lowercase();
        let kinds = ["rgb", "bgr", "yuv", "yuy", "uyvy", "nv12", "nv21", "bayer"];
        kinds.iter().any(|kind| words.contains(kind))
    }
}

/// `sensor_msgs/CameraInfo`: the part that determines the rays of an image.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CameraInfo {
    pub(crate) frame_id: String,
    pub(crate) size_px: [u32; 2],
    pub(crate) model: String,
    pub(crate) distortion: Vec<f64>,
    /// The matrix of the camera, row by row.
    pub(crate) k: [f64; 9],
    /// The projection of the rectified image, row by row.
    pub(crate) p: [f64; 12],
    pub(crate) window: Window,
}

/// Region of interest of a camera image that is sent. All fields are zero if nothing is specified: then it is the whole
/// image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Window {
    /// Pixels of the sensor, along x and y, that are one of the image; 0 is 1.
    pub(crate) binning: [u32; 2],
    /// The first pixel of the sensor, along x and y, and the size of the part that is sent, in pixels of the sensor.
    pub(crate) offset_px: [u32; 2],
    pub(crate) size_px: [u32; 2],
}

/// Transform of the frame of reference `child` in the frame `parent`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub(crate) parent: String,
    pub(crate) child: String,
    pub(crate) parent_from_child: DAffine3,
    /// When it was so.
    pub(crate) time: Duration,
}

/// Returns the serialisation of ROS messages; cameras use no other one.
fn serialisation(message: &Message) -> Option<Serialisation> {
    match message.encoding {
        Encoding::Ros(serialisation) => Some(serialisation),
        Encoding::Livox(_) | Encoding::Protobuf | Encoding::Json => None,
    }
}

/// Names of the first ROS may begin with a slash.
fn frame_id(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim_start_matches('/').to_owned()
}

pub(super) fn raw<'a>(bytes: &'a [u8], message: &Message) -> Option<RawImage<'a>> {
    let serialisation = serialisation(message)?;
    let mut fields = serialisation.body(bytes)?;
    let header = serialisation.header(&mut fields)?;
    let (height, width) = (fields.u32()?, fields.u32()?);
    Some(RawImage {
        head: ImageHead {
            frame_id: frame_id(header.frame_id),
            encoding: fields.text()?,
        },
        size_px: [width, height],
        big_endian: fields.u8()? != 0,
        step: fields.u32()?,
        data: fields.counted()?,
    })
}

pub(super) fn compressed<'a>(bytes: &'a [u8], message: &Message) -> Option<PackedImage<'a>> {
    let serialisation = serialisation(message)?;
    let mut fields = serialisation.body(bytes)?;
    let header = serialisation.header(&mut fields)?;
    Some(PackedImage {
        head: ImageHead {
            frame_id: frame_id(header.frame_id),
            encoding: fields.text()?,
        },
        data: fields.counted()?,
    })
}

/// Reads the header before the bytes of an image of `kind`.
pub(crate) fn head(bytes: &[u8], message: &Message, kind: CameraMessage) -> Option<ImageHead> {
    match kind {
        CameraMessage::Image => Some(raw(bytes, message)?.head),
        CameraMessage::CompressedImage => Some(compressed(bytes, message)?.head),
        _ => None,
    }
}

/// `sensor_msgs/CameraInfo`.
pub(crate) fn camera_info(bytes: &[u8], message: &Message) -> Option<CameraInfo> {
    /// Lenses have fourteen numbers at most.
    const MAX_COEFFICIENTS: u32 = 64;
    let serialisation = serialisation(message)?;
    let mut fields = serialisation.body(bytes)?;
    let frame_id = frame_id(serialisation.header(&mut fields)?.frame_id);
    let (height, width) = (fields.u32()?, fields.u32()?);
    let model = fields.text()?;
    let count = fields.u32()?;
    if count > MAX_COEFFICIENTS {
        return None;
    }
    let distortion = (0..count).map(|_| fields.f64()).collect::<Option<_>>()?;
    let k = fields.f64s()?;
    let _rectification: [f64; 9] = fields.f64s()?;
    Some(CameraInfo {
        frame_id,
        size_px: [width, height],
        model,
        distortion,
        k,
        p: fields.f64s()?,
        // Old messages end before this field.
        window: window(&mut fields).unwrap_or_default(),
    })
}

/// Binning, and `sensor_msgs/RegionOfInterest`, whose height is before its width.
fn window(fields: &mut Bytes<'_>) -> Option<Window> {
    let mut pair = || Some([fields.u32()?, fields.u32()?]);
    let (binning, offset_px, [height, width]) = (pair()?, pair()?, pair()?);
    Some(Window {
        binning,
        offset_px,
        size_px: [width, height],
    })
}

/// `tf2_msgs/TFMessage`.
pub(crate) fn links(bytes: &[u8], message: &Message) -> Option<Vec<Link>> {
    let serialisation = serialisation(message)?;
    let mut fields = serialisation.body(bytes)?;
    let count = fields.u32()?;
    // Not allocated for the claimed count: every link takes bytes that must be there.
    let mut links = Vec::new();
    for _ in 0..count {
        let header = serialisation.header(&mut fields)?;
        let child = frame_id(fields.text()?.as_bytes());
        links.push(Link {
            parent: frame_id(header.frame_id),
            child,
            parent_from_child: transform(&mut fields)?,
            time: header.time,
        });
    }
    Some(links)
}

/// `geometry_msgs/Transform`.
pub(crate) fn extrinsics(bytes: &[u8], message: &Message) -> Option<DAffine3> {
    transform(&mut serialisation(message)?.body(bytes)?)
}

/// `std_msgs/Float32`.
pub(crate) fn number(bytes: &[u8], message: &Message) -> Option<f64> {
    serialisation(message)?.body(bytes)?.f32().map(f64::from)
}

fn transform(fields: &mut Bytes<'_>) -> Option<DAffine3> {
    let translation: [f64; 3] = fields.f64s()?;
    let rotation = DQuat::from_array(fields.f64s()?);
    let length = rotation.length();
    let is_sound = length.is_finite() && (0.5..2.0).contains(&length) && translation.iter().all(|x| x.is_finite());
    is_sound.then(|| DAffine3::from_rotation_translation(rotation.normalize(), DVec3::from_array(translation)))
}
