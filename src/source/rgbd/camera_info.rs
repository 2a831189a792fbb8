//! Cameras from messages of ROS: lenses, the part of the image that is sent, and the transform from one frame of
//! reference to another.

use super::calibration::Intrinsics;
use super::error::RgbdError;
use crate::io::recordings::recording::camera::{CameraInfo, Link};
use crate::rgbd::Distortion;
use glam::{DAffine3, DVec2};

/// The camera of images of `topic`, which have `image_px` pixels, if that is known. Names of rectified images show it:
/// they have the lens of the projection, without distortion.
pub(super) fn intrinsics(
    topic: &str,
    info: &CameraInfo,
    image_px: Option<[u32; 2]>,
    notes: &mut Vec<String>,
) -> Result<Intrinsics, RgbdError> {
    let is_rectified = topic.contains("rect") && info.p[0] > 0.0;
    let [fx, fy, cx, cy] = if is_rectified {
        [info.p[0], info.p[5], info.p[2], info.p[6]]
    } else {
        [info.k[0], info.k[4], info.k[2], info.k[5]]
    };
    if !(fx > 0.0 && fy > 0.0 && fx.is_finite() && fy.is_finite()) {
        return Err(RgbdError::Options {
            reason: format!(
                "the CameraInfo of topic {topic} has focal lengths of {fx} and {fy} pixels: the camera was not \
                 calibrated; name it by --intrinsics fx,fy,cx,cy or a file"
            ),
        });
    }
    let distortion = if is_rectified {
        Ok(Distortion::None)
    } else {
        lens(&info.model, &info.distortion)
    };
    let whole = Intrinsics {
        focal_px: DVec2::new(fx, fy),
        principal_px: DVec2::new(cx, cy),
        distortion: distortion.unwrap_or_else(|reason| {
            notes.push(format!("the lens of topic {topic} is ignored: {reason}"));
            Distortion::None
        }),
        for_size_px: Some(info.size_px).filter(|size| !size.contains(&0)),
    };
    Ok(windowed(whole, info, image_px))
}

/// The camera of the part of the image that is sent (`sensor_msgs/CameraInfo`: the matrix is of the whole sensor,
/// several of whose pixels are one of a binned image). Drivers that send the whole image but report a part are not
/// believed.
fn windowed(whole: Intrinsics, info: &CameraInfo, image_px: Option<[u32; 2]>) -> Intrinsics {
    let window = info.window;
    let part_px = if window.size_px.contains(&0) {
        info.size_px
    } else {
        window.size_px
    };
    let binning = window.binning.map(|pixels| pixels.max(1));
    let sent_px = [part_px[0] / binning[0], part_px[1] / binning[1]];
    let is_whole = sent_px == info.size_px && window.offset_px == [0, 0];
    if is_whole || sent_px.contains(&0) || image_px.is_some_and(|size| size != sent_px) {
        return whole;
    }
    let pair = |numbers: [u32; 2]| DVec2::new(f64::from(numbers[0]), f64::from(numbers[1]));
    // Pixel centres are at integers: the corner of the region is half a pixel before its first.
    let from_corner = whole.principal_px - pair(window.offset_px) + 0.5;
    Intrinsics {
        focal_px: whole.focal_px / pair(binning),
        principal_px: from_corner / pair(binning) - 0.5,
        for_size_px: Some(sent_px),
        ..whole
    }
}

/// The lens of a model of ROS (REP 2012 names them as OpenCV does) or of `librealsense`.
fn lens(model: &str, coefficients: &[f64]) -> Result<Distortion, String> {
    if coefficients.iter().all(|&k| k == 0.0) {
        return Ok(Distortion::None);
    }
    let k = |index: usize| coefficients.get(index).copied().unwrap_or(0.0);
    let is_bare = |from: usize| coefficients.iter().skip(from).all(|&k| k == 0.0);
    let p = [k(2), k(3)];
    match model {
        "plumb_bob" | "Brown Conrady" if is_bare(5) => Ok(Distortion::Brown {
            k: [k(0), k(1), k(4)],
            p,
        }),
        // Coefficients beyond eight are for thin prisms and tilts.
        "rational_polynomial" if is_bare(8) => Ok(Distortion::Rational {
            k: [k(0), k(1), k(4), k(5), k(6), k(7)],
            p,
        }),
        "equidistant" | "fisheye" | "Kannala Brandt4" if is_bare(4) => Ok(Distortion::Fisheye {
            k: [k(0), k(1), k(2), k(3)],
        }),
        _ => {
            let start: String = model.chars().take(40).collect();
            Err(format!(
                "`{start}` with {} numbers is none of plumb_bob, rational_polynomial and equidistant",
                coefficients.len()
            ))
        }
    }
}

