//! Multi-view video: a sequence in which every frame is a set of calibrated images from several cameras.
//!
//! How it works. A calibration names cameras, folders hold their images (`layout.rs`), and the clock in the names
//! determines which belong together (`clock.rs`). Each time step is a set of its own, examined on request. Its points
//! come from a file of that time step, otherwise from stereo; the points of the calibration belong to the time step
//! that was calibrated. A camera that has no image of a time step is missing from that one alone, and a warning is
//! issued.
//!
//! Folders are checked again. A time step is accepted once all cameras have it, or once nothing came for some time.

mod clock;
mod layout;

use super::photos::cloud_of_set;
use super::{
    About, Capabilities, DecodeFailure, DecodedFrame, Decoder, FrameEntry, Growth, HasPosedImages, OpenOptions,
    SequenceError, Source,
};
use crate::cloud::RawCloud;
use crate::io::{self, Format, Part};
use crate::locks::{lock, read, write};
use crate::photos::{Calibration, PhotosError, Rig, ViewSet};
use crate::progress::Progress;
use crate::stereo::{Dense, DenseError, Pairwise};
use clock::{Timed, matching, timed};
use layout::{FoundTimeStep, Images, Layout, entries_of};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, RwLock};
use std::time::Duration;

/// Companion folders of the images that hold the points of each time step.
const POINT_FOLDERS: &[&str] = &["points", "pointclouds", "point_clouds", "clouds", "ply", "pcd"];

/// Longest side, in pixels, of images used for plane sweeping where pairs show nothing: a video frame has to be there
/// soon. `--dense` uses the same number of pixels as for a single set.
const MAX_SIDE_PX: u32 = 320;

/// Multi-view video of a dynamic scene.
#[derive(Debug)]
pub struct MultiviewVideo {
    known: Arc<Known>,
    time_steps: Arc<RwLock<Vec<Arc<TimeStep>>>>,
    /// Held so that only one thread examines it.
    looks: Mutex<()>,
    inputs: Vec<PathBuf>,
    options: OpenOptions,
    notes: Vec<String>,
}

/// Data shared by all time steps.
#[derive(Debug)]
enum Known {
    /// Camera rig shared by all time steps, whose images are in folders.
    Rig(Box<Capture>),
    /// Calibration for each time step.
    Sets(Layout),
    /// Single calibration with the capture time of each image.
    Times(Box<Calibration>, Vec<FoundTimeStep>),
}

/// Cameras, and where their images are.
#[derive(Debug)]
struct Capture {
    rig: Rig,
    layout: Layout,
    /// Folders around which points of time steps are looked for.
    folders: Vec<PathBuf>,
}

#[derive(Debug)]
struct TimeStep {
    entry: Arc<FrameEntry>,
    images: Images,
    points: Option<PathBuf>,
    set: OnceLock<Result<Arc<ViewSet>, Arc<PhotosError>>>,
}

impl MultiviewVideo {
    /// Opens the multi-view video that `calibration` names, or returns the calibration again if it is not one.
    ///
    /// # Errors
    /// [`PhotosError::NoPhotos`] of a calibration without a camera that can be used.
    pub(super) fn of(
        calibration: Calibration,
        inputs: &[PathBuf],
        options: &OpenOptions,
    ) -> Result<Result<Self, Calibration>, PhotosError> {
        if let Some(found) = time_steps_by_time(&calibration) {
            let known = Known::Times(Box::new(calibration), found);
            return Ok(Ok(Self::new(known, Vec::new(), inputs, options)));
        }
        let Some(layout) = Layout::of(&calibration) else {
            return Ok(Err(calibration));
        };
        let folders = calibration.folders().to_vec();
        let points_file = calibration.points_file().map(Path::to_owned);
        let mut rig = calibration.rig()?;
        rig.name_cameras(|listed| layout.camera_name(listed));
        let mut notes = rig.notes().to_vec();
        if let Layout::Cameras(of_cameras) = &layout {
            let without = rig.names().zip(rig.listed());
            let without = without.filter(|&(_, listed)| of_cameras.get(listed).is_none_or(Option::is_none));
            let names: Vec<&str> = without.map(|(name, _)| name).collect();
            if !names.is_empty() {
                notes.push(format!("no folder with images was found for {}", names.join(", ")));
            }
        }
        if let Some(file) = points_file {
            notes.push(format!(
                "the points of {} belong to a single time step: those of each frame are computed from its images",
                file.display()
            ));
        }
        let capture = Capture { rig, layout, folders };
        Ok(Ok(Self::new(Known::Rig(Box::new(capture)), notes, inputs, options)))
    }

