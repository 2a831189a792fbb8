//! Images of a frame → its cloud.

use super::calibration::{Calibration, NoCamera};
use super::depth_code::DepthCode;
use super::error::RgbdError;
use super::folder::has_extension;
use super::folder::name_of;
use super::layouts::{Found, FrameImages};
use super::sizes::Sizes;
use super::stored_image::StoredImage;
use super::text;
use crate::cloud::RawCloud;
use crate::io::ReadOptions;
use crate::io::raster::{Raster, Samples};
use crate::locks::lock;
use crate::photos::{DepthFile, DepthKind};
use crate::progress::Progress;
use crate::rgbd::{ColorImage, DepthImage, Filters, RayTable, Rig, Sensor, Temporal, TemporalFilter, cloud};
use crate::source::{DecodeFailure, DecodedFrame, Decoder, FrameEntry, OpenOptions};
use glam::DAffine3;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Frames that are decoded one after the other where each is filtered with those before it.
pub(super) const GROUP_FRAMES: usize = 32;

/// A recording as its decoders share it.
#[derive(Debug)]
pub(super) struct Recorded {
    frames: Vec<FrameImages>,
    code: DepthCode,
    sizes: Sizes,
    pub(super) filters: Filters,
    pub(super) read: ReadOptions,
    /// Frames whose points are left out where they are merged.
    left_out: Vec<usize>,
    /// Of each camera that was needed so far; there is one, or a few.
    cameras: Mutex<Vec<Arc<PreparedRig>>>,
}

/// Cameras with what is worked out of them once.
#[derive(Debug)]
struct PreparedRig {
    calibration: Arc<Calibration>,
    depth_px: [u32; 2],
    color_px: Option<[u32; 2]>,
    rig: Arc<Rig>,
    rays: Arc<RayTable>,
}

impl Recorded {
    pub(super) fn new(found: Found, sizes: Sizes, options: &OpenOptions) -> Self {
        Self {
            frames: found.frames,
            code: found.code,
            sizes,
            filters: options.rgbd.filters,
            read: options.read,
            left_out: options.rgbd.left_out.clone(),
            cameras: Mutex::default(),
        }
    }

    pub(super) fn sensor(&self, index: usize) -> Option<Sensor> {
        let frame = self.frames.get(index)?;
        let Sizes { depth_px, color_px } = self.sizes;
        let prepared = self.prepared(&frame.calibration, depth_px?, color_px).ok()?;
        Some(Sensor {
            rig: Arc::clone(&prepared.rig),
            world_from_camera: frame.world_from_camera,
        })
    }

    /// Where the camera of frame `index` was, if anybody knows.
    pub(super) fn pose(&self, index: usize) -> Option<DAffine3> {
        self.frames.get(index)?.world_from_camera
    }

    /// The file with the colours of frame `index`.
    pub(super) fn color_file(&self, index: usize) -> Option<&Path> {
        match self.frames.get(index)?.color.as_ref()? {
            StoredImage::File(path) => Some(path),
            StoredImage::Message(_) | StoredImage::Block(_) => None,
        }
    }

    /// The file with the depths of frame `index`, where its numbers are depths along the axis.
    pub(super) fn depth_file(&self, index: usize) -> Option<DepthFile> {
        let frame = self.frames.get(index)?;
        match &frame.depth {
            StoredImage::File(path) => Some(DepthFile {
                path: path.clone(),
                kind: DepthKind::Scaled(self.code.metres_per_unit()?),
            }),
            StoredImage::Message(_) | StoredImage::Block(_) => None,
        }
    }

    /// Whether the points of frame `index` are left out where frames are merged.
    pub(super) fn is_left_out(&self, index: usize) -> bool {
        self.left_out.contains(&index)
    }

    /// Bytes that the points of a frame take, about.
    pub(super) fn frame_bytes(&self) -> u64 {
        let [width, height] = self.sizes.depth_px.unwrap_or([640, 480]).map(u64::from);
        width * height * 32
    }