/// From the frame `from` to the frame `to`, by the shortest path over `links`.
pub(super) fn transform_between(links: &[Link], from: &str, to: &str) -> Option<DAffine3> {
    let mut reached: Vec<(&str, DAffine3)> = vec![(from, DAffine3::IDENTITY)];
    let mut next = 0;
    while let Some(&(frame, frame_from_start)) = reached.get(next) {
        if frame == to {
            return Some(frame_from_start);
        }
        next += 1;
        for link in links {
            let (other, step) = if link.child == frame {
                (link.parent.as_str(), link.parent_from_child)
            } else if link.parent == frame {
                (link.child.as_str(), link.parent_from_child.inverse())
            } else {
                continue;
            };
            if !reached.iter().any(|(known, _)| *known == other) {
                reached.push((other, step * frame_from_start));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::recordings::recording::camera::Window;
    use glam::DVec3;
    use std::time::Duration;

    fn info(window: Window) -> CameraInfo {
        let k = [500.0, 0.0, 319.5, 0.0, 502.0, 239.5, 0.0, 0.0, 1.0];
        CameraInfo {
            frame_id: String::new(),
            size_px: [640, 480],
            model: String::new(),
            distortion: Vec::new(),
            k,
            p: [0.0; 12],
            window,
        }
    }

    /// The centre of a pixel of the image is the centre of the sensor pixels that it is made of.
    #[test]
    fn image_parts_see_what_the_full_image_sees() {
        let window = Window {
            binning: [2, 4],
            offset_px: [100, 40],
            size_px: [320, 240],
        };
        let sent_px = [160, 60];
        let mut notes = Vec::new();
        let mut camera = |window: Window, image_px| {
            let found = intrinsics("a", &info(window), image_px, &mut notes).unwrap();
            let ray = |pixel: DVec2| (pixel - found.principal_px) / found.focal_px;
            (ray(DVec2::new(7.0, 9.0)), found.for_size_px)
        };
        let (whole_ray, whole_px) = camera(Window::default(), Some([640, 480]));
        assert_eq!(whole_px, Some([640, 480]));
        let (ray, size_px) = camera(window, Some(sent_px));
        assert_eq!(size_px, Some(sent_px));
        // Pixels 14 and 15, and 36 to 39, of the region: 114.5 and 77.5 of the whole.
        let expected = (DVec2::new(114.5, 77.5) - DVec2::new(319.5, 239.5)) / DVec2::new(500.0, 502.0);
        assert!(ray.abs_diff_eq(expected, 1e-12), "{ray} {expected}");
        assert_eq!(camera(window, None), (ray, Some(sent_px)));
        // Whole images, even if a region is given; and empty regions.
        assert_eq!(camera(window, Some([640, 480])), (whole_ray, whole_px));
        let nothing = Window {
            size_px: [1, 1],
            ..window
        };
        assert_eq!(camera(nothing, None), (whole_ray, whole_px));
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn frames_are_joined_over_both_ends_of_links() {
        let link = |parent: &str, child: &str, x: f64| Link {
            parent: parent.to_owned(),
            child: child.to_owned(),
            parent_from_child: DAffine3::from_rotation_z(0.5 * x) * DAffine3::from_translation(DVec3::X * x),
            time: Duration::ZERO,
        };
        let links = [
            link("base", "depth", 1.0),
            link("base", "rail", 2.0),
            link("rail", "color", -0.5),
        ];
        let found = transform_between(&links, "depth", "color").unwrap();
        let [depth, rail, color] = links.map(|link| link.parent_from_child);
        let expected = color.inverse() * rail.inverse() * depth;
        assert!(found.abs_diff_eq(expected, 1e-12), "{found:?} {expected:?}");
        assert_eq!(transform_between(&[], "depth", "depth"), Some(DAffine3::IDENTITY));
        assert_eq!(transform_between(&[link("a", "b", 1.0)], "a", "c"), None);
    }

    #[test]
    fn lenses_are_recognised_by_their_ros_names() {
        let brown = lens("plumb_bob", &[0.1, -0.2, 0.001, 0.002, 0.3]);
        let (k, p) = ([0.1, -0.2, 0.3], [0.001, 0.002]);
        assert_eq!(brown, Ok(Distortion::Brown { k, p }));
        let rational = lens("rational_polynomial", &[1.0, 2.0, 0.001, 0.002, 3.0, 4.0, 5.0, 6.0]);
        let k = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(rational, Ok(Distortion::Rational { k, p }));
        let fisheye = lens("equidistant", &[0.1, 0.2, 0.3, 0.4]);
        assert_eq!(
            fisheye,
            Ok(Distortion::Fisheye {
                k: [0.1, 0.2, 0.3, 0.4]
            })
        );
        for model in ["plumb_bob", "", "Inverse Brown Conrady"] {
            assert_eq!(lens(model, &[0.0; 5]), Ok(Distortion::None));
        }
        assert!(
            lens("Inverse Brown Conrady", &[0.1; 5])
                .unwrap_err()
                .contains("Inverse")
        );
        assert!(lens("plumb_bob", &[0.1; 8]).is_err());
    }
}
