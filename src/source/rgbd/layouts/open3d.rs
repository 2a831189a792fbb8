//! Redwood and Open3D: folders `depth` and `color`, the camera in JSON, the trajectory in `.log` or JSON.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Trajectory};
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_name;
use std::path::PathBuf;

pub(super) const LAYOUT: Layout = Layout { name: "Open3D", find };

/// A camera of PrimeSense, which Open3D takes where none is named.
const CAMERA: [f64; 4] = [525.0, 525.0, 319.5, 239.5];

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let Some(depth) = folder.sub(&["depth"]).filter(|_| !folder.has_clouds()) else {
        return Ok(None);
    };
    let depths = Folder::read(&depth)?.images();
    if depths.is_empty() {
        return Ok(None);
    }
    let colors = match folder.sub(&["color", "colour", "rgb", "image", "images"]) {
        Some(color) => Folder::read(&color)?.images(),
        None => Vec::new(),
    };
    let pairs = by_name(&depths, &colors);
    let cameras = folder.files(|name| has_extension(name, &["json"]) && !is_trajectory(name));
    let mut notes = Vec::new();
    let calibration = match cameras.as_slice() {
        [] => Calibration::usual(CAMERA, "PrimeSense, as Open3D takes it"),
        [camera] => Calibration::read(camera)?,
        cameras => {
            let chosen = cameras.iter().find(|path| {
                let name = name_of(path).to_ascii_lowercase();
                name.contains("intrinsic") || name.contains("camera")
            });
            let chosen = chosen.unwrap_or(&cameras[0]);
            notes.push(format!(
                "of {} files of JSON, {} is read for the camera",
                cameras.len(),
                chosen.display()
            ));
            Calibration::read(chosen)?
        }
    };
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.notes.extend(notes);
    if let Some(path) = trajectory(folder) {
        found.take_poses(&Trajectory::read(&path)?);
    }
    Ok(Some(found))
}

fn is_trajectory(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ["trajectory", "pose", "odometry", "fragment"]
        .iter()
        .any(|word| name.contains(word))
}

/// Odometry leads from frame to frame and drifts; it is a trajectory only where nothing better is.
fn trajectory(folder: &Folder) -> Option<PathBuf> {
    let named = |word: &'static str| {
        move |name: &str| has_extension(name, &["log", "json"]) && name.to_ascii_lowercase().contains(word)
    };
    let words = ["trajectory", "pose", "odometry"];
    words
        .into_iter()
        .find_map(|word| folder.files(named(word)).into_iter().next())
}
