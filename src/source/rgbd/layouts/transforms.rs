//! Layout of `transforms.json` from nerfstudio, instant-ngp, Polycam and `Record3D` whose frames have depth images
//! (`depth_file_path`).
//!
//! Matrices map from the camera to the world; the camera has x right, y up and z backward (OpenGL). The corner of an
//! image is at 0, so the centre of the first pixel is at ½. Depths are whole millimetres, unless
//! `depth_unit_scale_factor` or `integer_depth_scale` says otherwise, and metres in floats. Frames of several time
//! steps (`time`) are multi-view video.

use super::sidecars::{Distinct, TRANSFORMS as NAME};
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::messages::grouped;
use crate::rgbd::Distortion;
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::name_of;
use crate::source::rgbd::pairs::Pairs;
use crate::source::rgbd::pose_json;
use crate::source::rgbd::text::read;
use serde_json::Value;
use std::path::PathBuf;

pub(super) const LAYOUT: Layout = Layout::new("transforms.json with depth images", find);

/// Units of whole numbers per metre, unless the file says otherwise.
const UNITS_PER_METRE: f64 = 1000.0;

/// Returns true if the frames of `transforms.json` in `folder` have depth images.
pub(super) fn has_depths(folder: &Folder) -> bool {
    matches!(frames_of(folder), Some((_, frames)) if !frames.is_empty())
}

/// A frame, and the files that it names.
struct Frame {
    json: Value,
    depth: PathBuf,
    color: Option<PathBuf>,
}

/// The file and its frames with a depth image that exists, if most have one and none has a time.
fn frames_of(folder: &Folder) -> Option<(Value, Vec<Frame>)> {
    if !folder.has_file(NAME) {
        return None;
    }
    let json: Value = serde_json::from_str(&read(&folder.path.join(NAME)).ok()?).ok()?;
    let listed = json.get("frames")?.as_array()?;
    if listed.iter().any(|frame| frame.get("time").is_some()) {
        return None;
    }
    let existing = |frame: &Value, key: &str| {
        let name = frame.get(key)?.as_str()?.replace('\\', "/");
        let path = folder.path.join(name);
        path.is_file().then_some(path)
    };
    let with_depth = listed.iter().filter_map(|frame| {
        let depth = existing(frame, "depth_file_path").or_else(|| existing(frame, "depth_path"))?;
        Some(Frame {
            json: frame.clone(),
            depth,
            color: existing(frame, "file_path"),
        })
    });
    let frames: Vec<Frame> = with_depth.collect();
    (2 * frames.len() > listed.len()).then_some((json, frames))
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let Some((json, frames)) = frames_of(folder) else {
        return Ok(None);
    };
    let listed = json.get("frames").and_then(Value::as_array).map_or(0, Vec::len);
    let mut lenses = Distinct::default();
    let mut cameras = Vec::with_capacity(frames.len());
    for frame in &frames {
        let lens = lens(&json, &frame.json).map_err(|reason| RgbdError::Calibration {
            path: folder.path.join(NAME),
            reason,
        })?;
        cameras.push(lenses.shared(Calibration::of_depth(lens, NAME)));
    }
    let depths = frames.iter().map(|frame| frame.depth.clone()).collect();
    let pairs = Pairs {
        colors: frames.iter().map(|frame| frame.color.clone()).collect(),
        notes: Vec::new(),
    };
    let number = |key: &str| json.get(key).and_then(Value::as_f64).filter(|scale| *scale > 0.0);
    let scale = number("depth_unit_scale_factor").or_else(|| number("integer_depth_scale"));
    let units_per_metre = scale.map_or(UNITS_PER_METRE, |scale| tidy(scale.recip()));
    let first = Calibration::clone(&cameras[0]);
    let code = DepthCode::per_metre(units_per_metre);
    let mut found = FoundRecording::of_pairs(depths, pairs, first, code);
    if scale.is_some() {
        found.units = Units::Certain;
        let value = format!("{units_per_metre} units per metre");
        let why = format!("{NAME} says so");
        found
            .assumptions
            .push(Assumption::new(Subject::DepthScale, value, why, Evidence::File));
    } else {
        found.units = Units::Usual("nerfstudio");
    }
    for ((frame, camera), listed) in found.frames.iter_mut().zip(cameras).zip(&frames) {
        frame.calibration = camera;
        frame.world_from_camera = pose_json::pose(&listed.json).flatten();
    }
    if found.pose_count() > 0 {
        let why = format!("the matrices of {NAME} lead so, with y up and z backward in the camera");
        found.assumptions.push(Assumption::new(
            Subject::Poses,
            "camera to world",
            why,
            Evidence::Convention,
        ));
    }
    if frames.len() < listed {
        found.notes.push(format!(
            "{} of {} frames of {} name no depth image that exists: they are skipped",
            grouped(listed - frames.len()),
            grouped(listed),
            name_of(&folder.path.join(NAME))
        ));
    }
    Ok(Some(found))
}

