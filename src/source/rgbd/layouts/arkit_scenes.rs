//! `ARKitScenes` (Baruch et al. 2021): folders `lowres_depth`, `lowres_wide` and `lowres_wide_intrinsics`, whose files
//! are named after the recording and a time, and `lowres_wide.traj`.
//!
//! A `.pincam` is width, height, focal lengths and principal point. A line of the trajectory is a time, a rotation as
//! an axis whose length is the angle, and a translation, from the world to the camera (x right, y down, z forward).

use super::sidecars::Distinct;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Trajectory, Units};
use crate::io::files::timestamps::times_of_lines;
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_name;
use crate::source::rgbd::text::{number_lines, read};
use glam::{DAffine3, DQuat, DVec3};
use std::path::Path;
use std::time::Duration;

pub(super) const LAYOUT: Layout = Layout {
    is_likely,
    ..Layout::new("ARKitScenes", find)
};

const TRAJECTORY: &str = "lowres_wide.traj";

fn is_likely(folder: &Folder) -> bool {
    folder.sub(&["lowres_depth"]).is_some()
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    // In a data set they are below the mesh of the scene.
    let frames = folder.folders().iter().find(|name| name.ends_with("_frames"));
    let below = match frames {
        Some(name) if folder.sub(&["lowres_depth"]).is_none() => Some(Folder::read(&folder.path.join(name))?),
        _ => None,
    };
    let folder = below.as_ref().unwrap_or(folder);
    let (Some(depth), Some(cameras)) = (folder.sub(&["lowres_depth"]), folder.sub(&["lowres_wide_intrinsics"])) else {
        return Ok(None);
    };
    let depths = Folder::read(&depth)?.images();
    let cameras = Folder::read(&cameras)?.files(|name| has_extension(name, &["pincam"]));
    let Some(first) = cameras.first().filter(|_| !depths.is_empty()) else {
        return Ok(None);
    };
    let colors = match folder.sub(&["lowres_wide"]) {
        Some(color) => Folder::read(&color)?.images(),
        None => Vec::new(),
    };
    let pairs = by_name(&depths, &colors);
    let cameras = by_name(&depths, &cameras).colors;
    let calibration = Calibration::read(first)?;
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Usual("ARKitScenes");
    let mut lenses = Distinct::default();
    for (frame, camera) in found.frames.iter_mut().zip(cameras) {
        frame.time = time_of(name_of(frame.depth.path()));
        if let Some(camera) = camera {
            frame.calibration = lenses.shared(Calibration::read(&camera)?);
        }
    }
    if folder.has_file(TRAJECTORY) {
        found.take_poses(&trajectory(&folder.path.join(TRAJECTORY))?);
    }
    Ok(Some(found))
}

/// `41069021_305.377.png` was taken at 305.377 s.
fn time_of(name: &str) -> Option<Duration> {
    let (stem, _) = name.rsplit_once('.')?;
    let (_, seconds) = stem.rsplit_once('_')?;
    times_of_lines(seconds)?.first().copied()
}

fn trajectory(path: &Path) -> Result<Trajectory, RgbdError> {
    let text = read(path)?;
    let mut poses = Vec::new();
    for (line, numbers) in number_lines(path, &text)? {
        let wrong = |reason: &str| RgbdError::Line {
            path: path.to_owned(),
            line,
            reason: reason.to_owned(),
        };
        let numbers = <[f64; 7]>::try_from(numbers);
        let [seconds, rx, ry, rz, x, y, z] =
            numbers.map_err(|_| wrong("expected a time, a rotation of three numbers and a translation"))?;
        let time = Duration::try_from_secs_f64(seconds).map_err(|_| wrong("the time is not a number of seconds"))?;
        let (turn, shift) = (DVec3::new(rx, ry, rz), DVec3::new(x, y, z));
        let camera_from_world = DAffine3::from_rotation_translation(DQuat::from_scaled_axis(turn), shift);
        let is_pose = turn.is_finite() && shift.is_finite();
        poses.push((time, is_pose.then(|| camera_from_world.inverse())));
    }
    poses.sort_by_key(|(time, _)| *time);
    Ok(Trajectory::Stamped(poses))
}
