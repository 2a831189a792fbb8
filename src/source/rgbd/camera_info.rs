//! Cameras as messages of ROS tell them: lenses, and the way from one frame of reference to another.

use super::calibration::Intrinsics;
use super::error::RgbdError;
use crate::io::recording::camera::{CameraInfo, Link};
use crate::rgbd::Distortion;
use glam::{DAffine3, DVec2};

/// The camera of images of `topic`. Names of rectified images say so: they have the lens of the projection, none.
pub(super) fn intrinsics(topic: &str, info: &CameraInfo, notes: &mut Vec<String>) -> Result<Intrinsics, RgbdError> {
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
    Ok(Intrinsics {
        focal_px: DVec2::new(fx, fy),
        principal_px: DVec2::new(cx, cy),
        distortion: distortion.unwrap_or_else(|reason| {
            notes.push(format!("the lens of topic {topic} is left out: {reason}"));
            Distortion::None
        }),
        for_size_px: Some(info.size_px).filter(|size| !size.contains(&0)),
    })
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
        // Beyond eight are thin prisms and tilts.
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

/// From the frame `from` to the frame `to`, by the shortest way over `links`.
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
    use glam::DVec3;

    #[test]
    fn frames_are_joined_over_both_ends_of_links() {
        let link = |parent: &str, child: &str, x: f64| Link {
            parent: parent.to_owned(),
            child: child.to_owned(),
            parent_from_child: DAffine3::from_rotation_z(0.5 * x) * DAffine3::from_translation(DVec3::X * x),
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
    fn lenses_by_the_names_of_ros() {
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
