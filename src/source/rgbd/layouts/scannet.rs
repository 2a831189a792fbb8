//! Exports of ScanNet (Dai et al. 2017) by its reader: folders `depth`, `color`, `pose` and `intrinsic`, whose matrices
//! are 4 × 4.
//!
//! The depth camera and the colour camera have a lens each (`intrinsic_depth.txt`, `intrinsic_color.txt`) and are taken
//! to be in one place unless `extrinsic_*.txt` say otherwise. A pose of −inf marks a frame that was not tracked. Some
//! exports lack the folder of cameras, but have the text next to the scan (`scene0000_00.txt`) or `_info.txt`.

use super::folders::{COLOR, DEPTH};
use super::sidecars::is_named;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_name;
use crate::source::rgbd::pose_file::read_pose;
use glam::DAffine3;

pub(super) const LAYOUT: Layout = Layout::new("ScanNet", find);

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let (Some(depth), Some(pose)) = (folder.sub(DEPTH), folder.sub(&["pose", "poses"])) else {
        return Ok(None);
    };
    let Some(calibration) = calibration(folder)? else {
        return Ok(None);
    };
    let depths = Folder::read(&depth)?.depth_images();
    let poses = Folder::read(&pose)?.files(|name| has_extension(name, &["txt"]));
    if depths.is_empty() || poses.is_empty() {
        return Ok(None);
    }
    let colors = match folder.sub(COLOR) {
        Some(color) => Folder::read(&color)?.images(),
        None => Vec::new(),
    };
    let pairs = by_name(&depths, &colors);
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Usual("ScanNet");
    found.take_pose_files(name_of(&pose), &poses);
    Ok(Some(found))
}

/// The cameras of the folder `intrinsic`, or those in the text of the scan.
fn calibration(folder: &Folder) -> Result<Option<Calibration>, RgbdError> {
    let Some(cameras) = folder.sub(&["intrinsic", "intrinsics"]) else {
        let texts = folder.files(|name| is_info(name, name_of(&folder.path)));
        return Ok(texts.iter().find_map(|path| Calibration::read(path).ok()));
    };
    let files = Folder::read(&cameras)?.files(|name| has_extension(name, &["txt"]));
    let named = |name: &str| files.iter().find(|path| is_named(path, name));
    let depth = named("intrinsic_depth.txt").or_else(|| named("depth.txt"));
    let Some(depth) = depth.or_else(|| files.first().filter(|_| files.len() == 1)) else {
        return Ok(None);
    };
    let mut calibration = Calibration::read(depth)?;
    if let Some(color) = named("intrinsic_color.txt").or_else(|| named("color.txt")) {
        let place = |name: &str| named(name).and_then(|path| read_pose(path).ok().flatten());
        let from = |name: &str| place(name).unwrap_or(DAffine3::IDENTITY);
        let color_from_depth = from("extrinsic_color.txt").inverse() * from("extrinsic_depth.txt");
        calibration.color = Some((Calibration::read(color)?.depth, color_from_depth));
    }
    Ok(Some(calibration))
}

fn is_info(name: &str, folder: &str) -> bool {
    let stem = name.strip_suffix(".txt").unwrap_or_default();
    !stem.is_empty() && (stem == folder || stem.starts_with("scene") || matches!(stem, "_info" | "info"))
}
