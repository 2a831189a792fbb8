//! Images of a frame → its cloud.

use super::calibration::{Calibration, NoCamera};
use super::depth_code::DepthCode;
use super::error::RgbdError;
use super::folder::has_extension;
use super::folder::name_of;
use super::frames_before::{DepthInTime, FilteredDepth, FramesBefore};
use super::layouts::{FoundRecording, FrameImages};
use super::sizes::Sizes;
use super::stored_image::StoredImage;
use super::text;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::RawCloud;
use crate::io::ReadOptions;
use crate::locks::lock;
use crate::photos::{DepthFile, DepthKind};
use crate::progress::Progress;
use crate::raster::{DEPTH_PIXEL_BYTES, Raster, Samples};
use crate::rgbd::{
    ColorImage, DepthFrame, DepthImage, DepthSamples, DepthTable, FilterReport, Filters, NOTICEABLE_SHARE, RayTable,
    Rig, Sensor, cloud,
};
use crate::source::{DecodeFailure, DecodedFrame, Decoder, FrameEntry, OpenOptions};
use crate::wire::RawImages;
use glam::DAffine3;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

/// A recording as its decoders share it.
#[derive(Debug)]
pub(super) struct Recorded {
    frames: Vec<FrameImages>,
    pub(super) code: DepthCode,
    /// Lookup table from 16-bit values to metres, once requested.
    table: OnceLock<Option<DepthTable>>,
    sizes: Sizes,
    pub(super) filters: Filters,
    /// They are the defaults, not the user's choice.
    filters_are_automatic: bool,
    pub(super) read: ReadOptions,
    /// Edge of the cells in which points are joined where frames are merged, metres.
    pub(super) merge_edge_m: Option<f64>,
    /// Frames whose points are excluded when merging.
    skipped: Vec<usize>,
    /// Cache of the prepared cameras that were needed so far; there is one, or a few.
    cameras: Mutex<Vec<Arc<PreparedRig>>>,
}

/// Cameras with the data computed from them once.
#[derive(Debug)]
struct PreparedRig {
    calibration: Arc<Calibration>,
    depth_px: [u32; 2],
    color_px: Option<[u32; 2]>,
    rig: Arc<Rig>,
    rays: Arc<RayTable>,
}

/// Fails where an image of this size takes more memory than it may: a few bytes of RVL can be any number of holes.
fn check_pixels([width, height]: [u32; 2], path: &Path, options: &ReadOptions) -> Result<(), RgbdError> {
    let bytes = u64::from(width) * u64::from(height) * DEPTH_PIXEL_BYTES;
    if bytes > options.max_memory_bytes {
        return Err(RgbdError::ManyPixels {
            path: path.to_owned(),
            size_px: [width, height],
            bytes,
            max_bytes: options.max_memory_bytes,
        });
    }
    Ok(())
}

impl Recorded {
    pub(super) fn new(found: FoundRecording, sizes: Sizes, options: &OpenOptions) -> Self {
        Self {
            frames: found.frames,
            code: found.code,
            table: OnceLock::new(),
            sizes,
            filters: options.rgbd.filters,
            filters_are_automatic: options.rgbd.filters_are_automatic,
            read: options.read,
            merge_edge_m: options.rgbd.merge_edge_m,
            skipped: options.rgbd.skipped.clone(),
            cameras: Mutex::default(),
        }
    }

