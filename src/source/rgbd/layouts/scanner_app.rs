//! 3D Scanner App, an app of iPhones with LiDAR ("All Data"): `frame_00000.json`, `frame_00000.jpg` and
//! `depth_00000.png` in millimetres, by their numbers.
//!
//! The JSON has the lens of the colour image (`intrinsics`, nine numbers by rows) and the pose of `ARKit`
//! (`cameraPoseARFrame`, sixteen by rows), whose camera has x right, y up and z backward. Depth images have the view of
//! colour images, with fewer pixels; images without depths are more frequent and have none.

use super::sidecars::Distinct;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::{has_extension, is_image, name_of};
use crate::source::rgbd::pairs::by_name;
use crate::source::rgbd::text::read;
use crate::source::rgbd::trajectory::{matrix, of_backward, rigid};
use glam::DAffine3;
use serde_json::Value;
use std::path::Path;
use std::time::Duration;

pub(super) const LAYOUT: Layout = Layout::new("3D Scanner App", find);

#[expect(clippy::unnecessary_wraps, reason = "other layouts may fail")]
fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let depths = folder.files(|name| name.starts_with("depth_") && is_image(name));
    let infos = folder.files(|name| name.starts_with("frame_") && has_extension(name, &["json"]));
    if depths.is_empty() || infos.is_empty() {
        return Ok(None);
    }
    let colors = folder.files(|name| name.starts_with("frame_") && is_image(name));
    let mut pairs = by_name(&depths, &colors);
    // The video has more images than the depth camera.
    pairs
        .notes
        .retain(|note| !note.contains("colour images have no depth image"));
    let infos = by_name(&depths, &infos).colors;
    let read: Vec<Option<Info>> = infos
        .iter()
        .map(|path| path.as_ref().and_then(|path| Info::read(path).ok()))
        .collect();
    let Some(first) = read.iter().flatten().next() else {
        return Ok(None);
    };
    let calibration = first.calibration();
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Usual("3D Scanner App");
    let mut lenses = Distinct::default();
    for ((frame, path), info) in found.frames.iter_mut().zip(&infos).zip(&read) {
        let Some(info) = info else {
            let name = path.as_deref().map_or("its JSON", name_of);
            let depth = name_of(frame.depth.path());
            found.notes.push(format!(
                "{depth} has no pose and the lens of the first frame: {name} is missing or tells none"
            ));
            continue;
        };
        frame.time = info.time;
        frame.world_from_camera = info.pose;
        frame.calibration = lenses.shared(info.calibration());
    }
    Ok(Some(found))
}

/// Contents of a frame's JSON file.
struct Info {
    /// Lens parameters of the colour image.
    lens: [f64; 4],
    pose: Option<DAffine3>,
    time: Option<Duration>,
}

impl Info {
    fn read(path: &Path) -> Result<Self, RgbdError> {
        let text = read(path)?;
        let wrong = |reason: &str| RgbdError::Calibration {
            path: path.to_owned(),
            reason: reason.to_owned(),
        };
        let json: Value = serde_json::from_str(&text).map_err(|error| wrong(&error.to_string()))?;
        let numbers = |key: &str| -> Option<Vec<f64>> {
            let list = json.get(key)?.as_array()?;
            list.iter().map(Value::as_f64).collect()
        };
        let intrinsics = numbers("intrinsics").ok_or_else(|| wrong("`intrinsics` is missing"))?;
        let lens = Intrinsics::pinhole_of(&intrinsics).ok_or_else(|| wrong("`intrinsics` has not nine numbers"))?;
        let pose = numbers("cameraPoseARFrame").and_then(|pose| rigid(matrix(&pose)));
        let seconds = json.get("time").and_then(Value::as_f64);
        Ok(Self {
            lens,
            pose: pose.map(of_backward),
            time: seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
        })
    }

    /// Returns the calibration of the depth image, at the size of the colour image: both show the same field of view.
    fn calibration(&self) -> Calibration {
        Calibration::of_depth(Intrinsics::pinhole(self.lens, None), "the JSON of each frame")
    }
}
