//! Folder layouts of depth image recordings used by programs and data sets: one row each.
//!
//! A layout looks at names, and reads small files: lists, poses, cameras. To add one: a file with its [`Layout`], and a
//! row of the table.

mod arkit_scenes;
mod flat;
mod folders;
mod found;
mod icl;
mod nyu;
mod pattern;
mod pcl;
mod replica;
mod scanner_app;
mod scannet;
mod scannetpp;
mod seven_scenes;
mod sidecars;
mod stray;
mod sun;
mod transforms;
mod tum;

pub(super) use found::{FoundRecording, FrameImages, Layout};
pub(super) use pattern::by_pattern;

use super::calibration::Calibration;
use super::depth_code::DepthCode;
use super::depth_scale::Units;
use super::error::RgbdError;
use super::folder::Folder;
use super::trajectory::Trajectory;

/// Table of layouts; those identified by more features come first.
const TABLE: &[Layout] = &[
    transforms::LAYOUT,
    scannetpp::LAYOUT,
    tum::LAYOUT,
    seven_scenes::LAYOUT,
    icl::LAYOUT,
    pcl::LAYOUT,
    nyu::LAYOUT,
    sun::LAYOUT,
    scannet::LAYOUT,
    replica::LAYOUT,
    stray::LAYOUT,
    arkit_scenes::LAYOUT,
    scanner_app::LAYOUT,
    folders::LAYOUT,
    flat::LAYOUT,
];

/// The recording in `folder`; `None` if it has no layout of the table.
pub(super) fn find(folder: &Folder) -> Result<Option<(&'static str, FoundRecording)>, RgbdError> {
    for layout in TABLE {
        if let Some(mut found) = (layout.find)(folder)? {
            found.notes.extend(sidecars::note_of_clouds(folder));
            return Ok(Some((layout.name, found)));
        }
    }
    Ok(None)
}

/// Returns true if `folder` has the names of one of the common layouts.
pub(super) fn is_likely(folder: &Folder) -> bool {
    TABLE.iter().any(|layout| (layout.is_likely)(folder))
}

/// Returns true if `transforms.json`, or other files next to it, identify depth images in `folder`: otherwise it
/// describes posed images.
pub(super) fn has_depths_sidecar_transforms(folder: &Folder) -> bool {
    if !folder.has_file(sidecars::TRANSFORMS) {
        return false;
    }
    let has_images = |path: std::path::PathBuf| Folder::read(&path).is_ok_and(|depth| !depth.depth_images().is_empty());
    let has_camera = || !folder.files(sidecars::is_camera).is_empty();
    transforms::has_depths(folder) || (folder.sub(folders::DEPTH).is_some_and(has_images) && has_camera())
}
