//! Frames of depth images: a camera's measurements, before any filter, with all data needed to make points.

use super::bytes::{Fields, Written};
use super::cameras::{CameraFields, checked_size, read_transform, write_camera, write_size, write_transform};
use super::error::WireError;
use super::packed_image::{PackedImage, Packing};
use crate::raster::{self, Raster, Samples, rvl};
use crate::rgbd::{ColorCamera, Rig};
use glam::DAffine3;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::borrow::Cow;
use std::sync::Arc;

/// Bytes of a body before its images, as this version writes them.
const LAYOUT_BYTES: usize = 448;

/// Name of the part being read, for errors.
const WHAT: &str = "a frame of images";

/// Bit of the flags: the pose is known.
const HAS_POSE: u32 = 1;

/// Bit of the flags: colours are from a camera of their own.
const HAS_COLOR_CAMERA: u32 = 2;

/// Quality of JPEG, of 100.
const JPEG_QUALITY: u8 = 90;

/// Coding of depths on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthCoding {
    /// As they are.
    Raw,
    /// Packed without loss, by RVL (Wilson 2017); floats as they are.
    #[default]
    Rvl,
}

/// Coding of colours on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColorCoding {
    /// Three bytes per pixel.
    Raw,
    /// JPEG; images that are JPEG already are sent as they are.
    #[default]
    Jpeg,
}

/// Coding of images on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ImageCoding {
    /// Depths.
    pub depth: DepthCoding,
    /// Colours.
    pub color: ColorCoding,
}

/// Raw images recorded by the cameras of a sensor at one time step.
#[derive(Debug, Clone)]
pub struct RawImages {
    pub(crate) rig: Arc<Rig>,
    pub(crate) world_from_camera: Option<DAffine3>,
    /// Units per metre of integer depths; floats are metres.
    pub(crate) units_per_metre: f64,
    /// Distances along the axis of the camera.
    pub(crate) depth: Raster,
    pub(crate) color: Option<RawColor>,
}

/// A colour image.
#[derive(Debug, Clone)]
pub(crate) enum RawColor {
    /// Its pixels.
    Pixels(Raster),
    /// A JPEG, with its size.
    Jpeg([u32; 2], Vec<u8>),
}

impl RawColor {
    fn size_px(&self) -> [u32; 2] {
        match self {
            Self::Pixels(raster) => raster.size_px,
            Self::Jpeg(size_px, _) => *size_px,
        }
    }

    /// As JPEG. `None` if it is not a colour image, or larger than a JPEG may be.
    fn jpeg(&self) -> Option<Cow<'_, [u8]>> {
        let raster = match self {
            Self::Jpeg(_, bytes) => return Some(bytes.into()),
            Self::Pixels(raster) => raster,
        };
        let mut bytes = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
        write_jpeg(encoder, raster)?;
        Some(bytes.into())
    }

    /// Three bytes per pixel; the error is the end of a sentence.
    fn pixels(&self, max_bytes: u64) -> Result<Vec<u8>, String> {
        let raster = match self {
            Self::Pixels(raster) => Cow::Borrowed(raster),
            Self::Jpeg(_, bytes) => Cow::Owned(raster::decode(bytes, max_bytes)?),
        };
        match &raster.samples {
            Samples::Rgb8(pixels) => Ok(pixels.as_flattened().to_vec()),
            Samples::Gray8(gray) => Ok(gray.iter().flat_map(|&gray| [gray; 3]).collect()),
            Samples::Gray16(gray) => Ok(gray.iter().flat_map(|&gray| [(gray >> 8) as u8; 3]).collect()),
            Samples::GrayF32(_) => Err("its pixels are not colours".to_owned()),
        }
    }
}

fn write_jpeg(mut encoder: JpegEncoder<&mut Vec<u8>>, raster: &Raster) -> Option<()> {
    let [width, height] = raster.size_px;
    let encoded = match &raster.samples {
        Samples::Rgb8(pixels) => encoder.encode(pixels.as_flattened(), width, height, ExtendedColorType::Rgb8),
        Samples::Gray8(gray) => encoder.encode(gray, width, height, ExtendedColorType::L8),
        Samples::Gray16(_) | Samples::GrayF32(_) => return None,
    };
    encoded.ok()
}

