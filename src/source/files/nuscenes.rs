//! Poses of nuScenes, from the tables in `v1.0-mini` or the like.
//!
//! `sample_data.json` names, for each file of a sensor, the pose of the car in the map and the mounting of the sensor;
//! these are in `ego_pose.json` and `calibrated_sensor.json` (Caesar et al. 2020, *nuScenes*).

use crate::source::FrameEntry;
use glam::{DAffine3, DQuat, DVec3};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Tables of the whole data set are larger: they would take too long to read.
const MAX_TABLE_BYTES: u64 = 256 << 20;

#[derive(Deserialize)]
struct SampleData {
    filename: String,
    ego_pose_token: String,
    calibrated_sensor_token: String,
}

#[derive(Deserialize)]
struct Pose {
    token: String,
    translation: [f64; 3],
    /// `w` first.
    rotation: [f64; 4],
}

impl Pose {
    fn affine(&self) -> Option<DAffine3> {
        let [w, x, y, z] = self.rotation;
        let rotation = DQuat::from_xyzw(x, y, z, w);
        let is_rotation = rotation.is_finite() && rotation.length() > 1e-6;
        let translation = DVec3::from_array(self.translation);
        is_rotation.then(|| DAffine3::from_rotation_translation(rotation.normalize(), translation))
    }
}

/// Poses of the sensor in the map for each of `entries`, and the folder of tables in `root` that has them; `None` if
/// there are no tables, or not for these files.
pub(super) fn poses(root: &Path, entries: &[FrameEntry]) -> Option<(Vec<Option<DAffine3>>, PathBuf)> {
    let is_tables = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("v1.0-") && path.join("sample_data.json").is_file()
    };
    let folders = fs::read_dir(root).ok()?.flatten().map(|entry| entry.path());
    let tables = folders.filter(is_tables).min()?;
    let samples: Vec<SampleData> = table(&tables.join("sample_data.json"))?;
    let by_name: HashMap<&str, &SampleData> = samples
        .iter()
        .filter_map(|sample| Some((sample.filename.rsplit('/').next()?, sample)))
        .collect();
    let by_token = |poses: Vec<Pose>| -> HashMap<String, DAffine3> {
        let found = poses.into_iter();
        found
            .filter_map(|pose| Some((pose.token.clone(), pose.affine()?)))
            .collect()
    };
    let map_from_car = by_token(table(&tables.join("ego_pose.json"))?);
    let car_from_sensor = by_token(table(&tables.join("calibrated_sensor.json"))?);
    let pose = |entry: &FrameEntry| {
        let sample = by_name.get(entry.path.file_name()?.to_str()?)?;
        let car = map_from_car.get(&sample.ego_pose_token)?;
        Some(*car * *car_from_sensor.get(&sample.calibrated_sensor_token)?)
    };
    let poses: Vec<Option<DAffine3>> = entries.iter().map(pose).collect();
    (2 * poses.iter().flatten().count() >= poses.len()).then_some((poses, tables))
}

fn table<T: DeserializeOwned>(path: &Path) -> Option<Vec<T>> {
    let file = crate::regular_file::open(path).ok()?;
    if file.metadata().ok()?.len() > MAX_TABLE_BYTES {
        return None;
    }
    serde_json::from_reader(BufReader::new(file)).ok()
}
