//! Layout of PCL's grabbers: `frame_20121214T142255.814212_depth.tiff` or `.pclzf`, `…_rgb` next to it, and XML with
//! the camera, in the same folder or the one around it.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::io::files::timestamps::times_of_names;
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_key;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) const LAYOUT: Layout = Layout::new("PCL", find);

const CAMERA: [f64; 4] = [525.0, 525.0, 320.0, 240.0];

/// Suffixes of the names of depth and colour images, before their extensions.
const DEPTH: &[&str] = &["_depth"];
const COLOR: &[&str] = &["_rgb", "_color", "_yuv422"];

/// The part of `name` before one of `ends` and the extension.
fn time_step<'a>(name: &'a str, ends: &[&str]) -> Option<&'a str> {
    let (stem, _) = name
        .rsplit_once('.')
        .filter(|_| has_extension(name, &["tiff", "tif", "pclzf"]))?;
    ends.iter().find_map(|end| stem.strip_suffix(end))
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let depths = folder.files(|name| time_step(name, DEPTH).is_some());
    if depths.is_empty() {
        return Ok(None);
    }
    let colors = folder.files(|name| time_step(name, COLOR).is_some());
    let both = [DEPTH, COLOR].concat();
    let pairs = by_key(&depths, &colors, |name| time_step(name, &both).map(str::to_owned));
    let time_steps: Vec<String> = depths
        .iter()
        .filter_map(|path| time_step(name_of(path), DEPTH).map(str::to_owned))
        .collect();
    let usual = Calibration::usual(CAMERA, "PCL's grabbers");
    let mut found = FoundRecording::of_pairs(depths, pairs, usual, DepthCode::per_metre(1000.0));
    found.units = Units::Usual("PCL's grabbers");
    // The whole name gives the time: with `_depth`, that would be its end.
    let names: Vec<String> = time_steps.iter().map(|time_step| format!("{time_step}.pcd")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut cameras = Cameras::of(folder);
    for ((frame, time_step), time) in found.frames.iter_mut().zip(&time_steps).zip(times_of_names(&names)) {
        frame.time = time;
        if let Some(camera) = cameras.of_time_step(time_step)? {
            frame.calibration = camera;
        }
    }
    Ok(Some(found))
}

/// The files with cameras, and those that were read.
struct Cameras {
    folders: Vec<PathBuf>,
    /// One for each camera, however many files say it.
    known: Vec<Arc<Calibration>>,
}

impl Cameras {
    fn of(folder: &Folder) -> Self {
        let own = folder.path.clone();
        let around = folder.path.join("..");
        Self {
            folders: vec![own, around],
            known: Vec::new(),
        }
    }

    fn of_time_step(&mut self, time_step: &str) -> Result<Option<Arc<Calibration>>, RgbdError> {
        let file = format!("{time_step}.xml");
        let path = self
            .folders
            .iter()
            .map(|folder| folder.join(&file))
            .find(|path| Path::is_file(path));
        let Some(path) = path else { return Ok(None) };
        let read = Calibration::read(&path)?;
        let is_same = |known: &&Arc<Calibration>| {
            known.depth == read.depth && known.color == read.color && known.units_per_metre == read.units_per_metre
        };
        if let Some(known) = self.known.iter().find(is_same) {
            return Ok(Some(Arc::clone(known)));
        }
        let read = Arc::new(read);
        self.known.push(Arc::clone(&read));
        Ok(Some(read))
    }
}
