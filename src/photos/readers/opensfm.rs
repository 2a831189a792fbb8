//! `OpenSfM`'s `reconstruction.json`, which `OpenDroneMap` keeps in `opensfm/`.
//!
//! Its manual, *Reconstruction file format* and *Coordinate systems*: a list of reconstructions, each of `cameras`,
//! `shots` and `points`. A shot rotates the world to the camera (x right, y down, z forward) by `rotation`, an axis of
//! the length of the angle, and then shifts it by `translation`. Lengths on an image are fractions of its longer side,
//! counted from its centre: the centre of the first pixel is at (½ − w/2) / max(w, h). `perspective` has one focal
//! length and k₁ k₂, `brown` two with k₁ k₂ k₃ p₁ p₂ (as OpenCV), `fisheye` a polynomial of the angle.
//!
//! The shots that see a point are in `tracks.csv` next to it: a shot, the number of the point, the number of its
//! feature, x and y, and columns that differ by version.

use super::probe::File;
use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::json::{number_at, numbers_at, read as read_json, side};
use crate::photos::sets::lens::{Focal, Lens, Origin};
use crate::photos::sets::points::Observation;
use crate::rgbd::Distortion;
use glam::{DMat3, DVec2, DVec3};
use serde_json::{Map, Value};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The name of the file.
const FILE: &str = "reconstruction.json";

/// The file of the shots that see each point.
const TRACKS: &str = "tracks.csv";

/// Working folder of an `OpenDroneMap` project; the input images are next to it.
const ODM_FOLDER: &str = "opensfm";

/// `OpenSfM` and `OpenDroneMap`.
pub(super) const READER: Reader = Reader {
    name: "OpenSfM (reconstruction.json)",
    in_folder: |folder| {
        let file = folder.first(&[FILE])?;
        let head = File::new(&file).head().ok()?;
        is_reconstruction(&head).then_some(file)
    },
    of_file: |file| {
        let is_one = file.extension() == "json" && is_reconstruction(&file.head()?);
        Ok(is_one.then(|| Claim::certain(file.path)))
    },
    read,
};

/// Returns true if a file that begins with `head` is a list of reconstructions.
fn is_reconstruction(head: &str) -> bool {
    head.trim_start().starts_with('[') && head.contains("\"cameras\"") && head.contains("\"projection_type\"")
}

/// Reads the images of the largest reconstruction in the file `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let file = read_json(path)?;
    let all = file.as_array().map_or(&[][..], Vec::as_slice);
    // The first of equals.
    let largest = all
        .iter()
        .rev()
        .max_by_key(|one| object_at(one, "shots").map_or(0, Map::len));
    let shots = largest
        .and_then(|one| object_at(one, "shots"))
        .filter(|shots| !shots.is_empty());
    let (Some(largest), Some(shots)) = (largest, shots) else {
        let problem = "expected a list of reconstructions with `shots`, found none";
        return Err(PhotosError::invalid(path, "the file", problem));
    };
    let cameras = object_at(largest, "cameras");
    let mut drafts = Drafts::new(path, folders(path));
    drafts.photos = shots.iter().map(|(name, shot)| draft(name, shot, cameras)).collect();
    if all.len() > 1 {
        drafts.notes.push(format!(
            "{} smaller reconstructions of {} are skipped",
            all.len() - 1,
            path.display()
        ));
    }
    let tracks = tracks(&path.with_file_name(TRACKS), &drafts.photos, &mut drafts.notes);
    for (id, point) in object_at(largest, "points").into_iter().flatten() {
        // Non-finite positions are skipped and counted.
        let position = numbers_at(point, "coordinates").map_or(DVec3::NAN, DVec3::from_array);
        let color = numbers_at(point, "color")
            .unwrap_or([128.0; 3])
            .map(|value| value as u8);
        let track = tracks.get(id.as_str()).into_iter().flatten().copied();
        drafts.points.push(position, color, track);
    }
    Ok(drafts)
}

/// The folder of the file and, in a project of `OpenDroneMap`, the project folder.
fn folders(path: &Path) -> Vec<PathBuf> {
    let own = path.parent().unwrap_or(Path::new(""));
    let is_odm = own.file_name().is_some_and(|name| name == ODM_FOLDER);
    let project = own.parent().filter(|_| is_odm);
    [own].into_iter().chain(project).map(Path::to_owned).collect()
}

fn object_at<'a>(value: &'a Value, key: &str) -> Option<&'a Map<String, Value>> {
    value.get(key)?.as_object()
}

fn draft(name: &str, shot: &Value, cameras: Option<&Map<String, Value>>) -> Draft {
    let camera = shot.get("camera").and_then(Value::as_str);
    let camera = camera.and_then(|camera| cameras?.get(camera));
    let lens = match camera {
        Some(camera) => lens(camera),
        None => Err("its camera is not among the cameras".to_owned()),
    };
    // Missing values are NaN, so that the image is reported as one that cannot be shown.
    let turn = numbers_at(shot, "rotation").map_or(DMat3::NAN, |axis| turned(DVec3::from_array(axis)));
    let shift = numbers_at(shot, "translation").map_or(DVec3::NAN, DVec3::from_array);
    Draft::new(name.to_owned(), lens, turn, shift)
}

