//! Layout of Stray Scanner, an app for iPhones with LiDAR: `depth/000000.png` in millimetres, `odometry.csv` with the
//! times and poses of frames, `camera_matrix.csv` of the video `rgb.mp4`.
//!
//! Its readers take poses as they are, from a camera with x right, y down and z forward. Newer versions have the lens
//! of each frame in `odometry.csv` too. Videos are not decoded: images extracted into a folder `rgb` are its colours.

use super::folders::{COLOR, DEPTH};
use super::sidecars::Distinct;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::pairs::by_name;
use crate::source::rgbd::text::read;
use crate::source::rgbd::trajectory::pose_of;
use glam::{DAffine3, DQuat, DVec3};
use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

pub(super) const LAYOUT: Layout = Layout {
    is_likely,
    ..Layout::new("Stray Scanner", find)
};

const ODOMETRY: &str = "odometry.csv";
const CAMERA: &str = "camera_matrix.csv";

/// Columns that have to be there.
const POSE: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

fn is_likely(folder: &Folder) -> bool {
    folder.sub(DEPTH).is_some() && folder.has_file(ODOMETRY)
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let Some(depth) = folder.sub(&["depth"]).filter(|_| folder.has_file(ODOMETRY)) else {
        return Ok(None);
    };
    let depths = Folder::read(&depth)?.depth_images();
    if depths.is_empty() {
        return Ok(None);
    }
    let colors = match folder.sub(COLOR) {
        Some(color) => Folder::read(&color)?.images(),
        None => Vec::new(),
    };
    let (rows, has_lenses) = odometry(&folder.path.join(ODOMETRY))?;
    let calibration = if folder.has_file(CAMERA) {
        Calibration::read(&folder.path.join(CAMERA))?
    } else if has_lenses {
        Calibration::of_depth(Intrinsics::pinhole([1.0, 1.0, 0.0, 0.0], None), ODOMETRY)
    } else {
        return Ok(None);
    };
    let pairs = by_name(&depths, &colors);
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Usual("Stray Scanner");
    if colors.is_empty() && folder.has_file("rgb.mp4") {
        found.notes.push(
            "rgb.mp4 is a video, which is not decoded: points have no colours. `ffmpeg -i rgb.mp4 -start_number 0 \
             rgb/%06d.png` makes images of it, which are found"
                .to_owned(),
        );
    }
    if folder.sub(&["confidence"]).is_some() {
        found
            .notes
            .push("the images in confidence are not used: depths of every confidence are shown".to_owned());
    }
    let mut lenses = Distinct::default();
    for frame in &mut found.frames {
        let Some(row) = frame.number().and_then(|number| rows.get(&number)) else {
            continue;
        };
        frame.time = row.time;
        frame.world_from_camera = row.pose;
        if let Some(lens) = row.lens.filter(|_| !folder.has_file(CAMERA)) {
            frame.calibration = lenses.shared(Calibration::of_depth(Intrinsics::pinhole(lens, None), ODOMETRY));
        }
    }
    Ok(Some(found))
}

/// A line of the file.
struct Row {
    time: Option<Duration>,
    pose: Option<DAffine3>,
    lens: Option<[f64; 4]>,
}

/// Lines by the numbers of their frames, and whether they have lenses. A line with something else in it costs its
/// frame's pose.
fn odometry(path: &Path) -> Result<(HashMap<usize, Row>, bool), RgbdError> {
    let text = read(path)?;
    let mut lines = text.lines();
    let names: Vec<String> = lines
        .next()
        .unwrap_or_default()
        .split(',')
        .map(|name| name.trim().to_ascii_lowercase())
        .collect();
    let column = |name: &str| names.iter().position(|known| known == name);
    let wrong = || RgbdError::Line {
        path: path.to_owned(),
        line: 1,
        reason: format!("expected the columns timestamp, frame, {}", POSE.join(", ")),
    };
    let frame = column("frame").ok_or_else(wrong)?;
    let pose: Vec<usize> = POSE
        .iter()
        .map(|name| column(name))
        .collect::<Option<_>>()
        .ok_or_else(wrong)?;
    let time = column("timestamp");
    let lens: Option<Vec<usize>> = ["fx", "fy", "cx", "cy"].iter().map(|name| column(name)).collect();
    let mut rows = HashMap::new();
    for line in lines {
        let cells: Vec<f64> = line
            .split(',')
            .map(|cell| cell.trim().parse().unwrap_or(f64::NAN))
            .collect();
        let cell = |at: usize| cells.get(at).copied().unwrap_or(f64::NAN);
        let number = cell(frame);
        if number < 0.0 || number.fract() != 0.0 {
            continue;
        }
        let [x, y, z, qx, qy, qz, qw] = [0, 1, 2, 3, 4, 5, 6].map(|at| cell(pose[at]));
        let lens = lens.as_ref().map(|lens| [0, 1, 2, 3].map(|at| cell(lens[at])));
        rows.insert(
            number as usize,
            Row {
                time: time.and_then(|time| Duration::try_from_secs_f64(cell(time)).ok()),
                pose: pose_of(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw)),
                lens: lens.filter(|lens| lens.iter().all(|number| *number > 0.0)),
            },
        );
    }
    Ok((rows, lens.is_some()))
}
