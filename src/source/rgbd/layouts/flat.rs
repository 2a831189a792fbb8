//! Depth and colour images in one folder, distinguished by a word of their names: `cam_Depth_*.png` and
//! `cam_Color_*.png` of the viewer of RealSense, `depth_*.png` and `rgb_*.png` of scripts.

use super::sidecars;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::folder::is_image;
use crate::source::rgbd::pairs::by_name;

pub(super) const LAYOUT: Layout = Layout::new("depth and color images in one folder", find);

/// A camera of PrimeSense, which Open3D takes where none is named.
const CAMERA: [f64; 4] = [525.0, 525.0, 319.5, 239.5];

/// Words of colour images.
const COLOR: [&str; 4] = ["color", "colour", "rgb", "image"];

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let has_word = |name: &str, words: &[&str]| {
        let name = name.to_ascii_lowercase();
        let mut parts = name.split(|c: char| !c.is_ascii_alphabetic());
        parts.any(|part| words.contains(&part))
    };
    // Image sets of many kinds include depth images: a single one does not make a recording.
    let depths = folder.files(|name| is_image(name) && has_word(name, &["depth"]));
    let colors = folder.files(|name| is_image(name) && has_word(name, &COLOR) && !has_word(name, &["depth"]));
    let others = folder.images().len() - depths.len() - colors.len();
    if folder.has_clouds() || depths.is_empty() || colors.len() != depths.len() || others > 0 {
        return Ok(None);
    }
    let pairs = by_name(&depths, &colors);
    let mut notes = Vec::new();
    let calibration = sidecars::camera(folder, &mut notes)?;
    let calibration = calibration.unwrap_or_else(|| Calibration::usual(CAMERA, "PrimeSense, as Open3D takes it"));
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0));
    found.units = Units::Unknown;
    found.notes.extend(notes);
    sidecars::take_poses(folder, &mut found)?;
    Ok(Some(found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn frames(names: &[&str]) -> Option<usize> {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            fs::write(folder.path().join(name), b"").unwrap();
        }
        let found = find(&Folder::read(folder.path()).unwrap()).unwrap()?;
        assert!(found.frames.iter().all(|frame| frame.color.is_some()));
        Some(found.frames.len())
    }

    #[test]
    fn words_in_names_distinguish_depths_from_colors() {
        let viewer = [
            "cam_Depth_1600000000000.00000.png",
            "cam_Color_1600000000005.00000.png",
            "cam_Depth_1600000000033.30005.png",
            "cam_Color_1600000000038.30005.png",
        ];
        assert_eq!(frames(&viewer), Some(2));
        assert_eq!(frames(&["depth_0.png", "rgb_0.png"]), Some(1));
        assert_eq!(frames(&["depth_0.png", "a.jpg"]), None);
        assert_eq!(frames(&["depth_0.png", "rgb_0.png", "mask_0.png"]), None);
    }
}
