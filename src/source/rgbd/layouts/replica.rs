//! Renderings of Replica (Straub et al. 2019) as NICE-SLAM (Zhu et al. 2022) has them, and who follows it:
//! `results/depth000000.png` and `frame000000.jpg`, `traj.txt` with a matrix per line, and `cam_params.json` with the
//! camera and the units of depths, next to it or in the folder around.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::{has_extension, is_image, name_of};
use crate::source::rgbd::pairs::by_name;
use std::path::PathBuf;

pub(super) const LAYOUT: Layout = Layout {
    is_likely,
    ..Layout::new("Replica", find)
};

/// Camera intrinsics for images of 1200 × 680.
const CAMERA: [f64; 4] = [600.0, 600.0, 599.5, 339.5];

/// Ten metres are the whole range of 16 bits.
const UNITS_PER_METRE: f64 = 6553.5;

fn is_likely(folder: &Folder) -> bool {
    folder.sub(&["results"]).is_some() && folder.has_file("traj.txt")
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let results = folder.sub(&["results"]).map(|path| Folder::read(&path)).transpose()?;
    let images = results.as_ref().unwrap_or(folder);
    let numbered = |begins: &'static [&'static str]| {
        move |name: &str| {
            let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
            begins.iter().any(|begin| {
                let digits = stem.strip_prefix(begin).unwrap_or_default();
                !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
            })
        }
    };
    let depths = images.files(|name| numbered(&["depth"])(name) && (is_image(name) || has_extension(name, &["npy"])));
    let colors = images.files(|name| numbered(&["frame", "rgb", "color"])(name) && is_image(name));
    // The image folder itself may be opened.
    let around = images.path.join("..");
    let sidecars = |name: &str| -> Option<PathBuf> {
        let places = [
            folder.path.join(name),
            around.join(name),
            folder.path.join("..").join(name),
        ];
        places.into_iter().find(|path| path.is_file())
    };
    let trajectory = sidecars("traj.txt");
    let is_replica = !depths.is_empty() && (trajectory.is_some() || results.is_some());
    if !is_replica {
        return Ok(None);
    }
    let pairs = by_name(&depths, &colors);
    let calibration = match sidecars("cam_params.json") {
        Some(camera) => Calibration::read(&camera)?,
        None => Calibration {
            is_assumed: true,
            ..Calibration::of_depth(
                Intrinsics::pinhole(CAMERA, Some([1200, 680])),
                "the usual camera of Replica's renderings",
            )
        },
    };
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(UNITS_PER_METRE));
    found.units = Units::Usual("Replica");
    match trajectory {
        Some(path) => {
            found.take_trajectory(&path);
        }
        None => found.notes.push(format!(
            "traj.txt is not next to {}: frames have no poses",
            name_of(&images.path)
        )),
    }
    Ok(Some(found))
}
