//! Depth image recording frames: from a folder, a message file, or an Azure Kinect video.

use super::calibration::Calibration;
use super::decoder::{ImageDecoder, Recorded};
use super::depth_scale::Units;
use super::error::RgbdError;
use super::folder::{Folder, has_extension, name_of};
use super::frames_before::GROUP_FRAMES;
use super::layouts::{self, FoundRecording};
use super::sizes::Sizes;
use super::stored_image::StoredImage;
use super::trajectory::Trajectory;
use super::{probe, recorders};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::files::timestamps::times_of_names;
use crate::io::{Entry, Part};
use crate::messages::{frame_by_index, grouped};
use crate::rgbd::{Filters, Sensor};
use crate::source::files::number;
use crate::source::{
    About, Capabilities, DecodeFailure, Decoder, DepthImages, FrameEntry, Groups, ImageFiles, NO_POSES, OpenOptions,
    Source,
};
use crate::wire::RawImages;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Default frame rate in frames per second: as in most depth cameras.
const USUAL_FPS: f64 = 30.0;

/// The frames of a recording of depth images.
#[derive(Debug)]
pub struct RgbdRecording {
    pub(super) recorded: Arc<Recorded>,
    pub(super) entries: Vec<Arc<FrameEntry>>,
    inputs: Vec<PathBuf>,
    pub(super) notes: Vec<String>,
    /// Descriptions of truncated or damaged input: also among the notes.
    damage: Vec<String>,
    pub(super) assumptions: Vec<Assumption>,
    layout: &'static str,
}

impl RgbdRecording {
    /// The recording in the folder or file that is the one input; `None` if it is none.
    ///
    /// # Errors
    /// [`RgbdError`].
    pub fn open(inputs: &[PathBuf], options: &OpenOptions) -> Result<Option<Self>, RgbdError> {
        if let Some(oni) = inputs.iter().find(|input| has_extension(name_of(input), &["oni"])) {
            return Err(RgbdError::Oni { path: oni.clone() });
        }
        let rgbd = &options.rgbd;
        let (layout, mut found) = match (inputs, &rgbd.depth) {
            ([folder], Some(depth)) if folder.is_dir() => ("patterns", layouts::by_pattern(folder, depth, rgbd)?),
            (_, Some(depth)) => {
                return Err(RgbdError::Options {
                    reason: format!(
                        "--depth-images {depth} is looked for in one folder: name that folder as the input"
                    ),
                });
            }
            ([folder], None) if folder.is_dir() => match layouts::find(&Folder::read(folder)?)? {
                Some(found) => found,
                None => return Ok(None),
            },
            ([file], None) if file.is_file() => match recorders::find(file, options)? {
                Some(found) => found,
                None => return Ok(None),
            },
            _ => return Ok(None),
        };
        let input = &inputs[0];
        if found.frames.is_empty() {
            return Err(RgbdError::NoDepth {
                path: input.clone(),
                looked_for: format!("its layout is that of {layout}"),
            });
        }
        take_options(&mut found, options)?;
        let sizes = Sizes::learn(&mut found, &options.read);
        found.notes.extend(note_of_poses(&found));
        let mut entries: Vec<FrameEntry> = found
            .frames
            .iter()
            .enumerate()
            .map(|(index, frame)| FrameEntry {
                time: frame.time,
                ..entry(index, &frame.depth)
            })
            .collect();
        number(&mut entries);
        let damage = std::mem::take(&mut found.damage);
        let mut notes = std::mem::take(&mut found.notes);
        notes.extend(damage.iter().cloned());
        let mut assumptions = std::mem::take(&mut found.assumptions);
        let calibration = Arc::clone(&found.frames[0].calibration);
        let mut recorded = Recorded::new(found, sizes, options);
        if rgbd.intrinsics.is_none() {
            assumptions.push(assumed_camera(&calibration, recorded.sensor(0).as_ref()));
        }
        if options.fps.is_none() {
            assumptions.extend(assumed_times(&entries));
        }
        if recorded.may_skip_filters() {
            let (filters, skipped) = probe::usual_filters(&recorded, entries.len());
            recorded.filters = filters;
            assumptions.extend(skipped);
            if filters != Filters::NONE {
                let value = format!("the depth filters `{filters}` are applied");
                let why = "they are the usual ones of pictures of depth images";
                assumptions.push(Assumption::new(
                    Subject::FilteredPoints,
                    value,
                    why,
                    Evidence::Convention,
                ));
            }
        }
        Ok(Some(Self {
            entries: entries.into_iter().map(Arc::new).collect(),
            inputs: inputs.to_vec(),
            notes,
            damage,
            assumptions,
            recorded: Arc::new(recorded),
            layout,
        }))
    }