/// A turn around `axis` by its length.
fn turned(axis: DVec3) -> DMat3 {
    match axis.try_normalize() {
        Some(direction) => DMat3::from_axis_angle(direction, axis.length()),
        None => DMat3::IDENTITY,
    }
}

fn lens(camera: &Value) -> Result<Lens, String> {
    let at = |key: &str| number_at(camera, key);
    let length = |key: &str| at(key).and_then(side).ok_or_else(|| format!("its camera has no {key}"));
    let size_px = [length("width")?, length("height")?];
    let longer_px = f64::from(size_px[0].max(size_px[1]));
    let x = at("focal_x").or_else(|| at("focal"));
    let x = x.ok_or_else(|| "its camera has no focal".to_owned())?;
    let y = at("focal_y").unwrap_or(x);
    let principal = ["c_x", "c_y"].map(|key| at(key).unwrap_or(0.0));
    Ok(Lens {
        size_px: Some(size_px),
        focal: Focal::Pixels(longer_px * DVec2::new(x, y)),
        origin: Origin::Center,
        principal_px: longer_px * DVec2::from_array(principal),
        distortion: distortion(camera)?,
    })
}

fn distortion(camera: &Value) -> Result<Distortion, String> {
    let at = |key: &str| number_at(camera, key).unwrap_or(0.0);
    let [k1, k2, k3, k4] = ["k1", "k2", "k3", "k4"].map(at);
    let p = ["p1", "p2"].map(at);
    let brown = |k: [f64; 3], p: [f64; 2]| match (k, p) {
        ([0.0, 0.0, 0.0], [0.0, 0.0]) => Distortion::None,
        (k, p) => Distortion::Brown { k, p },
    };
    match camera.get("projection_type").and_then(Value::as_str) {
        Some("simple_radial") => Ok(brown([k1, 0.0, 0.0], [0.0; 2])),
        // The first versions had no other projection.
        Some("perspective" | "radial") | None => Ok(brown([k1, k2, 0.0], [0.0; 2])),
        Some("brown") => Ok(brown([k1, k2, k3], p)),
        Some("fisheye") => Ok(Distortion::Fisheye { k: [k1, k2, 0.0, 0.0] }),
        Some("fisheye_opencv") => Ok(Distortion::Fisheye { k: [k1, k2, k3, k4] }),
        Some(other) => Err(format!(
            "its camera has the projection {other}, expected perspective, brown or fisheye: undistort the images first \
             (`opensfm undistort`)"
        )),
    }
}

/// The observations of each point by its number: none without such a file.
fn tracks(path: &Path, photos: &[Draft], notes: &mut Vec<String>) -> HashMap<String, Vec<Observation>> {
    let mut tracks: HashMap<String, Vec<Observation>> = HashMap::new();
    if !path.is_file() {
        return tracks;
    }
    let file = match read_file(path) {
        Ok(file) => file,
        Err(error) => {
            notes.push(format!("{error}; points are shown without what sees them"));
            return tracks;
        }
    };
    let by_name: HashMap<&str, (u32, f32)> = (0..)
        .zip(photos)
        .filter_map(|(index, draft)| {
            let [width, height] = draft.lens.as_ref().ok()?.size_px?;
            Some((draft.name.as_str(), (index, width.max(height) as f32)))
        })
        .collect();
    for line in String::from_utf8_lossy(&file).lines() {
        let mut columns = line.split('\t');
        // The first line states the version, and not all shots need to be placed.
        let Some(&(photo, longer_px)) = columns.next().and_then(|name| by_name.get(name)) else {
            continue;
        };
        let (Some(point), Some(_feature)) = (columns.next(), columns.next()) else {
            continue;
        };
        let mut number = || columns.next()?.parse::<f32>().ok();
        if let (Some(x), Some(y)) = (number(), number()) {
            let pixel = longer_px * glam::Vec2::new(x, y);
            tracks
                .entry(point.to_owned())
                .or_default()
                .push(Observation { photo, pixel });
        }
    }
    tracks
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    #[test]
    fn the_largest_of_several_reconstructions_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE);
        let camera = json!({"projection_type": "perspective", "width": 8, "height": 6, "focal": 1.0});
        let shot = json!({"camera": "c", "rotation": [0, 0, 0], "translation": [0, 0, 0]});
        let reconstruction = |names: &[&str]| {
            let shots: Map<String, Value> = names.iter().map(|&name| (name.to_owned(), shot.clone())).collect();
            json!({"cameras": {"c": camera}, "shots": shots})
        };
        let file = json!([reconstruction(&["a.png"]), reconstruction(&["b.png", "c.png"])]);
        fs::write(&path, file.to_string()).unwrap();
        let drafts = read(&path).unwrap();
        let names: Vec<&str> = drafts.photos.iter().map(|draft| draft.name.as_str()).collect();
        assert_eq!(names, ["b.png", "c.png"]);
        assert!(drafts.notes[0].starts_with("1 smaller"), "{:?}", drafts.notes);
        fs::write(&path, "[]").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("expected a list"));
    }

    #[test]
    fn unsupported_projections_are_named() {
        let of = |projection: &str| distortion(&json!({"projection_type": projection, "k1": 0.5}));
        assert_eq!(
            of("fisheye"),
            Ok(Distortion::Fisheye {
                k: [0.5, 0.0, 0.0, 0.0]
            })
        );
        assert!(of("spherical").unwrap_err().contains("spherical"));
    }
}