/// Encodes the frame body of `images`. Colours that cannot be read are omitted, and the reason is returned in the
/// second part.
///
/// # Errors
/// The reason why the depth image cannot be sent, as the end of a sentence.
pub(crate) fn images_body(
    images: &RawImages,
    coding: ImageCoding,
    max_bytes: u64,
) -> Result<(Vec<u8>, Option<String>), String> {
    checked_size(images.depth.size_px, "the depth image").map_err(|error| error.to_string())?;
    let ((depth_code, depth), (color_code, color, problem)) = rayon::join(
        || packed_depth(&images.depth, coding.depth),
        || match &images.color {
            None => (0, Cow::default(), None),
            Some(color) => packed_color(color, coding.color, max_bytes),
        },
    );
    if depth_code == u32::MAX {
        return Err(format!("{} is not a depth", images.depth.samples.name()));
    }
    let mut flags = 0;
    let pose = images.world_from_camera.unwrap_or_default();
    flags |= u32::from(images.world_from_camera.is_some()) * HAS_POSE;
    flags |= u32::from(images.rig.color.is_some()) * HAS_COLOR_CAMERA;
    let mut body = Written(Vec::with_capacity(LAYOUT_BYTES + depth.len() + color.len()));
    body.u32(LAYOUT_BYTES as u32)
        .u32(depth_code)
        .u32(depth.len() as u32)
        .u32(color_code)
        .u32(color.len() as u32)
        .u32(flags)
        .f64s(&[images.units_per_metre]);
    write_transform(&pose, &mut body);
    write_camera(&images.rig.depth, &mut body);
    if let Some(camera) = &images.rig.color {
        write_camera(&camera.camera, &mut body);
        write_transform(&camera.color_from_depth, &mut body);
    } else {
        write_size(images.color.as_ref().map_or([0; 2], RawColor::size_px), &mut body);
        write_transform(&DAffine3::IDENTITY, &mut body);
    }
    debug_assert_eq!(body.0.len(), LAYOUT_BYTES);
    body.0.extend_from_slice(&depth);
    body.0.extend_from_slice(&color);
    Ok((body.0, problem))
}

/// Code and bytes; the code is `u32::MAX` for non-depth images.
fn packed_depth(raster: &Raster, coding: DepthCoding) -> (u32, Vec<u8>) {
    match (&raster.samples, coding) {
        (Samples::Gray16(depths), DepthCoding::Raw) => {
            (0, depths.iter().flat_map(|depth| depth.to_le_bytes()).collect())
        }
        (Samples::GrayF32(depths), _) => (1, depths.iter().flat_map(|depth| depth.to_le_bytes()).collect()),
        (Samples::Gray16(depths), DepthCoding::Rvl) => (2, rvl::encode(raster.size_px, depths)),
        (Samples::Gray8(_) | Samples::Rgb8(_), _) => (u32::MAX, Vec::new()),
    }
}

/// Code, bytes, and the reason why there are none.
fn packed_color(color: &RawColor, coding: ColorCoding, max_bytes: u64) -> (u32, Cow<'_, [u8]>, Option<String>) {
    if let Err(error) = checked_size(color.size_px(), "the colour image") {
        return (0, Cow::default(), Some(error.to_string()));
    }
    if coding == ColorCoding::Jpeg
        && let Some(bytes) = color.jpeg()
    {
        return (2, bytes, None);
    }
    match color.pixels(max_bytes) {
        Ok(pixels) => (1, pixels.into(), None),
        Err(problem) => (0, Cow::default(), Some(format!("the colour image: {problem}"))),
    }
}

/// A frame of images as it came.
#[derive(Debug, Clone)]
pub struct ReceivedImages {
    /// The cameras.
    pub rig: Rig,
    /// Pose of the depth camera, if sent by the server.
    pub world_from_camera: Option<DAffine3>,
    /// Units per metre of integer depths.
    pub units_per_metre: f64,
    /// Distances along the axis.
    pub depth: PackedImage,
    /// Colours, if there are some.
    pub color: Option<PackedImage>,
}