    /// Returns a copy with other filters. Notes on skipped parts were reported already.
    pub(super) fn with_filters(&self, filters: Filters) -> Self {
        Self {
            recorded: Arc::new(self.recorded.filtered(filters)),
            entries: self.entries.clone(),
            inputs: self.inputs.clone(),
            notes: Vec::new(),
            damage: Vec::new(),
            assumptions: self
                .assumptions
                .iter()
                .filter(|assumption| assumption.subject != Subject::FilteredPoints)
                .cloned()
                .collect(),
            layout: self.layout,
        }
    }

    /// The name of its layout, for users.
    pub fn layout(&self) -> &'static str {
        self.layout
    }
}

fn entry(index: usize, depth: &StoredImage) -> FrameEntry {
    match depth {
        StoredImage::File(path) => FrameEntry::file(path),
        StoredImage::Message(image) => FrameEntry::entry(
            &*image.path,
            Entry {
                name: format!("{} {index}", image.topic),
                time: None,
                part: Part::Message(image.message.clone()),
            },
        ),
        StoredImage::Block(image) => {
            let whole = FrameEntry::file(&*image.path);
            FrameEntry {
                name: format!("{}: {} {index}", whole.name, image.track),
                ..whole
            }
        }
        StoredImage::Member(image) => {
            let whole = FrameEntry::file(&*image.path);
            FrameEntry {
                name: format!("{}: {index}", whole.name),
                ..whole
            }
        }
        // Recordings do not contain these.
        StoredImage::Received(image) => FrameEntry::embedded(&*image.input, &[]),
    }
}

/// The times of frames, if their names give them or nothing does.
fn assumed_times(entries: &[FrameEntry]) -> Option<Assumption> {
    let (first, last) = (entries.first()?, entries.last()?);
    let said = |value: String, why: &str, evidence: Evidence| {
        let assumption = Assumption::new(Subject::FrameTimes, value, why, evidence);
        (entries.len() > 1).then_some(assumption)
    };
    if entries.iter().all(|entry| entry.time.is_none()) {
        let why = "nothing says when they were taken, and most depth cameras have it";
        return said(format!("{USUAL_FPS} frames per second"), why, Evidence::Fallback);
    }
    let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    let of_names = times_of_names(&names);
    let are_told = entries.iter().zip(&of_names).all(|(entry, time)| entry.time == *time);
    if !are_told {
        return None;
    }
    let span = last.time?.saturating_sub(first.time?);
    let value = format!("{:.3} s for {} frames", span.as_secs_f64(), entries.len());
    said(value, "the file names are times", Evidence::Convention)
}

/// The camera of the first frame: its numbers for the images that are there.
fn assumed_camera(calibration: &Calibration, sensor: Option<&Sensor>) -> Assumption {
    let camera = sensor.map(|sensor| &sensor.rig.depth);
    let (focal, principal, size) = if let Some(camera) = camera {
        (camera.focal_px(), camera.principal_px(), Some(camera.size_px()))
    } else {
        let depth = &calibration.depth;
        (depth.focal_px, depth.principal_px, depth.for_size_px)
    };
    let size = size.map(|[width, height]| format!(" for images of {width} × {height} pixels"));
    let [fx, fy, cx, cy] = [focal.x, focal.y, principal.x, principal.y].map(|number| (number * 1e6).round() / 1e6);
    let value = format!("fx,fy,cx,cy {fx},{fy},{cx},{cy}{}", size.unwrap_or_default());
    let because = &calibration.because;
    if calibration.is_assumed {
        let why = format!("no file of the recording says it: {because}");
        Assumption::new(Subject::Camera, value, why, Evidence::Fallback)
    } else {
        Assumption::new(Subject::Camera, value, format!("{because} says so"), Evidence::File)
    }
}