    /// Opens the folder that is the one input, if its folders are image sets of one time step each.
    pub(super) fn of_sets(inputs: &[PathBuf], options: &OpenOptions) -> Option<Self> {
        let [input] = inputs else { return None };
        let layout = Layout::of_sets(input)?;
        Some(Self::new(Known::Sets(layout), Vec::new(), inputs, options))
    }

    fn new(known: Known, notes: Vec<String>, inputs: &[PathBuf], options: &OpenOptions) -> Self {
        let time_steps = known.time_steps().into_iter().map(Arc::new).collect();
        Self {
            known: Arc::new(known),
            time_steps: Arc::new(RwLock::new(time_steps)),
            looks: Mutex::new(()),
            inputs: inputs.to_vec(),
            options: options.clone(),
            notes,
        }
    }

    fn time_step(&self, index: usize) -> Arc<TimeStep> {
        Arc::clone(&read(&self.time_steps)[index])
    }
}

impl Source for MultiviewVideo {
    fn frames(&self) -> Range<usize> {
        0..read(&self.time_steps).len()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&read(&self.time_steps)[index].entry)
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(TimeStepDecoder {
            known: Arc::clone(&self.known),
            time_steps: Arc::clone(&self.time_steps),
            options: self.options.clone(),
        })
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            notes: &self.notes,
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            growth: Some(self),
            posed_images: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Growth for MultiviewVideo {
    fn may_grow(&self) -> bool {
        !matches!(*self.known, Known::Times(..))
    }

    fn is_live(&self) -> bool {
        false
    }

    /// Rescans the folders. Entries that appear between or before existing ones are ignored: frames keep their indices.
    fn look_again(&self) -> Result<usize, SequenceError> {
        let _guard = lock(&self.looks);
        let found = self.known.time_steps();
        let last = read(&self.time_steps).last().map(Arc::clone);
        let behind = match &last {
            // A time step may be named after another of its images by now.
            Some(last) => found
                .iter()
                .rposition(|time_step| time_step.is_same_or_before(last))
                .map_or(0, |at| at + 1),
            None => 0,
        };
        let images_of_each = found.iter().map(TimeStep::image_count).max().unwrap_or(0);
        let came = found.into_iter().skip(behind);
        let came: Vec<Arc<TimeStep>> = came
            .take_while(|time_step| time_step.is_whole(images_of_each))
            .map(Arc::new)
            .collect();
        let count = came.len();
        write(&self.time_steps).extend(came);
        Ok(count)
    }
}

impl HasPosedImages for MultiviewVideo {
    fn posed_images(&self, index: usize) -> Option<Arc<ViewSet>> {
        self.time_step(index).set(index, &self.known).ok()
    }
}

impl Known {
    /// Returns the time steps that currently exist.
    fn time_steps(&self) -> Vec<TimeStep> {
        match self {
            Self::Rig(capture) => {
                let clouds = clouds_in(&capture.folders);
                let found = capture.layout.time_steps().into_iter();
                found.map(|found| TimeStep::with_points(found, &clouds)).collect()
            }
            Self::Sets(layout) => layout
                .time_steps()
                .into_iter()
                .map(|found| TimeStep::new(found, None))
                .collect(),
            Self::Times(_, found) => found.iter().map(|found| TimeStep::new(found.clone(), None)).collect(),
        }
    }
}

impl TimeStep {
    fn new(FoundTimeStep { timed, images }: FoundTimeStep, points: Option<PathBuf>) -> Self {
        let mut entry = timed.entry;
        if let Some(points) = &points {
            entry.path.clone_from(points);
        }
        Self {
            entry: Arc::new(entry),
            images,
            points,
            set: OnceLock::new(),
        }
    }

