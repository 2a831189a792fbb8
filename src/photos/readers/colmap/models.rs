//! The camera models of COLMAP by number and name, and the supported ones.
//!
//! Models 0 to 6 are pinholes with the polynomials that `rgbd` has. Others are known by name, to be refused by it: an
//! image through a lens that is not understood would be drawn in the wrong place.

use crate::photos::sets::lens::{Focal, Lens, Origin};
use crate::rgbd::Distortion;
use glam::DVec2;

/// A model.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) name: &'static str,
    /// Numbers that a camera of it has.
    pub(super) count: usize,
    lens: Option<MakeLens>,
}

/// fx, fy, cx, cy and the lens of the numbers of a camera.
type MakeLens = fn(&[f64]) -> ([f64; 4], Distortion);

/// Models by number.
const MODELS: [Model; 18] = [
    Model::shown("SIMPLE_PINHOLE", 3, |p| (one_focal(p), Distortion::None)),
    Model::shown("PINHOLE", 4, |p| (two_focals(p), Distortion::None)),
    Model::shown("SIMPLE_RADIAL", 4, |p| {
        (one_focal(p), brown([p[3], 0.0, 0.0], [0.0; 2]))
    }),
    Model::shown("RADIAL", 5, |p| (one_focal(p), brown([p[3], p[4], 0.0], [0.0; 2]))),
    Model::shown("OPENCV", 8, |p| (two_focals(p), brown([p[4], p[5], 0.0], [p[6], p[7]]))),
    Model::shown("OPENCV_FISHEYE", 8, |p| {
        let k = [p[4], p[5], p[6], p[7]];
        (two_focals(p), Distortion::Fisheye { k })
    }),
    Model::shown("FULL_OPENCV", 12, |p| {
        let k = [p[4], p[5], p[8], p[9], p[10], p[11]];
        let p_ = [p[6], p[7]];
        (two_focals(p), Distortion::Rational { k, p: p_ })
    }),
    Model::refused("FOV", 5),
    Model::refused("SIMPLE_RADIAL_FISHEYE", 4),
    Model::refused("RADIAL_FISHEYE", 5),
    Model::refused("THIN_PRISM_FISHEYE", 12),
    Model::refused("RAD_TAN_THIN_PRISM_FISHEYE", 16),
    Model::refused("SIMPLE_DIVISION", 4),
    Model::refused("DIVISION", 5),
    Model::refused("SIMPLE_FISHEYE", 3),
    Model::refused("FISHEYE", 4),
    Model::refused("EUCM", 6),
    Model::refused("EQUIRECTANGULAR", 2),
];

fn one_focal(p: &[f64]) -> [f64; 4] {
    [p[0], p[0], p[1], p[2]]
}

fn two_focals(p: &[f64]) -> [f64; 4] {
    [p[0], p[1], p[2], p[3]]
}

fn brown(k: [f64; 3], p: [f64; 2]) -> Distortion {
    if k == [0.0; 3] && p == [0.0; 2] {
        Distortion::None
    } else {
        Distortion::Brown { k, p }
    }
}

impl Model {
    const fn shown(name: &'static str, count: usize, lens: MakeLens) -> Self {
        Self {
            name,
            count,
            lens: Some(lens),
        }
    }

    const fn refused(name: &'static str, count: usize) -> Self {
        Self {
            name,
            count,
            lens: None,
        }
    }

    /// The model of this number.
    pub(super) fn of_number(number: i32) -> Option<&'static Self> {
        MODELS.get(usize::try_from(number).ok()?)
    }

    /// The model of this name.
    pub(super) fn of_name(name: &str) -> Option<&'static Self> {
        MODELS.iter().find(|model| model.name == name)
    }

    /// The camera of these numbers, or why it is not shown.
    pub(super) fn lens(&self, size: [u64; 2], numbers: &[f64]) -> Result<Lens, String> {
        let Some(lens) = self.lens else {
            return Err(refusal(self.name));
        };
        if numbers.len() != self.count {
            let found = numbers.len();
            return Err(format!(
                "its camera, {}, has {} numbers, found {found}",
                self.name, self.count
            ));
        }
        let ([fx, fy, cx, cy], distortion) = lens(numbers);
        let side = |side: u64| u32::try_from(side).map_err(|_| format!("its camera has an image {side} pixels wide"));
        Ok(Lens {
            size_px: Some([side(size[0])?, side(size[1])?]),
            focal: Focal::Pixels(DVec2::new(fx, fy)),
            origin: Origin::Corner,
            principal_px: DVec2::new(cx, cy),
            distortion,
        })
    }
}

/// The reason why a camera of the model `name` is not shown, with advice.
pub(super) fn refusal(name: &str) -> String {
    let shown: Vec<&str> = MODELS
        .iter()
        .filter(|model| model.lens.is_some())
        .map(|model| model.name)
        .collect();
    format!(
        "its camera model is {name}, expected {}: undistort the images first",
        shown.join(", ")
    )
}
