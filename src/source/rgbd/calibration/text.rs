//! Cameras in text: numbers, a matrix, or names with values.
//!
//! *Names.* Programs write `fx: 525.0` (YAML), `fx_depth = 577.87` (the text next to a scan of ScanNet) or
//! `Camera.fx: 535.4` with `DepthMapFactor: 5000` (ORB-SLAM); BundleFusion's `info.txt` and the exports of ScanNet
//! write a matrix behind `m_calibrationDepthIntrinsic = `, ROS and OpenCV behind `data`. A value of the depth camera
//! counts more than one without its name.

use super::model::{Calibration, Intrinsics};
use crate::rgbd::Distortion;
use crate::source::rgbd::error::RgbdError;
use crate::source::rgbd::text::number_lines;
use glam::DAffine3;
use std::path::Path;

/// A camera in lines of text.
pub(super) fn calibration(path: &Path, text: &str, because: String) -> Result<Calibration, RgbdError> {
    if let Some(named) = of_names(text, &because) {
        return Ok(named);
    }
    if let Some(depth) = of_colmap(text) {
        return Ok(Calibration::of_depth(depth, because));
    }
    let lines = number_lines(path, text)?;
    let numbers: Vec<f64> = lines.into_iter().flat_map(|(_, numbers)| numbers).collect();
    let wrong = || RgbdError::Calibration {
        path: path.to_owned(),
        reason: format!("it has {} numbers", numbers.len()),
    };
    let (depth, size_px) = match *numbers.as_slice() {
        // A `.pincam` of ARKitScenes.
        [width, height, fx, fy, cx, cy] => ([fx, fy, cx, cy], size_of(width, height)),
        _ => (pinhole_of(&numbers).ok_or_else(wrong)?, None),
    };
    Ok(Calibration::of_depth(Intrinsics::pinhole(depth, size_px), because))
}

/// The first camera of `cameras.txt` of COLMAP: number, model, width, height and the numbers of the model, whose corner
/// of the image is at 0.
fn of_colmap(text: &str) -> Option<Intrinsics> {
    let line = text
        .lines()
        .find(|line| !line.trim().is_empty() && !line.starts_with('#'))?;
    let mut words = line.split_whitespace();
    let (_, model) = (words.next()?.parse::<u64>().ok()?, words.next()?);
    let numbers: Vec<f64> = words.map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let [width, height, ref lens @ ..] = *numbers.as_slice() else {
        return None;
    };
    let (pinhole, distortion) = match (model, lens) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f, cx, cy], Distortion::None),
        ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy, cx, cy], Distortion::None),
        ("SIMPLE_RADIAL", &[f, cx, cy, k]) => (
            [f, f, cx, cy],
            Distortion::Brown {
                k: [k, 0.0, 0.0],
                p: [0.0; 2],
            },
        ),
        ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => (
            [fx, fy, cx, cy],
            Distortion::Brown {
                k: [k1, k2, 0.0],
                p: [p1, p2],
            },
        ),
        _ => return None,
    };
    let [fx, fy, cx, cy] = pinhole;
    Some(Intrinsics {
        distortion,
        ..Intrinsics::pinhole([fx, fy, cx - 0.5, cy - 0.5], size_of(width, height))
    })
}

/// fx, fy, cx, cy of these numbers: themselves, or a matrix of 3 × 3, 3 × 4 or 4 × 4, row by row; by columns where the
/// principal point is in the last row.
pub(super) fn pinhole_of(numbers: &[f64]) -> Option<[f64; 4]> {
    match *numbers {
        [fx, _, 0.0, _, fy, 0.0, cx, cy, _] if cx != 0.0 => Some([fx, fy, cx, cy]),
        [fx, fy, cx, cy]
        | [fx, _, cx, _, fy, cy, _, _, _]
        | [fx, _, cx, _, _, fy, cy, _, _, _, _, _]
        | [fx, _, cx, _, _, fy, cy, _, _, _, _, _, _, _, _, _] => Some([fx, fy, cx, cy]),
        _ => None,
    }
}

/// Units per metre from a number that states them or their inverse.
pub(super) fn units_of_scale(scale: f64) -> Option<f64> {
    let is_length = scale > 0.0 && scale < 1.0;
    let units = if is_length { scale.recip() } else { scale };
    (units.is_finite() && units > 0.0).then_some(units)
}

fn size_of(width: f64, height: f64) -> Option<[u32; 2]> {
    let is_size = |edge: f64| edge.fract() == 0.0 && (1.0..65_536.0).contains(&edge);
    (is_size(width) && is_size(height)).then_some([width as u32, height as u32])
}

/// Names and their values, in lower case and without the part before a full stop.
struct Named(Vec<(String, Vec<f64>)>);

impl Named {
    fn of(text: &str) -> Self {
        let pair = |line: &str| {
            let (name, value) = line.split_once(['=', ':'])?;
            let name = name.trim().trim_matches('"').to_ascii_lowercase();
            let name = name.rsplit('.').next().unwrap_or_default().to_owned();
            let words = value.split(|c: char| c.is_whitespace() || c == ',' || c == '[' || c == ']');
            let numbers = words
                .filter(|word| !word.is_empty())
                .map_while(|word| word.parse().ok());
            Some((name, numbers.collect::<Vec<f64>>()))
        };
        Self(text.lines().filter_map(pair).collect())
    }

    fn numbers(&self, name: &str) -> Option<&[f64]> {
        let found = self
            .0
            .iter()
            .find(|(known, numbers)| known == name && !numbers.is_empty());
        found.map(|(_, numbers)| numbers.as_slice())
    }

