//! ScanNet++ (Yeshwanth et al. 2023): images of an iPhone in `rgb` and `depth`, and `pose_intrinsic_imu.json` with the
//! lens of the colour image (`intrinsic`) and the pose of each frame, `aligned_pose` in the frame of the laser scan.
//! Depth images have the view of colour images, with fewer pixels, in millimetres.

use super::folders::{COLOR, DEPTH};
use super::sidecars::Distinct;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::name_of;
use crate::source::rgbd::pairs::by_name;
use crate::source::rgbd::pose_json;
use crate::source::rgbd::text::read;
use serde_json::Value;
use std::time::Duration;

pub(super) const LAYOUT: Layout = Layout::new("ScanNet++", find);

const NAME: &str = "pose_intrinsic_imu.json";

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let Some(depth) = folder.sub(DEPTH).filter(|_| folder.has_file(NAME)) else {
        return Ok(None);
    };
    let path = folder.path.join(NAME);
    let wrong = |reason: String| RgbdError::Calibration {
        path: path.clone(),
        reason,
    };
    let json: Value = serde_json::from_str(&read(&path)?).map_err(|error| wrong(error.to_string()))?;
    let lens = |frame: &Value| -> Option<Intrinsics> {
        let rows = frame.get("intrinsic")?.as_array()?;
        let numbers = rows.iter().flat_map(|row| row.as_array().into_iter().flatten());
        let numbers: Vec<f64> = numbers.map(Value::as_f64).collect::<Option<_>>()?;
        Some(Intrinsics::pinhole(Intrinsics::pinhole_of(&numbers)?, None))
    };
    let depths = Folder::read(&depth)?.depth_images();
    let colors = match folder.sub(COLOR) {
        Some(color) => Folder::read(&color)?.images(),
        None => Vec::new(),
    };
    let frames = json.as_object();
    let Some(first) = frames.and_then(|frames| frames.values().find_map(lens)) else {
        return Err(wrong(
            "expected `intrinsic`, a matrix of 3 × 3 numbers, for each frame".to_owned(),
        ));
    };
    let pairs = by_name(&depths, &colors);
    let code = DepthCode::per_metre(1000.0);
    let mut found = FoundRecording::of_pairs(depths, pairs, Calibration::of_depth(first, NAME), code);
    found.units = Units::Usual("ScanNet++");
    let mut lenses = Distinct::default();
    for frame in &mut found.frames {
        let name = name_of(frame.depth.path());
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let Some(said) = json.get(stem) else {
            found.notes.push(format!(
                "{NAME} has no entry {stem}: that frame has no pose and the lens of the first"
            ));
            continue;
        };
        if let Some(lens) = lens(said) {
            frame.calibration = lenses.shared(Calibration::of_depth(lens, NAME));
        }
        frame.world_from_camera = pose_json::pose(said).flatten();
        let seconds = said.get("timestamp").and_then(Value::as_f64);
        frame.time = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    }
    if found.pose_count() > 0 {
        let why = format!("the poses of {NAME} lead so");
        found.assumptions.push(Assumption::new(
            Subject::Poses,
            "camera to world",
            why,
            Evidence::Convention,
        ));
    }
    Ok(Some(found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn each_frame_has_its_lens_and_its_aligned_pose() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("depth")).unwrap();
        fs::write(folder.path().join("depth/frame_000010.png"), b"").unwrap();
        let pose = |x: f64| format!("[[1,0,0,{x}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]");
        let text = format!(
            r#"{{"frame_000010": {{"timestamp": 1.5, "pose": {}, "aligned_pose": {},
            "intrinsic": [[140,0,79.5],[0,141,59.5],[0,0,1]]}}}}"#,
            pose(1.0),
            pose(2.0)
        );
        fs::write(folder.path().join(NAME), text).unwrap();
        let found = find(&Folder::read(folder.path()).unwrap()).unwrap().unwrap();
        let frame = &found.frames[0];
        assert_eq!(frame.world_from_camera.unwrap().translation.x, 2.0);
        assert_eq!(frame.calibration.depth.focal_px.y, 141.0);
        assert_eq!(frame.time, Some(Duration::from_millis(1500)));
    }
}