impl ReceivedImages {
    /// Parses the images in `payload` from offset `body` on.
    pub(super) fn parse(payload: &Arc<Vec<u8>>, body: usize) -> Result<Self, WireError> {
        let bytes = payload.get(body..).unwrap_or_default();
        let mut fields = Fields::new(bytes, WHAT);
        let layout_bytes = fields.u32()? as usize;
        let (depth_code, depth_bytes) = (fields.u32()?, fields.u32()? as usize);
        let (color_code, color_bytes) = (fields.u32()?, fields.u32()? as usize);
        let flags = fields.u32()?;
        let units_per_metre = fields.f64()?;
        let pose = read_transform(&mut fields, "the pose of a frame")?;
        let depth_camera = CameraFields::read(&mut fields)?;
        let color_camera = CameraFields::read(&mut fields)?;
        let color_from_depth = read_transform(&mut fields, "the place of the colour camera")?;
        let is_whole = layout_bytes >= LAYOUT_BYTES
            && layout_bytes as u64 + depth_bytes as u64 + color_bytes as u64 == bytes.len() as u64;
        if !is_whole {
            let reason = format!(
                "{layout_bytes} bytes before its images, {depth_bytes} of depths and {color_bytes} of colours are \
                 not its {} bytes",
                bytes.len()
            );
            return Err(WireError::malformed(WHAT, reason));
        }
        if !(units_per_metre.is_finite() && units_per_metre > 0.0) {
            let reason = format!("{units_per_metre} units are a metre, expected a number above 0");
            return Err(WireError::malformed(WHAT, reason));
        }
        let depth_begin = body + layout_bytes;
        let color_begin = depth_begin + depth_bytes;
        let rig = Rig {
            depth: depth_camera.camera("the depth camera")?,
            color: match flags & HAS_COLOR_CAMERA {
                0 => None,
                _ => Some(ColorCamera {
                    camera: color_camera.camera("the colour camera")?,
                    color_from_depth,
                }),
            },
        };
        let packing = packing_of(depth_code, [Packing::Gray16, Packing::GrayF32, Packing::Rvl], "depths")?;
        let depth = PackedImage::new(
            Arc::clone(payload),
            depth_begin..color_begin,
            rig.depth.size_px(),
            packing,
            "the depth image",
        )?;
        let color = match color_code.checked_sub(1) {
            None => None,
            Some(code) => Some(PackedImage::new(
                Arc::clone(payload),
                color_begin..payload.len(),
                checked_size(color_camera.size_px, "the colour image")?,
                packing_of(code, [Packing::Rgb8, Packing::Jpeg], "colours")?,
                "the colour image",
            )?),
        };
        Ok(Self {
            rig,
            world_from_camera: (flags & HAS_POSE != 0).then_some(pose),
            units_per_metre,
            depth,
            color,
        })
    }
}

impl ReceivedImages {
    /// Returns the raw images in the form in which a server relays them; the error is the end of a sentence.
    pub(crate) fn raw(&self, max_bytes: u64) -> Result<RawImages, String> {
        let raw_color = |image: &PackedImage| match image.jpeg() {
            Some(bytes) => Some(RawColor::Jpeg(image.size_px(), bytes.to_vec())),
            // Broken colours are skipped.
            None => image.raster(max_bytes).ok().map(RawColor::Pixels),
        };
        Ok(RawImages {
            rig: Arc::new(self.rig.clone()),
            world_from_camera: self.world_from_camera,
            units_per_metre: self.units_per_metre,
            depth: self.depth.raster(max_bytes)?,
            color: self.color.as_ref().and_then(raw_color),
        })
    }
}

fn packing_of<const N: usize>(code: u32, known: [Packing; N], what: &str) -> Result<Packing, WireError> {
    known
        .get(code as usize)
        .copied()
        .ok_or_else(|| WireError::malformed(WHAT, format!("{what} of a coding that is not known: {known:?} are")))
}