/// 1 / 0.001 is not quite 1000.
fn tidy(units: f64) -> f64 {
    let whole = units.round();
    if (units / whole - 1.0).abs() < 1e-9 {
        whole
    } else {
        units
    }
}

/// The lens of `frame`, from its own keys or from the file's.
fn lens(file: &Value, frame: &Value) -> Result<Intrinsics, String> {
    let at = |key: &str| {
        let value = frame.get(key).or_else(|| file.get(key))?;
        value.as_f64().filter(|number| number.is_finite())
    };
    let edge = |key: &str| at(key).filter(|edge| (1.0..65_536.0).contains(edge));
    let size = edge("w").zip(edge("h"));
    let of_angle = |key: &str, edge: Option<f64>| Some(edge? / 2.0 / (at(key)? / 2.0).tan());
    let focal = at("fl_x").or_else(|| of_angle("camera_angle_x", size.map(|(width, _)| width)));
    let Some(fx) = focal else {
        return Err("it has no focal length: expected fl_x, or w and camera_angle_x".to_owned());
    };
    let fy = at("fl_y").or_else(|| of_angle("camera_angle_y", size.map(|(_, height)| height)));
    let principal = at("cx").zip(at("cy"));
    let Some((cx, cy)) = principal.or_else(|| size.map(|(width, height)| (width / 2.0, height / 2.0))) else {
        return Err("it has no principal point: expected cx and cy, or w and h".to_owned());
    };
    let numbers = [fx, fy.unwrap_or(fx), cx - 0.5, cy - 0.5];
    let size_px = size.map(|(width, height)| [width as u32, height as u32]);
    let number = |key: &str| at(key).unwrap_or(0.0);
    let is_fisheye = file.get("is_fisheye").and_then(Value::as_bool) == Some(true)
        || file.get("camera_model").and_then(Value::as_str) == Some("OPENCV_FISHEYE");
    let (k, p) = (["k1", "k2", "k3", "k4"].map(number), ["p1", "p2"].map(number));
    let distortion = match (is_fisheye, k, p) {
        (true, k, _) => Distortion::Fisheye { k },
        (false, [0.0, 0.0, 0.0, _], [0.0, 0.0]) => Distortion::None,
        (false, [k1, k2, k3, _], p) => Distortion::Brown { k: [k1, k2, k3], p },
    };
    Ok(Intrinsics {
        distortion,
        ..Intrinsics::pinhole(numbers, size_px)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// A folder of two frames, with these keys of the file.
    fn folder(keys: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let frame = |index: usize| {
            let name = format!("depths/{index}.png");
            let path = folder.path().join(&name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"").unwrap();
            format!(
                r#"{{"file_path": "images/{index}.png", "depth_file_path": "{name}",
                "transform_matrix": [[1,0,0,{index}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}"#
            )
        };
        let frames = [frame(0), frame(1)].join(",");
        let text = format!(
            r#"{{"fl_x": 140, "fl_y": 141, "cx": 80, "cy": 60, "w": 160, "h": 120, {keys}
            "frames": [{frames}]}}"#
        );
        fs::write(folder.path().join(NAME), text).unwrap();
        folder
    }

    fn found(folder: &tempfile::TempDir) -> Option<FoundRecording> {
        find(&Folder::read(folder.path()).unwrap()).unwrap()
    }

    #[test]
    fn frames_with_depths_have_lens_pose_and_scale() {
        let recording = found(&folder(r#""integer_depth_scale": 0.0002,"#)).unwrap();
        assert_eq!(recording.code.units_per_metre(), Some(5000.0));
        let frame = &recording.frames[1];
        let pose = frame.world_from_camera.unwrap();
        assert_eq!(pose.translation, glam::DVec3::X);
        assert_eq!(pose.transform_vector3(glam::DVec3::Z), glam::DVec3::NEG_Z);
        let lens = &frame.calibration.depth;
        assert_eq!(lens.principal_px, glam::DVec2::new(79.5, 59.5));
        assert_eq!((lens.focal_px.y, lens.for_size_px), (141.0, Some([160, 120])));
        assert_eq!(found(&folder("")).unwrap().code.units_per_metre(), Some(1000.0));
    }

    #[test]
    fn images_without_depths_are_not_an_rgbd_recording() {
        let folder = folder("");
        fs::remove_dir_all(folder.path().join("depths")).unwrap();
        assert!(found(&folder).is_none());
    }
}
