//! Calibrated images as a sequence of one frame: the sparse points from their calibration, or dense ones computed from
//! them by stereo.
//!
//! The frame is an ordinary cloud, so everything that works with clouds works with it. Callers that need the images as
//! well use [`HasPosedImages::posed_images`].

use super::{About, Capabilities, DecodeFailure, Decoder, FrameEntry, HasPosedImages, OpenOptions, Source};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{Positions, RawCloud};
use crate::io::{self, Part};
use crate::photos::ViewSet;
use crate::progress::Progress;
use crate::stereo::{Dense, DenseError};
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Clouds that dense stages make next to a sparse model: COLMAP's, OpenMVS's, PMVS's.
const DENSE_CLOUDS: &[&str] = &[
    "fused.ply",
    "dense/fused.ply",
    "dense/0/fused.ply",
    "scene_dense.ply",
    "openmvs/scene_dense.ply",
    "mvs/scene_dense.ply",
    "dense/scene_dense.ply",
    "pmvs/models/option-0000.ply",
    "models/option-0000.ply",
];

/// Maximum number of images that are matched at full size, up to 640 pixels.
const MAX_OF_WHOLE_SIZE: usize = 8;

/// Posed images of one scene.
#[derive(Debug)]
pub struct PhotoScene {
    set: Arc<ViewSet>,
    entry: Arc<FrameEntry>,
    inputs: Vec<PathBuf>,
    options: OpenOptions,
    assumptions: Vec<Assumption>,
}

impl PhotoScene {
    /// Creates the scene from the images of the folder or file that is the one input.
    ///
    /// A dense cloud of a folder takes precedence over its sparse points: `found` is where these are.
    pub(super) fn of(mut set: ViewSet, found: &Path, input: &Path, options: &OpenOptions) -> Self {
        set.dense_file = if options.dense { None } else { dense_cloud(input, found) };
        let model = found.to_string_lossy();
        let sparse = if input == found { "its file of images" } else { &*model };
        let assumptions = set.dense_file.iter().map(|dense| chosen_dense(dense, &set, sparse));
        let assumptions: Vec<Assumption> = assumptions.collect();
        let file = set.dense_file.as_deref().or(set.points_file.as_deref());
        Self {
            entry: Arc::new(FrameEntry::file(file.unwrap_or(input))),
            set: Arc::new(set),
            inputs: vec![input.to_owned()],
            options: options.clone(),
            assumptions,
        }
    }
}

impl Source for PhotoScene {
    fn frames(&self) -> Range<usize> {
        0..1
    }

    fn entry(&self, _index: usize) -> Arc<FrameEntry> {
        Arc::clone(&self.entry)
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        let (set, options) = (Arc::clone(&self.set), self.options.clone());
        let dense = dense_of(&set, &options);
        Box::new(move |_: &FrameEntry, progress: &Progress| {
            cloud_of_set(&set, &options, |set| dense.cloud(set, progress), progress)
        })
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            assumptions: &self.assumptions,
            notes: &self.set.notes,
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            posed_images: Some(self),
            ..Capabilities::default()
        }
    }
}

impl HasPosedImages for PhotoScene {
    fn posed_images(&self, _index: usize) -> Option<Arc<ViewSet>> {
        (!self.set.photos.is_empty()).then(|| Arc::clone(&self.set))
    }
}

/// Returns the cloud that a dense reconstruction stage computed from the images of the folder `input`, whose model is
/// at `found`.
fn dense_cloud(input: &Path, found: &Path) -> Option<PathBuf> {
    // Opening a file of the model means wanting its points.
    if !input.is_dir() {
        return None;
    }
    // With several models each has its own dense folder.
    let number = found.file_name()?.to_str().filter(|name| name.parse::<u32>().is_ok());
    let of_model = number.map(|number| format!("dense/{number}/fused.ply"));
    let names = of_model.iter().map(String::as_str).chain(DENSE_CLOUDS.iter().copied());
    let mut files = names.map(|name| input.join(name));
    files.find(|path| path.is_file())
}

fn chosen_dense(dense: &Path, set: &ViewSet, sparse: &str) -> Assumption {
    let why = format!(
        "it is denser than the {} SfM points: open {sparse} for those",
        set.points.len()
    );
    Assumption::new(Subject::Frames, dense.display().to_string(), why, Evidence::Convention).with_option(None)
}

/// Returns the dense stereo settings. Large image sets are halved once more if dense points were not requested: 47
/// images of 640×480 would take minutes.
fn dense_of(set: &ViewSet, options: &OpenOptions) -> Dense {
    let usual = Dense {
        matcher: options.matcher.clone(),
        ..Dense::default()
    };
    if options.dense || set.photos.len() <= MAX_OF_WHOLE_SIZE {
        return usual;
    }
    Dense {
        max_side_px: usual.max_side_px / 2,
        ..usual
    }
}

/// The sparse points of a set, or of the file that it names; where there are none, and where dense ones are wanted,
/// those that are found `by_stereo`.
pub(super) fn cloud_of_set(
    set: &ViewSet,
    options: &OpenOptions,
    by_stereo: impl FnOnce(&ViewSet) -> Result<RawCloud, DenseError>,
    progress: &Progress,
) -> Result<RawCloud, DecodeFailure> {
    let points = &set.points;
    let mut warnings = Vec::new();
    if let Some(file) = set.dense_file.as_ref().filter(|_| !options.dense) {
        match io::read_part_observed(file, &Part::Whole, &options.read, progress) {
            Ok(cloud) => return Ok(cloud),
            Err(error) if points.is_empty() => return Err(error.into()),
            Err(error) => warnings.push(format!("{error}; the SfM points are shown")),
        }
    }
    let file = set.points_file.as_ref().filter(|_| points.is_empty());
    if options.dense || !set.has_points() {
        return Ok(by_stereo(set)?);
    }
    if let Some(file) = file {
        return Ok(io::read_part_observed(file, &Part::Whole, &options.read, progress)?);
    }
    let positions = points.positions().iter().map(DVec3::to_array);
    let mut cloud = RawCloud::from_positions(Positions::F64(positions.collect()));
    let colors = points
        .colors()
        .iter()
        .map(|&[red, green, blue]| [red, green, blue, 255]);
    cloud.warnings = warnings;
    cloud.attributes.colors = Some(colors.collect());
    cloud.attributes.normals = points
        .normals()
        .map(|normals| normals.iter().map(Vec3::to_array).collect());
    Ok(cloud)
}
