//! 7-Scenes (Shotton et al. 2013): `frame-000000.color.png`, `.depth.png` and `.pose.txt`.

use super::{Calibration, DepthCode, Folder, Found, Layout, RgbdError};
use crate::source::rgbd::folder::name_of;
use crate::source::rgbd::pairs::by_key;
use crate::source::rgbd::trajectory::read_pose;

pub(super) const LAYOUT: Layout = Layout { name: "7-Scenes", find };

const CAMERA: [f64; 4] = [585.0, 585.0, 320.0, 240.0];

fn find(folder: &Folder) -> Result<Option<Found>, RgbdError> {
    let named = |end: &'static str| move |name: &str| name.starts_with("frame-") && name.ends_with(end);
    let depths = folder.files(named(".depth.png"));
    if depths.is_empty() {
        return Ok(None);
    }
    let moment = |name: &str| Some(name.split_once('.')?.0.to_owned());
    let pairs = by_key(&depths, &folder.files(named(".color.png")), moment);
    let poses: Vec<Option<String>> = depths
        .iter()
        .map(|path| moment(name_of(path)).map(|moment| format!("{moment}.pose.txt")))
        .collect();
    let code = DepthCode::per_metre(1000.0);
    let mut found = Found::of_pairs(depths, pairs, Calibration::usual(CAMERA, "7-Scenes"), code);
    for (frame, pose) in found.frames.iter_mut().zip(poses) {
        if let Some(pose) = pose.filter(|pose| folder.has_file(pose)) {
            frame.world_from_camera = read_pose(&folder.path.join(pose))?;
        }
    }
    Ok(Some(found))
}
