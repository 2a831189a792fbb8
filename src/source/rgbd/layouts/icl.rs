//! The rendered rooms of ICL-NUIM (Handa et al. 2014): `scene_00_0000.depth`, text of the lengths of rays, with `.png`
//! and `.txt`, which has the camera as POV-Ray takes it.
//!
//! POV-Ray's axes are left-handed. So the z axis of the world is turned over, and the camera looks as others do: x to
//! the right, y down, z forward.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError};
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_key;
use crate::source::rgbd::text::read;
use glam::{DAffine3, DMat3, DVec3};
use std::path::Path;

pub(super) const LAYOUT: Layout = Layout::new("ICL-NUIM", find);

const CAMERA: [f64; 4] = [481.2, 480.0, 319.5, 239.5];

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let depths = folder.files(|name| has_extension(name, &["depth"]));
    if depths.is_empty() {
        return Ok(None);
    }
    let time_step = |name: &str| Some(name.rsplit_once('.')?.0.to_owned());
    let pairs = by_key(&depths, &folder.images(), time_step);
    let cameras: Vec<Option<String>> = depths
        .iter()
        .map(|path| time_step(name_of(path)).map(|time_step| format!("{time_step}.txt")))
        .collect();
    let mut found = FoundRecording::of_pairs(
        depths,
        pairs,
        Calibration::usual(CAMERA, "ICL-NUIM"),
        DepthCode::ray_length(),
    );
    for (frame, camera) in found.frames.iter_mut().zip(cameras) {
        if let Some(camera) = camera.filter(|camera| folder.has_file(camera)) {
            frame.world_from_camera = pose_of_pov(&folder.path.join(camera))?;
        }
    }
    Ok(Some(found))
}

/// The pose in lines such as `cam_pos = [1.0, 2.0, 3.0]';`.
fn pose_of_pov(path: &Path) -> Result<Option<DAffine3>, RgbdError> {
    let text = read(path)?;
    let vector = |name: &str| -> Option<DVec3> {
        let line = text.lines().find(|line| line.trim_start().starts_with(name))?;
        let (_, list) = line.split_once('[')?;
        let (list, _) = list.split_once(']')?;
        let numbers: Option<Vec<f64>> = list.split(',').map(|number| number.trim().parse().ok()).collect();
        Some(DVec3::from_array(numbers?.try_into().ok()?)).filter(|vector| vector.is_finite())
    };
    let pose = || {
        let forward = vector("cam_dir")?.try_normalize()?;
        let right = vector("cam_up")?.cross(forward).try_normalize()?;
        let up = forward.cross(right);
        let turned = DVec3::new(1.0, 1.0, -1.0);
        let rotation = DMat3::from_cols(turned * right, turned * -up, turned * forward);
        Some(DAffine3::from_mat3_translation(rotation, turned * vector("cam_pos")?))
    };
    Ok(pose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_a_rendered_camera_match_those_of_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.txt");
        // At a height of one metre, looking along z with y up; in POV-Ray x is then to the right.
        let text = "cam_pos = [0.5, 1.0, 2.0]';\ncam_dir = [0.0, 0.0, 2.0]';\ncam_up = [0.0, 1.0, 0.0]';\n";
        std::fs::write(&path, text).unwrap();
        let pose = pose_of_pov(&path).unwrap().unwrap();
        assert!((pose.matrix3.determinant() - 1.0).abs() < 1e-12);
        // A metre to the right, a metre down, three metres ahead.
        let seen = pose.transform_point3(DVec3::new(1.0, 1.0, 3.0));
        assert!(seen.abs_diff_eq(DVec3::new(1.5, 0.0, -5.0), 1e-12), "{seen}");
        std::fs::write(&path, "cam_pos = [0.5, x]';").unwrap();
        assert_eq!(pose_of_pov(&path).unwrap(), None);
    }
}