    /// With the points in a file among its images, else with the points of its number.
    fn with_points(found: FoundTimeStep, clouds: &[Timed]) -> Self {
        let folder = Some(&found.timed.entry.path).filter(|path| path.is_dir());
        let inside = folder.and_then(|folder| entries_of(folder).into_iter().find(|path| is_cloud(path)));
        let points = inside.or_else(|| Some(matching(clouds, found.timed.clock())?.entry.path.clone()));
        Self::new(found, points)
    }

    /// Returns the image set; examined once.
    fn set(&self, index: usize, known: &Known) -> Result<Arc<ViewSet>, Arc<PhotosError>> {
        let look = || -> Result<ViewSet, PhotosError> {
            match (&self.images, known) {
                (Images::OfCameras(images), Known::Rig(capture)) => {
                    let listed = capture.rig.listed();
                    let files: Vec<Option<PathBuf>> = listed.map(|at| images.get(at).cloned().flatten()).collect();
                    capture.rig.time_step(&files, index == 0)
                }
                (Images::Listed(photos), Known::Times(calibration, _)) => calibration.some(photos).posed_images(),
                (Images::InFolder(folder), _) => match crate::photos::find(folder)? {
                    Some(found) => found.read(),
                    None => Err(no_set(folder)),
                },
                _ => Err(no_set(&self.entry.path)),
            }
        };
        let with_points = |set: ViewSet| ViewSet {
            points_file: set.points_file.or_else(|| self.points.clone()),
            ..set
        };
        let known = self
            .set
            .get_or_init(|| look().map(with_points).map(Arc::new).map_err(Arc::new));
        known.clone()
    }

    fn image_count(&self) -> usize {
        match &self.images {
            Images::OfCameras(images) => images.iter().flatten().count(),
            Images::InFolder(_) | Images::Listed(_) => 1,
        }
    }

    /// In the order of times or numbers, as far as both have them; the same if they share an image.
    fn is_same_or_before(&self, last: &Self) -> bool {
        let (own, other) = (&self.entry, &last.entry);
        let is_before = match (own.time.zip(other.time), own.number.zip(other.number)) {
            (Some((own, other)), _) => own <= other,
            (None, Some((own, other))) => own <= other,
            _ => false,
        };
        let shares = |of: &Self, with: &Self| match (&of.images, &with.images) {
            (Images::OfCameras(own), Images::OfCameras(other)) => {
                own.iter().zip(other).any(|(own, other)| own.is_some() && own == other)
            }
            (own, other) => own == other,
        };
        is_before || shares(self, last)
    }

    /// Returns true if the time step is complete and no longer being written: all its images are there, or the others
    /// are late.
    fn is_whole(&self, images_of_each: usize) -> bool {
        /// Quiet period after which a file counts as complete: a writer writes the pieces of an image at shorter
        /// intervals.
        const QUIET: Duration = Duration::from_millis(500);
        /// Cameras of one clock are not later than that.
        const LATE: Duration = Duration::from_secs(3);
        let (files, is_complete) = match &self.images {
            Images::OfCameras(images) => (
                images.iter().flatten().cloned().collect(),
                self.image_count() == images_of_each,
            ),
            // The calibration may be written before the images.
            Images::InFolder(folder) => (vec![folder.clone()], false),
            Images::Listed(_) => (Vec::new(), true),
        };
        let min = if is_complete { QUIET } else { LATE };
        let is_old = |path: &PathBuf| {
            let modified = std::fs::metadata(path).and_then(|metadata| metadata.modified());
            // A clock behind the file's says nothing.
            modified.map_or(true, |at| at.elapsed().map_or(true, |age| age >= min))
        };
        files.iter().all(is_old)
    }
}

/// Decoder that computes the points of time steps.
struct TimeStepDecoder {
    known: Arc<Known>,
    time_steps: Arc<RwLock<Vec<Arc<TimeStep>>>>,
    options: OpenOptions,
}

impl Decoder for TimeStepDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        _max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let time_step = read(&self.time_steps).get(index).map(Arc::clone);
        let time_step = time_step.ok_or_else(|| format!("frame {index} does not exist"))?;
        let set = time_step.set(index, &self.known)?;
        let mut cloud = self.cloud(&time_step, &set, progress)?;
        cloud.warnings.extend(set.notes.iter().cloned());
        Ok(cloud.into())
    }
}

