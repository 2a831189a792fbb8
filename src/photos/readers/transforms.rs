//! `transforms.json` of instant-ngp, nerfstudio and the synthetic sets of NeRF.
//!
//! *How it works.* Each frame has a camera-to-world matrix, whose camera has x right, y up and z backward (OpenGL).
//! Intrinsics (`fl_x fl_y cx cy w h`, or a field of view: `camera_angle_x` in radians, `x_fov` in degrees, or the same
//! for y) are the file's unless a frame has its own. The corner of the image is at 0, so the centre of the first pixel
//! is at ½: both programs cast the ray of a pixel through it. Names may lack their extension. A frame without its file
//! is skipped with a note. There are no points, but nerfstudio may name a point cloud file (`ply_file_path`).

use super::reader::{Claim, Reader};
use crate::photos::depth_file::{DepthFile, DepthKind};
use crate::photos::error::PhotosError;
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::json::{array_at, number, number_at, read as read_json, side};
use crate::photos::sets::lens::{Focal, Lens, Origin};
use crate::rgbd::Distortion;
use glam::{DMat3, DVec2, DVec3};
use serde_json::Value;
use std::path::Path;

/// Metres in a unit of nerfstudio's depth images, unless the file says otherwise.
const USUAL_DEPTH_SCALE: f64 = 1e-3;

/// Keys of instant-ngp by which a lens is neither a pinhole nor one of OpenCV.
const OTHER_LENSES: &[&str] = &["ftheta_p0", "latlong", "lonlat", "equirectangular", "orthographic"];

/// Returns true if a file that begins with `head` is a `transforms.json`.
fn is_transforms(head: &str) -> bool {
    head.contains("\"transform_matrix\"") || (head.contains("\"frames\"") && head.contains("\"file_path\""))
}

/// File names looked for, the training images first: other images of the same scene are in files next to it.
const FILES: &[&str] = &[
    "transforms.json",
    "transforms_train.json",
    "transforms_test.json",
    "transforms_val.json",
];

/// instant-ngp, nerfstudio and NeRF.
pub(super) const READER: Reader = Reader {
    name: "transforms.json",
    in_folder: |folder| folder.first(FILES),
    of_file: |file| {
        let is_one = file.extension() == "json" && is_transforms(&file.head()?);
        Ok(is_one.then(|| Claim::certain(file.path)))
    },
    read,
};

/// Reads the posed images of the file `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let file = read_json(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut drafts = Drafts::new(path, vec![folder.clone()]);
    for frame in array_at(&file, "frames") {
        drafts.photos.push(draft(&file, frame, &folder));
    }
    if drafts.photos.is_empty() {
        return Err(PhotosError::invalid(
            path,
            "frames",
            "expected a list of images, found none",
        ));
    }
    let points = file
        .get("ply_file_path")
        .and_then(Value::as_str)
        .map(|points| folder.join(points));
    match points {
        Some(points) if points.is_file() => drafts.points_file = Some(points),
        Some(points) => drafts.notes.push(format!("no points: {} is missing", points.display())),
        None => {}
    }
    Ok(drafts)
}

fn draft(file: &Value, frame: &Value, folder: &Path) -> Draft {
    let text = |key: &str| frame.get(key).and_then(Value::as_str);
    let existing = |key: &str| {
        let path = folder.join(text(key)?.replace('\\', "/"));
        path.is_file().then_some(path)
    };
    let name = text("file_path").unwrap_or_default().to_owned();
    let (axes, center) = pose(frame).unwrap_or((DMat3::NAN, DVec3::NAN));
    let scale = number_at(file, "depth_unit_scale_factor").or_else(|| number_at(file, "integer_depth_scale"));
    Draft {
        mask: existing("mask_path"),
        depth: existing("depth_file_path")
            .or_else(|| existing("depth_path"))
            .map(|path| DepthFile {
                path,
                kind: DepthKind::Scaled(scale.unwrap_or(USUAL_DEPTH_SCALE)),
                taken_by: None,
            }),
        time: number_at(frame, "time").filter(|time| time.is_finite()),
        ..Draft::at(name, lens(file, frame), axes, center)
    }
}