    /// The files that its images are in.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let images = self
            .frames
            .iter()
            .flat_map(|frame| std::iter::once(&frame.depth).chain(&frame.color));
        images.map(|image| image.path().to_owned()).collect()
    }

    /// Creates a decoder for images that are not part of any recording: see [`Recorded::frame_cloud`].
    pub(super) fn of_no_frames(
        code: DepthCode,
        filters: Filters,
        filters_are_automatic: bool,
        read: ReadOptions,
    ) -> Self {
        Self {
            frames: Vec::new(),
            code,
            table: OnceLock::new(),
            sizes: Sizes::UNKNOWN,
            filters,
            filters_are_automatic,
            read,
            merge_edge_m: None,
            skipped: Vec::new(),
            cameras: Mutex::default(),
        }
    }

    /// Returns a copy of the recording with other filters.
    pub(super) fn filtered(&self, filters: Filters) -> Self {
        Self {
            frames: self.frames.clone(),
            code: self.code,
            table: self.table.clone(),
            sizes: self.sizes,
            filters,
            filters_are_automatic: false,
            read: self.read,
            merge_edge_m: self.merge_edge_m,
            skipped: self.skipped.clone(),
            cameras: Mutex::new(lock(&self.cameras).clone()),
        }
    }

    pub(super) fn sensor(&self, index: usize) -> Option<Sensor> {
        let frame = self.frames.get(index)?;
        let Sizes { depth_px, color_px } = self.sizes;
        let depth_px = depth_px?;
        // The table computed per pixel would be as large as an image that is refused.
        check_pixels(depth_px, frame.depth.path(), &self.read).ok()?;
        let prepared = self.prepared(&frame.calibration, depth_px, color_px).ok()?;
        Some(Sensor {
            rig: Arc::clone(&prepared.rig),
            world_from_camera: frame.world_from_camera,
        })
    }

    /// Returns the camera pose of frame `index`, if known.
    pub(super) fn pose(&self, index: usize) -> Option<DAffine3> {
        self.frames.get(index)?.world_from_camera
    }

    /// The file with the colours of frame `index`.
    pub(super) fn color_file(&self, index: usize) -> Option<&Path> {
        match self.frames.get(index)?.color.as_ref()? {
            StoredImage::File(path) => Some(path),
            StoredImage::Message(_) | StoredImage::Block(_) | StoredImage::Member(_) | StoredImage::Received(_) => None,
        }
    }

    /// The file with the depths of frame `index`, where its numbers are depths along the axis.
    pub(super) fn depth_file(&self, index: usize) -> Option<DepthFile> {
        let frame = self.frames.get(index)?;
        match &frame.depth {
            StoredImage::File(path) => Some(DepthFile {
                path: path.clone(),
                kind: DepthKind::Scaled(self.code.metres_per_unit()?),
                taken_by: None,
            }),
            StoredImage::Message(_) | StoredImage::Block(_) | StoredImage::Member(_) | StoredImage::Received(_) => None,
        }
    }

    /// Returns true if the points of frame `index` are excluded when merging.
    pub(super) fn is_skipped(&self, index: usize) -> bool {
        self.skipped.contains(&index)
    }

    /// Bytes that the points of a frame take, about, with normals and colours.
    pub(super) fn frame_bytes(&self) -> u64 {
        let [width, height] = self.sizes.depth_px.unwrap_or([640, 480]).map(u64::from);
        width * height * 44
    }

    fn prepared(
        &self,
        calibration: &Arc<Calibration>,
        depth_px: [u32; 2],
        color_px: Option<[u32; 2]>,
    ) -> Result<Arc<PreparedRig>, NoCamera> {
        /// Maximum number of cached cameras: a recording that changes its images more often prepares the cameras again.
        const MAX_RETAINED: usize = 8;
        let is_it = |known: &&Arc<PreparedRig>| {
            let is_camera = Arc::ptr_eq(&known.calibration, calibration) || known.calibration == *calibration;
            is_camera && known.depth_px == depth_px && known.color_px == color_px
        };
        let mut cameras = lock(&self.cameras);
        if let Some(known) = cameras.iter().find(is_it) {
            return Ok(Arc::clone(known));
        }
        let rig = calibration.rig(depth_px, color_px)?;
        // Only the colour camera may differ: rays belong to the depth camera.
        let same_rays = cameras.iter().find(|known| known.rig.depth == rig.depth);
        let rays = same_rays.map_or_else(|| Arc::new(RayTable::of(&rig.depth)), |known| Arc::clone(&known.rays));
        let prepared = Arc::new(PreparedRig {
            calibration: Arc::clone(calibration),
            depth_px,
            color_px,
            rays,
            rig: Arc::new(rig),
        });
        cameras.truncate(MAX_RETAINED - 1);
        cameras.insert(0, Arc::clone(&prepared));
        Ok(prepared)
    }

    /// The depth image of a frame as it was recorded, in its own units.
    fn depth_raster(&self, frame: &FrameImages) -> Result<Raster, RgbdError> {
        let raster = match &frame.depth {
            StoredImage::File(path) if has_extension(name_of(path), &["depth"]) => {
                let bytes = text::read_bytes(path, self.read.max_memory_bytes)?;
                text_raster(path, &bytes, frame.calibration.depth.for_size_px.unwrap_or([640, 480]))?
            }
            image => image.raster(&self.read)?,
        };
        check_pixels(raster.size_px, frame.depth.path(), &self.read)?;
        Ok(raster)
    }

    /// The depth image of a frame after the filters that look at it alone.
    pub(super) fn depth(&self, frame: &FrameImages) -> Result<(FilteredDepth, Arc<RayTable>), RgbdError> {
        let path = frame.depth.path();
        let raster = self.depth_raster(frame)?;
        let prepared = self
            .prepared(&frame.calibration, raster.size_px, None)
            .map_err(|error| no_camera(error, path, raster.size_px, &frame.calibration))?;
        let numbers = match &raster.samples {
            Samples::Gray16(numbers) => self.table().map(|table| (numbers.clone(), table)),
            _ => None,
        };
        let depth = self.code.depth_image(path, raster, &prepared.rays)?;
        let samples = match numbers {
            Some((numbers, table)) => DepthSamples::coded(numbers, table),
            None => DepthSamples::metres(depth.metres().to_vec()),
        };
        let (image, report) = self.filters.apply_and_count(depth, self.filters_are_automatic);
        let filtered = FilteredDepth {
            image,
            samples: Arc::new(samples),
            report,
        };
        Ok((filtered, Arc::clone(&prepared.rays)))
    }

    /// Returns the filter report of frame `index`; `None` if it cannot be read.
    pub(super) fn filter_report(&self, index: usize) -> Option<FilterReport> {
        Some(self.depth(self.frames.get(index)?).ok()?.0.report)
    }

    /// Returns true if there are filters and they are the defaults.
    pub(super) fn may_skip_filters(&self) -> bool {
        self.filters_are_automatic && self.filters != Filters::NONE
    }

    fn table(&self) -> Option<DepthTable> {
        self.table.get_or_init(|| self.code.table()).clone()
    }

    /// Returns the raw images of frame `index` as recorded, except that depths in a custom code are converted to
    /// metres. Colours are omitted if they cannot be read.
    pub(super) fn raw_images(&self, index: usize) -> Option<Result<RawImages, RgbdError>> {
        Some(self.raw_images_of(self.frames.get(index)?))
    }

    fn raw_images_of(&self, frame: &FrameImages) -> Result<RawImages, RgbdError> {
        let path = frame.depth.path();
        let raster = self.depth_raster(frame)?;
        let color = frame.color.as_ref().and_then(|image| image.raw_color(&self.read));
        let path_of = |error| no_camera(error, path, raster.size_px, &frame.calibration);
        let with_color = color.and_then(|(color, size_px)| {
            let prepared = self.prepared(&frame.calibration, raster.size_px, Some(size_px)).ok()?;
            Some((prepared, Some(color)))
        });
        let (prepared, color) = match with_color {
            Some(found) => found,
            None => (
                self.prepared(&frame.calibration, raster.size_px, None)
                    .map_err(path_of)?,
                None,
            ),
        };
        let (depth, units_per_metre) =
            if let (Samples::Gray16(_), Some(units)) = (&raster.samples, self.code.units_per_metre()) {
                (raster, units)
            } else {
                let depth = self.code.depth_image(path, raster, &prepared.rays)?;
                let metres = Samples::GrayF32(depth.metres().to_vec());
                let size_px = depth.size_px();
                (
                    Raster {
                        size_px,
                        samples: metres,
                    },
                    1.0,
                )
            };
        Ok(RawImages {
            rig: Arc::clone(&prepared.rig),
            world_from_camera: frame.world_from_camera,
            units_per_metre,
            depth,
            color,
        })
    }

    fn color_image(&self, image: &StoredImage) -> Result<ColorImage, RgbdError> {
        let raster = image.raster(&self.read)?;
        check_pixels(raster.size_px, image.path(), &self.read)?;
        let pixels = match raster.samples {
            Samples::Rgb8(pixels) => pixels,
            Samples::Gray8(samples) => samples.into_iter().map(|gray| [gray; 3]).collect(),
            Samples::Gray16(samples) => samples.into_iter().map(|gray| [(gray >> 8) as u8; 3]).collect(),
            Samples::GrayF32(_) => Vec::new(),
        };
        ColorImage::new(raster.size_px, pixels).ok_or_else(|| RgbdError::Image {
            path: image.path().to_owned(),
            reason: "its pixels are not colours".to_owned(),
        })
    }

    /// The colour of each pixel of `depth`.
    fn colors(
        &self,
        frame: &FrameImages,
        path: &Path,
        depth: &DepthImage,
        rays: &RayTable,
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

    /// The cloud of `frame`, whose filtered depth image goes through `with_frames_before`.
    pub(super) fn frame_cloud(
        &self,
        frame: &FrameImages,
        with_frames_before: impl FnOnce(FilteredDepth) -> DepthInTime,
    ) -> Result<RawCloud, RgbdError> {
        let (depth, color) = rayon::join(
            || self.depth(frame),
            || {
                frame
                    .color
                    .as_ref()
                    .map(|image| (image.path(), self.color_image(image)))
            },
        );
        let (depth, rays) = depth?;
        let depth = with_frames_before(depth);
        Ok(self.cloud(frame, depth, &rays, color))
    }

    /// The cloud of a frame of this depth image. Broken colours are a warning: the points are there.
    fn cloud(&self, frame: &FrameImages, depth: DepthInTime, rays: &Arc<RayTable>, color: Color<'_>) -> RawCloud {
        let mut warnings = Vec::new();
        let colors = color.and_then(|(path, image)| {
            let colors = image.and_then(|image| self.colors(frame, path, &depth.image, rays, &image));
            colors
                .map_err(|error| warnings.push(format!("{error}; the points of this frame have no colours")))
                .ok()
        });
        let of_pixels = colors.as_ref().map(|colors| {
            let colors = colors.iter().map(|&[red, green, blue, _]| [red, green, blue]);
            colors.collect::<Vec<_>>()
        });
        let mut cloud = cloud(&depth.image, rays, colors);
        if self.filters_are_automatic {
            said_by_filters(&depth.report, &mut warnings, &mut cloud.assumptions);
        }
        let rays = Arc::clone(rays);
        let made_from = DepthFrame::new(depth.before, depth.samples, rays, of_pixels, depth.report.applied);
        cloud.made_from = made_from.map(DepthFrame::into_made_from);
        cloud.warnings = warnings;
        cloud
    }
}