    fn first(&self, names: &[&str]) -> Option<f64> {
        names.iter().find_map(|name| self.numbers(name)?.first().copied())
    }

    fn pinhole(&self, numbers: [&[&str]; 4], sizes: [&[&str]; 2]) -> Option<Intrinsics> {
        let [fx, fy, cx, cy] = numbers.map(|names| self.first(names));
        let [width, height] = sizes.map(|names| self.first(names));
        let size_px = width.zip(height).and_then(|(width, height)| size_of(width, height));
        Some(Intrinsics::pinhole([fx?, fy?, cx?, cy?], size_px))
    }

    /// Behind one of these names, with the size behind others.
    fn matrix(&self, name: &str, sizes: [&[&str]; 2]) -> Option<Intrinsics> {
        let pinhole = pinhole_of(self.numbers(name)?)?;
        let [width, height] = sizes.map(|names| self.first(names));
        let size_px = width.zip(height).and_then(|(width, height)| size_of(width, height));
        Some(Intrinsics::pinhole(pinhole, size_px))
    }
}

/// The cameras given by names with values; `None` for other text.
fn of_names(text: &str, because: &str) -> Option<Calibration> {
    let named = Named::of(text);
    let depth_size: [&[&str]; 2] = [
        &["m_depthwidth", "depthwidth", "width", "image_width", "w"],
        &["m_depthheight", "depthheight", "height", "image_height", "h"],
    ];
    let color_size: [&[&str]; 2] = [&["m_colorwidth", "colorwidth"], &["m_colorheight", "colorheight"]];
    let matrices = ["m_calibrationdepthintrinsic", "k", "camera_matrix", "data"];
    let matrix = matrices.iter().find_map(|name| named.matrix(name, depth_size));
    let depth = matrix.or_else(|| {
        let names: [&[&str]; 4] = [
            &["fx_depth", "fx"],
            &["fy_depth", "fy"],
            &["mx_depth", "cx", "ppx"],
            &["my_depth", "cy", "ppy"],
        ];
        named.pinhole(names, depth_size)
    })?;
    let color = named
        .matrix("m_calibrationcolorintrinsic", color_size)
        .or_else(|| named.pinhole([&["fx_color"], &["fy_color"], &["mx_color"], &["my_color"]], color_size));
    let scales = [
        "m_depthshift",
        "depthmapfactor",
        "png_depth_scale",
        "depth_scale",
        "scale",
    ];
    Some(Calibration {
        color: color.map(|color| (color, DAffine3::IDENTITY)),
        units_per_metre: named.first(&scales).and_then(units_of_scale),
        ..Calibration::of_depth(depth, because)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Calibration {
        calibration(Path::new("camera.txt"), text, "camera.txt".to_owned()).unwrap()
    }

    #[test]
    fn every_notation_of_a_camera_gives_the_same_result() {
        for text in [
            "577.5 578.5 319.5 239.5",
            "577.5 0 319.5\n0 578.5 239.5\n0 0 1\n",
            "577.5 0 319.5 0\n0 578.5 239.5 0\n0 0 1 0\n",
            "577.5 0 319.5 0\n0 578.5 239.5 0\n0 0 1 0\n0 0 0 1\n",
            "577.5 0 0\n0 578.5 0\n319.5 239.5 1\n",
            "640 480 577.5 578.5 319.5 239.5",
            "fx: 577.5\nfy: 578.5\ncx: 319.5\ncy: 239.5\n",
            "%YAML:1.0\nCamera.fx: 577.5\nCamera.fy: 578.5\nCamera.cx: 319.5\nCamera.cy: 239.5\n",
            "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  data: [577.5, 0., 319.5, 0., 578.5, \
             239.5, 0., 0., 1.]\n",
            "fx_color = 1.0\nfx_depth = 577.5\nfy_depth = 578.5\nmx_depth = 319.5\nmy_depth = 239.5\n",
            "m_depthShift = 1000\nm_calibrationDepthIntrinsic = 577.5 0 319.5 0 0 578.5 239.5 0 0 0 1 0 0 0 0 1 \n",
        ] {
            let depth = read(text).depth;
            assert_eq!((depth.focal_px.x, depth.focal_px.y), (577.5, 578.5), "{text}");
            assert_eq!((depth.principal_px.x, depth.principal_px.y), (319.5, 239.5), "{text}");
        }
        assert_eq!(
            read("640 480 577.5 578.5 319.5 239.5").depth.for_size_px,
            Some([640, 480])
        );
    }

    #[test]
    fn cameras_of_colmap_count_from_the_corner() {
        let depth = read("# Camera list\n1 PINHOLE 640 480 577.5 578.5 320 240\n").depth;
        assert_eq!((depth.principal_px.x, depth.principal_px.y), (319.5, 239.5));
        assert_eq!((depth.focal_px.y, depth.for_size_px), (578.5, Some([640, 480])));
    }

    #[test]
    fn units_are_given_per_metre_or_as_the_length_of_one() {
        let camera = "fx: 1\nfy: 1\ncx: 1\ncy: 1\n";
        for (scale, expected) in [("DepthMapFactor: 5000.0", 5000.0), ("depth_scale: 0.001", 1000.0)] {
            assert_eq!(read(&format!("{camera}{scale}\n")).units_per_metre, Some(expected));
        }
        assert_eq!(read(camera).units_per_metre, None);
    }
}