/// The axes of the camera (x right, y down, z forward) as columns, of length 1, and its centre.
fn pose(frame: &Value) -> Option<(DMat3, DVec3)> {
    // `applied_transform` is not applied: it maps from COLMAP's world to the file's, in which points and cameras
    // already are.
    let rows = array_at(frame, "transform_matrix");
    let row = |row: usize| {
        let numbers: Vec<f64> = rows.get(row)?.as_array()?.iter().map_while(number).collect();
        <[f64; 4]>::try_from(numbers).ok()
    };
    let [x, y, z] = [row(0)?, row(1)?, row(2)?];
    let column = |at: usize| DVec3::new(x[at], y[at], z[at]);
    let axes = DMat3::from_cols(column(0), -column(1), -column(2));
    // Scenes are scaled to fit a cube, by some programs including the axes.
    let scale = axes.determinant().abs().cbrt();
    let axes = if scale > 0.0 { axes * scale.recip() } else { axes };
    Some((axes, column(3)))
}

fn lens(file: &Value, frame: &Value) -> Result<Lens, String> {
    let at = |key: &str| number_at(frame, key).or_else(|| number_at(file, key));
    let size_px = Option::zip(at("w").and_then(side), at("h").and_then(side)).map(|(width, height)| [width, height]);
    let angle = |radians: &str, degrees: &str| at(radians).or_else(|| at(degrees).map(f64::to_radians));
    let focal = if let Some(x) = at("fl_x").or_else(|| at("fl_y")) {
        Focal::Pixels(DVec2::new(x, at("fl_y").unwrap_or(x)))
    } else if let Some(angle) = angle("camera_angle_x", "x_fov") {
        Focal::WidthAngle(angle)
    } else if let Some(angle) = angle("camera_angle_y", "y_fov") {
        Focal::HeightAngle(angle)
    } else {
        return Err("it has no focal length: expected fl_x or camera_angle_x".into());
    };
    let principal = Option::zip(at("cx"), at("cy"));
    let (origin, principal_px) = match principal {
        Some((x, y)) => (Origin::Corner, DVec2::new(x, y)),
        None => (Origin::Center, DVec2::ZERO),
    };
    Ok(Lens {
        size_px,
        focal,
        origin,
        principal_px,
        distortion: distortion(file, frame)?,
    })
}

fn distortion(file: &Value, frame: &Value) -> Result<Distortion, String> {
    let at = |key: &str| number_at(frame, key).or_else(|| number_at(file, key)).unwrap_or(0.0);
    let is_set = |key: &str| {
        let flag = frame.get(key).or_else(|| file.get(key));
        flag.and_then(Value::as_bool).unwrap_or(false)
    };
    let k = ["k1", "k2", "k3", "k4"].map(at);
    let p = ["p1", "p2"].map(at);
    let model = frame
        .get("camera_model")
        .or_else(|| file.get("camera_model"))
        .and_then(Value::as_str)
        .map(str::to_uppercase);
    let model = model.as_deref();
    // instant-ngp marks its other lenses with a separate key each.
    let other = OTHER_LENSES
        .iter()
        .find(|key| frame.get(key).is_some() || file.get(key).is_some());
    let refused = |model: &str| {
        Err(format!(
            "its camera model is {model}, expected PINHOLE, OPENCV or OPENCV_FISHEYE: undistort the images to pinholes \
             first"
        ))
    };
    if let Some(other) = other {
        return refused(other);
    }
    if is_set("is_fisheye") || model == Some("OPENCV_FISHEYE") {
        return Ok(Distortion::Fisheye { k });
    }
    match model {
        None | Some("OPENCV" | "PINHOLE" | "PERSPECTIVE" | "SIMPLE_PINHOLE" | "SIMPLE_RADIAL" | "RADIAL") => {}
        Some(model) => return refused(model),
    }
    if k[3] != 0.0 {
        return Err("its lens has a k4 but is not a fisheye: undistort the images first".into());
    }
    if k[..3] == [0.0; 3] && p == [0.0; 2] {
        return Ok(Distortion::None);
    }
    Ok(Distortion::Brown {
        k: [k[0], k[1], k[2]],
        p,
    })
}
