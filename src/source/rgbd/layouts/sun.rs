//! SUN3D and SUN RGB-D (Xiao et al. 2013, Song et al. 2015): `depth`, `image` and `intrinsics.txt`. Depths are
//! millimetres, turned by three bits.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Trajectory};
use crate::source::rgbd::folder::has_extension;
use crate::source::rgbd::pairs::by_name;
use std::path::Path;

pub(super) const LAYOUT: Layout = Layout::new("SUN", find);

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let camera = "intrinsics.txt";
    let (Some(depth), Some(color)) = (folder.sub(&["depth", "depth_bfx"]), folder.sub(&["image"])) else {
        return Ok(None);
    };
    if !folder.has_file(camera) {
        return Ok(None);
    }
    let depths = Folder::read(&depth)?.images();
    if depths.is_empty() {
        return Ok(None);
    }
    let pairs = by_name(&depths, &Folder::read(&color)?.images());
    let calibration = Calibration::read(&folder.path.join(camera))?;
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::rotated());
    if let Some(poses) = folder.sub(&["extrinsics"]) {
        take_poses(&mut found, &poses)?;
    }
    Ok(Some(found))
}

/// The newest list of poses, if it is one for all frames: a single image's gives the tilt of the camera, not its
/// position.
fn take_poses(found: &mut FoundRecording, folder: &Path) -> Result<(), RgbdError> {
    let lists = Folder::read(folder)?.files(|name| has_extension(name, &["txt"]));
    let Some(newest) = lists.last() else { return Ok(()) };
    if found.frames.len() < 2 {
        return Ok(());
    }
    let trajectory = Trajectory::read(newest)?;
    match &trajectory {
        Trajectory::Numbered(poses) if poses.len() == found.frames.len() => found.take_poses(&trajectory),
        _ => found.notes.push(format!(
            "{} has not a pose for each of the {} depth images: they are read without poses",
            newest.display(),
            found.frames.len()
        )),
    }
    Ok(())
}
