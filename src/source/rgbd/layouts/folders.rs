//! Folders `depth` and `color` (or `rgb`, `image`), as Redwood, Open3D, RealSense's tools and most scripts write them:
//! the camera in JSON or text, the trajectory in `.log`, JSON or text, or a pose per frame in a folder.

use super::sidecars;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_name;
use crate::source::rgbd::text::{array_shape, arrays};
use crate::source::rgbd::trajectory::{matrix, rigid};
use glam::DAffine3;
use std::path::PathBuf;

pub(super) const LAYOUT: Layout = Layout {
    is_likely,
    ..Layout::new("depth and color folders", find)
};

/// A camera of PrimeSense, which Open3D takes where none is named.
const CAMERA: [f64; 4] = [525.0, 525.0, 319.5, 239.5];

/// Names of folders of depth images.
pub(super) const DEPTH: &[&str] = &[
    "depth",
    "depths",
    "depth_images",
    "aligned_depth",
    "depth_aligned",
    "depth_png",
    "depth_raw",
    "depth_frames",
    "depth_maps",
    "depthmaps",
];

/// Names of folders of colour images.
pub(super) const COLOR: &[&str] = &[
    "color",
    "colour",
    "rgb",
    "image",
    "images",
    "colors",
    "rgb_images",
    "color_aligned",
    "color_images",
    "rgb_png",
];

fn is_likely(folder: &Folder) -> bool {
    folder.sub(DEPTH).is_some() && folder.sub(COLOR).is_some()
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    // Arrays of numpy may be cameras and poses.
    // A folder `depth` alone does not identify a recording: with clouds in it, the folder is opened as clouds.
    let has_clouds = folder.clouds().iter().any(|name| !sidecars::is_known(name));
    let Some(depth) = folder.sub(DEPTH).filter(|_| !has_clouds) else {
        return match stack(folder) {
            Some(refused) => Err(refused),
            None => Ok(None),
        };
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
    let of_arrays = in_arrays(&depths);
    let calibration = match &of_arrays {
        Some((camera, _)) => Some(camera.clone()),
        None => sidecars::camera(folder, &mut notes)?,
    };
    let calibration = calibration.unwrap_or_else(|| Calibration::usual(CAMERA, "PrimeSense, as Open3D takes it"));
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Unknown;
    found.notes.extend(notes);
    match of_arrays {
        Some((_, poses)) if poses.iter().any(Option::is_some) => {
            for (frame, pose) in found.frames.iter_mut().zip(poses) {
                frame.world_from_camera = pose;
            }
            let why = "the arrays `cam2world` next to the depths say so";
            found
                .assumptions
                .push(Assumption::new(Subject::Poses, "camera to world", why, Evidence::File));
        }
        _ => sidecars::take_poses(folder, &mut found)?,
    }
    Ok(Some(found))
}

/// A name with the shape and the numbers of its array.
type NamedNumbers = (String, (Vec<usize>, Vec<f64>));

/// The camera `K` and the poses `cam2world` in archives of depths, where the first has a camera.
fn in_arrays(depths: &[PathBuf]) -> Option<(Calibration, Vec<Option<DAffine3>>)> {
    const CAMERAS: [&str; 4] = ["k", "intrinsics", "intrinsic", "camera_matrix"];
    const POSES: [&str; 5] = ["cam2world", "c2w", "pose", "camera_pose", "cam_pose"];
    if !has_extension(name_of(depths.first()?), &["npz"]) {
        return None;
    }
    let named = |all: &[NamedNumbers], names: &[&str]| {
        let found = all.iter().find(|(name, _)| names.contains(&name.as_str()));
        found.map(|(_, (_, numbers))| numbers.clone())
    };
    let first = arrays(&depths[0]).ok()?;
    let pinhole = Intrinsics::pinhole_of(&named(&first, &CAMERAS)?)?;
    let because = format!("the array of the camera in {}", name_of(&depths[0]));
    let calibration = Calibration::of_depth(Intrinsics::pinhole(pinhole, None), because);
    named(&first, &POSES)?;
    let pose = |path: &PathBuf| rigid(matrix(&named(&arrays(path).ok()?, &POSES)?));
    Some((calibration, depths.iter().map(pose).collect()))
}

/// The refusal of one array with the depths of all frames.
fn stack(folder: &Folder) -> Option<RgbdError> {
    let stacks = folder.files(|name| matches!(name, "depth.npy" | "depths.npy" | "depth_images.npy"));
    let path = stacks.first()?;
    let shape = array_shape(path)?;
    let &[frames, height, width] = shape.as_slice() else {
        return None;
    };
    (frames > 1).then(|| RgbdError::Options {
        reason: format!(
            "{} is a stack of {frames} depth images of {width} × {height} pixels, and one image per file is read: save \
             them as depth/0000.npy and so on, the colours as rgb/0000.png",
            path.display()
        ),
    })
}

fn openexr(depth: &Folder) -> RgbdError {
    RgbdError::NoDepth {
        path: depth.path.clone(),
        looked_for: "its images are OpenEXR, which is not read: convert them to .npy, or to TIFF in floats".to_owned(),
    }
}
