//! Folders `depth` and `color` (or `rgb`, `image`), as Redwood, Open3D, RealSense's tools and most scripts write them:
//! the camera in JSON or text, the trajectory in `.log`, JSON or text, or a pose per frame in a folder.

use super::beside;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::folder::has_extension;
use crate::source::rgbd::pairs::by_name;

pub(super) const LAYOUT: Layout = Layout {
    name: "depth and color folders",
    find,
};

/// A camera of PrimeSense, which Open3D takes where none is named.
const CAMERA: [f64; 4] = [525.0, 525.0, 319.5, 239.5];

/// Names of folders of depth images.
pub(super) const DEPTH: &[&str] = &["depth", "depths", "depth_images", "aligned_depth"];

/// Names of folders of colour images.
pub(super) const COLOR: &[&str] = &["color", "colour", "rgb", "image", "images", "colors", "rgb_images"];

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    // Arrays of numpy may be cameras and poses.
    let has_clouds = folder.clouds().iter().any(|name| !beside::is_known(name));
    let Some(depth) = folder.sub(DEPTH).filter(|_| !has_clouds) else {
        return Ok(None);
    };
    let depth = Folder::read(&depth)?;
    let depths = depth.depth_images();
    if depths.is_empty() {
        let has_openexr = !depth.files(|name| has_extension(name, &["exr"])).is_empty();
        return if has_openexr { Err(openexr(&depth)) } else { Ok(None) };
    }
    let colors = match folder.sub(COLOR) {
        Some(color) => Folder::read(&color)?.images(),
        None => Vec::new(),
    };
    let pairs = by_name(&depths, &colors);
    let mut notes = Vec::new();
    let calibration = beside::camera(folder, &mut notes)?;
    let calibration = calibration.unwrap_or_else(|| Calibration::usual(CAMERA, "PrimeSense, as Open3D takes it"));
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Unknown;
    found.notes.extend(notes);
    beside::take_poses(folder, &mut found)?;
    Ok(Some(found))
}

fn openexr(depth: &Folder) -> RgbdError {
    RgbdError::NoDepth {
        path: depth.path.clone(),
        looked_for: "its images are OpenEXR, which is not read: convert them to .npy, or to TIFF in floats".to_owned(),
    }
}