/// Reports the number of frames without a pose, if others have one.
fn note_of_poses(found: &FoundRecording) -> Option<String> {
    let without: Vec<usize> = (0..found.frames.len())
        .filter(|&index| found.frames[index].world_from_camera.is_none())
        .collect();
    let first = *without.first().filter(|_| without.len() < found.frames.len())?;
    Some(format!(
        "{} of {} frames have no pose (the camera was lost), the first is {}",
        grouped(without.len()),
        grouped(found.frames.len()),
        frame_by_index(first)
    ))
}

/// Applies user-supplied options, which hold for every frame.
fn take_options(found: &mut FoundRecording, options: &OpenOptions) -> Result<(), RgbdError> {
    let rgbd = &options.rgbd;
    if let Some(intrinsics) = &rgbd.intrinsics {
        let calibration = Arc::new(Calibration::of_option(intrinsics)?);
        for frame in &mut found.frames {
            frame.calibration = Arc::clone(&calibration);
        }
    }
    let calibration = &found.frames[0].calibration;
    if let Some(scale) = rgbd.depth_scale {
        found.code = found.code.told(scale);
    } else if let Some(units) = calibration.units_per_metre {
        found.code = found.code.with_units(units);
        found.units = Units::Certain;
        let value = format!("{units} units per metre");
        let why = format!("{} says so", calibration.because);
        found
            .assumptions
            .push(Assumption::new(Subject::DepthScale, value, why, Evidence::File));
        probe::settle_units(found, &options.read);
    } else {
        probe::settle_units(found, &options.read);
    }
    if rgbd.poses.as_deref() == Some(Path::new(NO_POSES)) {
        for frame in &mut found.frames {
            frame.world_from_camera = None;
        }
        found
            .assumptions
            .retain(|assumption| assumption.subject != Subject::Poses);
    } else if let Some(poses) = &rgbd.poses {
        let trajectory = Trajectory::read(poses)?;
        found
            .assumptions
            .retain(|assumption| assumption.subject != Subject::Poses);
        found.take_poses(&trajectory);
        if found.frames.iter().all(|frame| frame.world_from_camera.is_none()) {
            found.notes.push(format!(
                "{} has no pose for any of the {} frames: times have to be within 20 ms, numbers count from 0",
                poses.display(),
                found.frames.len()
            ));
        }
    }
    if rgbd.invert_poses {
        invert_poses(found);
    }
    Ok(())
}

/// Inverts the poses. A user's statement is not an assumption.
fn invert_poses(found: &mut FoundRecording) {
    for frame in &mut found.frames {
        frame.world_from_camera = frame.world_from_camera.map(|pose| pose.inverse());
    }
    found
        .assumptions
        .retain(|assumption| assumption.subject != Subject::Poses);
}

impl Source for RgbdRecording {
    fn frames(&self) -> Range<usize> {
        0..self.entries.len()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&self.entries[index])
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(ImageDecoder::new(Arc::clone(&self.recorded)))
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            fps: Some(USUAL_FPS),
            assumptions: &self.assumptions,
            notes: &self.notes,
            damage: &self.damage,
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            groups: Some(self),
            depth_images: Some(self),
            image_files: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Groups for RgbdRecording {
    fn group(&self, index: usize) -> Range<usize> {
        if self.recorded.filters.temporal.is_none() {
            return index..index + 1;
        }
        let first = index / GROUP_FRAMES * GROUP_FRAMES;
        first..(first + GROUP_FRAMES).min(self.entries.len())
    }
}

impl DepthImages for RgbdRecording {
    fn sensor(&self, index: usize) -> Option<Sensor> {
        self.recorded.sensor(index)
    }

    fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        Some(self.recorded.raw_images(index)?.map_err(DecodeFailure::from))
    }

    fn filters(&self) -> Option<Filters> {
        Some(self.recorded.filters)
    }

    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        Some(Arc::new(self.with_filters(filters)))
    }
}

impl ImageFiles for RgbdRecording {
    fn image_files(&self) -> Vec<PathBuf> {
        self.recorded.files()
    }
}
