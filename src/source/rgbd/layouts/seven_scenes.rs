//! 7-Scenes (Shotton et al. 2013): `frame-000000.color.png`, `.depth.png` and `.pose.txt`; and recordings by the same
//! names with other images (`.color.jpg`, `.depth.pgm`: ScanNet's reader, BundleFusion, TSDF fusion).
//!
//! The latter state their cameras: `_info.txt` or `info.txt` next to the images, `camera-intrinsics.txt` there or in
//! the folder around. If no file does, the data set's cameras apply:
//!
//! Depths and colours are those of a Kinect as its two cameras took them: nothing was registered, and poses belong to
//! the depth camera. The data set states the depth camera alone. The colour camera has a wider lens, so that taking one
//! for the other is off by up to 36 pixels at the border. It is a typical Kinect's: ACE (Brachmann et al. 2023) takes
//! the same numbers for these scenes, from the calibration of a Kinect by LIRIS (Lyon). `--intrinsics 585,585,320,240`
//! says that colours were registered after all.

use super::sidecars;
use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units};
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::{is_image, name_of};
use crate::source::rgbd::pairs::by_key;
use crate::source::rgbd::pose_file::read_pose;
use glam::{DAffine3, DMat3, DVec3};
use std::path::PathBuf;

pub(super) const LAYOUT: Layout = Layout {
    is_likely,
    ..Layout::new("7-Scenes", find)
};

const DEPTH_CAMERA: [f64; 4] = [585.0, 585.0, 320.0, 240.0];

const COLOR_CAMERA: [f64; 4] = [525.0, 525.0, 320.0, 240.0];

/// Axes of the depth camera in the frame of the colour camera.
const COLOR_FROM_DEPTH_TURN: DMat3 = DMat3::from_cols(
    DVec3::new(0.999_965_180_125_677, -0.002_740_931_128_132, 0.007_881_994_213_045),
    DVec3::new(0.002_676_512_646_895, 0.999_963_028_030_276, 0.008_171_832_877_189),
    DVec3::new(-0.007_904_101_231_300, -0.008_150_452_077_801, 0.999_935_545_580_14),
);

/// Metres.
const COLOR_FROM_DEPTH_SHIFT: DVec3 = DVec3::new(-0.025_558_943, 0.000_101_096, 0.002_031_832);

fn is_likely(folder: &Folder) -> bool {
    let is_depth = |name: &str| name.starts_with("frame-") && name.contains(".depth.");
    !folder.files(is_depth).is_empty()
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let named = |part: &'static str| {
        move |name: &str| {
            let stem = name.rsplit_once('.').map_or("", |(stem, _)| stem);
            name.starts_with("frame-") && stem.ends_with(part)
        }
    };
    let depths: Vec<PathBuf> = folder.depth_images();
    let depths: Vec<PathBuf> = depths
        .into_iter()
        .filter(|path| named(".depth")(name_of(path)))
        .collect();
    if depths.is_empty() {
        return Ok(None);
    }
    let time_step = |name: &str| Some(name.split_once('.')?.0.to_owned());
    let pairs = by_key(
        &depths,
        &folder.files(|name| named(".color")(name) && is_image(name)),
        time_step,
    );
    let poses: Vec<Option<String>> = depths
        .iter()
        .map(|path| time_step(name_of(path)).map(|time_step| format!("{time_step}.pose.txt")))
        .collect();
    let code = DepthCode::per_metre(1000.0);
    let mut notes = Vec::new();
    let info = folder.files(|name| matches!(name, "_info.txt" | "info.txt"));
    let calibration = match info.first() {
        Some(info) => Calibration::read(info)?,
        None => sidecars::camera(folder, &mut notes)?.unwrap_or_else(calibration),
    };
    let mut found = FoundRecording::of_pairs(depths, pairs, calibration, code);
    found.units = Units::Usual("7-Scenes");
    for (frame, pose) in found.frames.iter_mut().zip(poses) {
        let Some(pose) = pose.filter(|pose| folder.has_file(pose)) else {
            continue;
        };
        match read_pose(&folder.path.join(pose)) {
            Ok(pose) => frame.world_from_camera = pose,
            Err(error) => notes.push(format!("{error}; its frame has no pose")),
        }
    }
    found.notes.extend(notes);
    Ok(Some(found))
}

fn calibration() -> Calibration {
    let color_from_depth = DAffine3 {
        matrix3: COLOR_FROM_DEPTH_TURN,
        translation: COLOR_FROM_DEPTH_SHIFT,
    };
    let color = Intrinsics::pinhole(COLOR_CAMERA, Some([640, 480]));
    Calibration {
        color: Some((color, color_from_depth)),
        ..Calibration::usual(DEPTH_CAMERA, "7-Scenes")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_come_from_a_camera_next_to_the_depth_camera_with_a_wider_lens() {
        let Ok(rig) = calibration().rig([640, 480], Some([640, 480])) else {
            panic!("both are of 640 × 480");
        };
        let color = rig.color.unwrap();
        let turn = color.color_from_depth.matrix3;
        assert!((turn.transpose() * turn).abs_diff_eq(DMat3::IDENTITY, 1e-9));
        // A point 2 m in front of the depth camera, on its axis, and one 1 m to the side.
        let center = color
            .camera
            .pixel(color.color_from_depth.transform_point3(DVec3::new(0.0, 0.0, 2.0)));
        assert!(
            (center.unwrap() - glam::DVec2::new(309.1, 235.7)).length() < 0.2,
            "{center:?}"
        );
        let aside = color
            .camera
            .pixel(color.color_from_depth.transform_point3(DVec3::new(1.0, 0.0, 2.0)));
        assert!((aside.unwrap().x - center.unwrap().x - 262.5).abs() < 3.0, "{aside:?}");
    }
}