/// Reports the default filters that dropped much of an image, and those that were not applied.
fn said_by_filters(report: &FilterReport, warnings: &mut Vec<String>, assumptions: &mut Vec<Assumption>) {
    let noticeable = report.dropped.iter().filter(|dropped| dropped.share > NOTICEABLE_SHARE);
    for dropped in noticeable {
        let name = dropped.filter.name;
        warnings.push(format!(
            "the depth filter `{name}` drops {:.0} % of the measured pixels: --rgbd-filters none keeps them",
            100.0 * dropped.share
        ));
        assumptions.push(Assumption::new(
            Subject::FilteredPoints,
            format!("the depth filter `{name}` is applied"),
            "it is a default of pictures, and drops more than a fifth of the measured pixels of some frames",
            Evidence::Fallback,
        ));
    }
    for skipped in &report.skipped {
        assumptions.push(Assumption::new(
            Subject::FilteredPoints,
            format!("the depth filter `{}` is not applied", skipped.filter.name),
            "it is a default of pictures, and would drop more than half of the measured pixels of some frames",
            Evidence::Statistics,
        ));
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

/// The numbers of a `.depth` file, which does not state its size.
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
            wrong(format!("`{word}` is not a number, after {} of them", samples.len()))
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
    before: FramesBefore,
}

impl ImageDecoder {
    pub(super) fn new(recorded: Arc<Recorded>) -> Self {
        Self {
            recorded,
            before: FramesBefore::default(),
        }
    }
}

impl Decoder for ImageDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        _max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let recorded = Arc::clone(&self.recorded);
        let with_frames_before = |depth| {
            let before = |index: usize| Some(recorded.depth(&recorded.frames[index]).ok()?.0);
            let temporal = recorded.filters.temporal;
            self.before.filtered(temporal, index, depth, before, progress)
        };
        Ok(recorded
            .frame_cloud(&recorded.frames[index], with_frames_before)?
            .into())
    }
}