    fn prepared(
        &self,
        calibration: &Arc<Calibration>,
        depth_px: [u32; 2],
        color_px: Option<[u32; 2]>,
    ) -> Result<Arc<PreparedRig>, NoCamera> {
        /// A recording that changes its images more often makes the cameras anew.
        const MOST_KEPT: usize = 8;
        let is_it = |known: &&Arc<PreparedRig>| {
            let is_camera = Arc::ptr_eq(&known.calibration, calibration) || known.calibration == *calibration;
            is_camera && known.depth_px == depth_px && known.color_px == color_px
        };
        let mut cameras = lock(&self.cameras);
        if let Some(known) = cameras.iter().find(is_it) {
            return Ok(Arc::clone(known));
        }
        let rig = calibration.rig(depth_px, color_px)?;
        // The colour camera alone may be another one: rays are those of the depth camera.
        let same_rays = cameras.iter().find(|known| known.rig.depth == rig.depth);
        let rays = same_rays.map_or_else(|| Arc::new(RayTable::of(&rig.depth)), |known| Arc::clone(&known.rays));
        let prepared = Arc::new(PreparedRig {
            calibration: Arc::clone(calibration),
            depth_px,
            color_px,
            rays,
            rig: Arc::new(rig),
        });
        cameras.truncate(MOST_KEPT - 1);
        cameras.insert(0, Arc::clone(&prepared));
        Ok(prepared)
    }

    /// The depth image of a frame after the filters that look at it alone.
    fn depth(&self, frame: &FrameImages) -> Result<(DepthImage, Arc<RayTable>), RgbdError> {
        let path = frame.depth.path();
        let raster = match &frame.depth {
            StoredImage::File(path) if has_extension(name_of(path), &["depth"]) => {
                let bytes = text::read_bytes(path, self.read.max_memory_bytes)?;
                text_raster(path, &bytes, frame.calibration.depth.for_size_px.unwrap_or([640, 480]))?
            }
            image => image.raster(&self.read)?,
        };
        let prepared = self
            .prepared(&frame.calibration, raster.size_px, None)
            .map_err(|error| no_camera(error, path, raster.size_px, &frame.calibration))?;
        let depth = self.code.depth_image(path, raster, &prepared.rays)?;
        Ok((self.filters.apply(depth), Arc::clone(&prepared.rays)))
    }

    fn color_image(&self, image: &StoredImage) -> Result<ColorImage, RgbdError> {
        let raster = image.raster(&self.read)?;
        let pixels = match raster.samples {
            Samples::Rgb8(pixels) => pixels,
            Samples::Gray8(samples) => samples.into_iter().map(|gray| [gray; 3]).collect(),
            Samples::Gray16(samples) => samples.into_iter().map(|gray| [(gray >> 8) as u8; 3]).collect(),
            Samples::GrayF32(_) => Vec::new(),
        };
        ColorImage::new(raster.size_px, pixels).ok_or_else(|| RgbdError::Image {
            path: image.path().to_owned(),
            reason: "its pixels are no colours".to_owned(),
        })
    }

    /// The colour of each pixel of `depth`.
    fn colors(
        &self,
        frame: &FrameImages,
        path: &Path,
        (depth, rays): (&DepthImage, &RayTable),
        image: &ColorImage,
    ) -> Result<Vec<[u8; 4]>, RgbdError> {
        let size = image.size_px();
        let prepared = self
            .prepared(&frame.calibration, depth.size_px(), Some(size))
            .map_err(|error| no_camera(error, path, size, &frame.calibration))?;
        if let Some(color) = &prepared.rig.color {
            return Ok(color.colors(depth, rays, image));
        }
        if size != depth.size_px() {
            return Err(RgbdError::Size {
                path: path.to_owned(),
                found: size,
                expected: depth.size_px(),
                because: "as the depth image: nothing says that colours are from another camera".to_owned(),
            });
        }
        Ok(image.pixels().iter().map(|&[r, g, b]| [r, g, b, 255]).collect())
    }

    /// The cloud of a frame of this depth image. Broken colours are a warning: the points are there.
    fn cloud(&self, frame: &FrameImages, depth: &DepthImage, rays: &RayTable, color: Color<'_>) -> RawCloud {
        let mut warnings = Vec::new();
        let colors = color.and_then(|(path, image)| {
            let colors = image.and_then(|image| self.colors(frame, path, (depth, rays), &image));
            colors
                .map_err(|error| warnings.push(format!("{error}; the points of this frame have no colours")))
                .ok()
        });
        let mut cloud = cloud(depth, rays, colors);
        cloud.warnings = warnings;
        if frame.calibration.is_assumed {
            cloud.assumption = Some(frame.calibration.because.clone());
        }
        cloud
    }
}