impl TimeStepDecoder {
    fn cloud(&self, time_step: &TimeStep, set: &ViewSet, progress: &Progress) -> Result<RawCloud, DecodeFailure> {
        if let Images::InFolder(_) = time_step.images {
            let by_stereo = |set: &ViewSet| self.by_stereo(set, progress);
            return cloud_of_set(set, &self.options, by_stereo, progress);
        }
        if let Some(points) = time_step.points.as_ref().filter(|_| !self.options.dense) {
            return Ok(io::read_part_observed(
                points,
                &Part::Whole,
                &self.options.read,
                progress,
            )?);
        }
        Ok(self.by_stereo(set, progress)?)
    }

    /// Computes points by stereo: from pairs, which is quick, unless dense points were requested; if images are too far
    /// apart for pairs, using many of them may yield more.
    fn by_stereo(&self, set: &ViewSet, progress: &Progress) -> Result<RawCloud, DenseError> {
        let usual = Dense {
            matcher: self.options.matcher.clone(),
            ..Dense::default()
        };
        if self.options.dense {
            return usual.cloud(set, progress);
        }
        let of_pairs = Pairwise {
            matcher: self.options.matcher.clone(),
            ..Pairwise::default()
        };
        match of_pairs.cloud(set, progress) {
            Err(DenseError::Nothing { .. }) => {
                let small = Dense {
                    max_side_px: MAX_SIDE_PX,
                    ..usual
                };
                small.cloud(set, progress)
            }
            found => found,
        }
    }
}

/// Groups the images by time, if a calibration has the capture times of all of them and most times have several images:
/// one camera that goes around has one.
fn time_steps_by_time(calibration: &Calibration) -> Option<Vec<FoundTimeStep>> {
    let times = calibration.times()?;
    let names: Vec<&str> = calibration.names().collect();
    let mut by_time: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    // Non-negative floats have the same order as their bits.
    for (index, &time) in times.iter().enumerate().filter(|(_, time)| **time >= 0.0) {
        by_time.entry((time + 0.0).to_bits()).or_default().push(index);
    }
    let several = by_time.values().filter(|photos| photos.len() > 1).count();
    if by_time.len() < 2 || 2 * several < by_time.len() {
        return None;
    }
    let found = by_time.into_values().enumerate().map(|(at, photos)| {
        let name = photos.first().map_or("", |&first| names[first]);
        FoundTimeStep {
            timed: Timed::at(PathBuf::from(name), at as u64),
            images: Images::Listed(photos),
        }
    });
    Some(found.collect())
}

/// Returns the clouds of time steps in a companion folder of the images, in order.
fn clouds_in(folders: &[PathBuf]) -> Vec<Timed> {
    let all = folders
        .iter()
        .flat_map(|folder| POINT_FOLDERS.iter().map(move |name| folder.join(name)));
    let clouds = all.map(|folder| entries_of(&folder).into_iter().filter(|path| is_cloud(path)).collect());
    let first: Option<Vec<PathBuf>> = clouds.into_iter().find(|clouds: &Vec<PathBuf>| !clouds.is_empty());
    first.and_then(|clouds| timed(vec![clouds]).pop()).unwrap_or_default()
}

/// Returns true if a file among images is a point cloud: text and JSON are calibrations.
fn is_cloud(path: &Path) -> bool {
    let is_text = path.extension().is_some_and(|extension| {
        ["txt", "json", "csv", "bin"]
            .iter()
            .any(|text| extension.eq_ignore_ascii_case(text))
    });
    !is_text && path.is_file() && Format::of_extension(path).is_some()
}

fn no_set(path: &Path) -> PhotosError {
    PhotosError::NoPhotos {
        path: path.to_owned(),
        count: 0,
        reason: "its calibration is gone".to_owned(),
    }
}

#[cfg(test)]
mod tests;
