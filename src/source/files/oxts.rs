//! Poses of KITTI's raw recordings, from the GPS and the inertial unit.
//!
//! **How it works.** Each frame has a text file of 30 numbers: latitude, longitude, altitude, roll, pitch, yaw, … .
//! Positions are projected by Mercator at the scale of the first latitude, as the development kit of Geiger et al.
//! (2013, *Vision meets Robotics: The KITTI Dataset*) does. `calib_imu_to_velo.txt`, in the folder of the day, leads
//! from the unit to the LiDAR. The first pose is the identity.

use crate::source::FrameEntry;
use glam::{DAffine3, DMat3, DVec3};
use std::path::Path;

const EARTH_RADIUS_M: f64 = 6_378_137.0;

/// Poses of the LiDAR for each of `entries`, if `folder` (`oxts`) has a file for each.
pub(super) fn poses(folder: &Path, entries: &[FrameEntry]) -> Option<Vec<Option<DAffine3>>> {
    let data = folder.join("data");
    if !data.is_dir() {
        return None;
    }
    let lidar_from_unit = calibration(folder);
    let mut scale = None;
    let mut poses = Vec::with_capacity(entries.len());
    for entry in entries {
        let file = data.join(entry.path.file_stem()?).with_extension("txt");
        let text = crate::regular_file::read_to_string(&file).ok()?;
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
        let [latitude, longitude, altitude, roll, pitch, yaw] = *numbers?.first_chunk::<6>()?;
        let scale = *scale.get_or_insert_with(|| latitude.to_radians().cos());
        let place = DVec3::new(
            scale * EARTH_RADIUS_M * longitude.to_radians(),
            scale * EARTH_RADIUS_M * f64::midpoint(90.0, latitude).to_radians().tan().ln(),
            altitude,
        );
        let rotation = DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll);
        let world_from_unit = DAffine3::from_mat3_translation(rotation, place);
        poses.push(world_from_unit * lidar_from_unit.inverse());
    }
    let first = poses.first()?.inverse();
    let relative = |pose: DAffine3| Some(first * pose).filter(glam::DAffine3::is_finite);
    Some(poses.into_iter().map(relative).collect())
}

/// From the unit to the LiDAR; the identity where the calibration is missing, as both have the same axes and stand a
/// metre apart.
fn calibration(folder: &Path) -> DAffine3 {
    let read = || {
        let drive = folder.parent()?;
        let near = [drive.to_owned(), drive.join("..")];
        let text = near
            .iter()
            .find_map(|folder| crate::regular_file::read_to_string(&folder.join("calib_imu_to_velo.txt")).ok())?;
        let numbers = |name: &str| -> Option<Vec<f64>> {
            let line = text.lines().find_map(|line| line.strip_prefix(name))?;
            line.split_whitespace().map(|word| word.parse().ok()).collect()
        };
        let rotation: [f64; 9] = numbers("R:")?.try_into().ok()?;
        let translation: [f64; 3] = numbers("T:")?.try_into().ok()?;
        let rotation = DMat3::from_cols_array(&rotation).transpose();
        Some(DAffine3::from_mat3_translation(rotation, translation.into()))
    };
    read().unwrap_or(DAffine3::IDENTITY)
}