type Color<'a> = Option<(&'a Path, Result<ColorImage, RgbdError>)>;

fn no_camera(error: NoCamera, path: &Path, found: [u32; 2], calibration: &Calibration) -> RgbdError {
    match error {
        NoCamera::Size(expected) => RgbdError::Size {
            path: path.to_owned(),
            found,
            expected,
            because: calibration.because.clone(),
        },
        NoCamera::Numbers(error) => RgbdError::Calibration {
            path: calibration.because.clone().into(),
            reason: error.to_string(),
        },
    }
}

/// The numbers of a `.depth` file, which says nothing of its size.
fn text_raster(path: &Path, bytes: &[u8], size_px: [u32; 2]) -> Result<Raster, RgbdError> {
    let wrong = |reason: String| RgbdError::Image {
        path: path.to_owned(),
        reason,
    };
    let pixels = size_px.map(u64::from).iter().product::<u64>();
    let words = bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let mut samples = Vec::with_capacity(pixels.min(bytes.len() as u64) as usize);
    for word in words {
        let number = fast_float2::parse::<f32, _>(word);
        samples.push(number.map_err(|_| {
            let word = String::from_utf8_lossy(&word[..word.len().min(20)])
                .escape_default()
                .to_string();
            wrong(format!("`{word}` is no number, after {} of them", samples.len()))
        })?);
    }
    if samples.len() as u64 != pixels {
        let [width, height] = size_px;
        return Err(wrong(format!(
            "it has {} numbers, and {width} × {height} pixels are {pixels}",
            samples.len()
        )));
    }
    Ok(Raster {
        size_px,
        samples: Samples::GrayF32(samples),
    })
}

/// Decodes frames of a recording. It keeps the state of the temporal filter, if there is one.
pub(super) struct ImageDecoder {
    recorded: Arc<Recorded>,
    /// The filter after the frame of this index.
    temporal: Option<(usize, TemporalFilter)>,
}

impl ImageDecoder {
    pub(super) fn new(recorded: Arc<Recorded>) -> Self {
        Self {
            recorded,
            temporal: None,
        }
    }

    /// `depth`, which is that of frame `index`, with the frames before it. Broken ones among these are passed over.
    fn with_frames_before(&mut self, index: usize, depth: DepthImage, progress: &Progress) -> DepthImage {
        let Some(temporal) = self.recorded.filters.temporal else {
            return depth;
        };
        let begin = temporal_begin(index);
        // The frames of a group go on from each other; each group has a beginning of its own.
        let known = self
            .temporal
            .take()
            .filter(|(last, _)| *last < index && temporal_begin(*last) == begin);
        let (first, mut filter) = known.map_or_else(
            || (begin, TemporalFilter::new(temporal)),
            |(last, filter)| (last + 1, filter),
        );
        for before in first..index {
            if progress.is_cancelled() {
                return depth;
            }
            if let Ok((before, _)) = self.recorded.depth(&self.recorded.frames[before]) {
                filter.next(before);
            }
        }
        let filtered = filter.next(depth);
        self.temporal = Some((index, filter));
        filtered
    }
}

impl Decoder for ImageDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        _most_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let recorded = Arc::clone(&self.recorded);
        let frame = &recorded.frames[index];
        let (depth, color) = rayon::join(
            || recorded.depth(frame),
            || {
                frame
                    .color
                    .as_ref()
                    .map(|image| (image.path(), recorded.color_image(image)))
            },
        );
        let (depth, rays) = depth?;
        let depth = self.with_frames_before(index, depth, progress);
        Ok(recorded.cloud(frame, &depth, &rays, color).into())
    }
}

/// The frame from which the filter of frame `index` begins: so far before its group that what is still before it makes
/// no difference.
fn temporal_begin(index: usize) -> usize {
    (index / GROUP_FRAMES * GROUP_FRAMES).saturating_sub(Temporal::LEAD_FRAMES)
}
