//! Cameras, from the files that programs write.

mod json;
mod text;
mod xml;

use super::error::RgbdError;
use super::folder::{has_extension, name_of};
use super::text::{array, read};
use crate::rgbd::{Camera, CameraError, ColorCamera, Distortion, Rig};
use glam::{DAffine3, DVec2};
use std::path::Path;

/// What is said of a camera before it is known how large its images are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Intrinsics {
    pub(super) focal_px: DVec2,
    pub(super) principal_px: DVec2,
    pub(super) distortion: Distortion,
    /// The size of the images that the numbers are for.
    pub(super) for_size_px: Option<[u32; 2]>,
}

/// What is said of the cameras of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Calibration {
    pub(super) depth: Intrinsics,
    /// Of colours, where those are from another place or lens.
    pub(super) color: Option<(Intrinsics, DAffine3)>,
    /// Units of the depth images that are a metre, if it says that too.
    pub(super) units_per_metre: Option<f64>,
    /// Where it is from, for people.
    pub(super) because: String,
    /// Whether nothing in the recording says it.
    pub(super) is_assumed: bool,
}

impl Intrinsics {
    /// Without distortion.
    pub(super) fn pinhole([fx, fy, cx, cy]: [f64; 4], for_size_px: Option<[u32; 2]>) -> Self {
        Self {
            focal_px: DVec2::new(fx, fy),
            principal_px: DVec2::new(cx, cy),
            distortion: Distortion::None,
            for_size_px,
        }
    }

    /// fx, fy, cx, cy in a matrix of numbers.
    pub(super) fn pinhole_of(numbers: &[f64]) -> Option<[f64; 4]> {
        text::pinhole_of(numbers)
    }

    /// Those of `camera`.
    fn of_camera(camera: &Camera) -> Self {
        Self {
            focal_px: camera.focal_px(),
            principal_px: camera.principal_px(),
            distortion: *camera.distortion(),
            for_size_px: Some(camera.size_px()),
        }
    }

    /// The camera of images of `size_px`, which may be those that the numbers are for in another size, but of the same
    /// shape; the size that was expected otherwise.
    fn camera(&self, size_px: [u32; 2]) -> Result<Camera, NoCamera> {
        let scale = match self.for_size_px {
            Some([width, height]) if [width, height] != size_px => {
                let scales = [
                    f64::from(size_px[0]) / f64::from(width),
                    f64::from(size_px[1]) / f64::from(height),
                ];
                if scales[0] != scales[1] {
                    return Err(NoCamera::Size([width, height]));
                }
                scales[0]
            }
            _ => 1.0,
        };
        // Centres of pixels are at integers: the corner of the image is at −½ in every size.
        let principal = scale * (self.principal_px + 0.5) - 0.5;
        Camera::new(size_px, scale * self.focal_px, principal, self.distortion).map_err(NoCamera::Numbers)
    }
}

/// Why there is no camera for an image.
pub(super) enum NoCamera {
    /// Another size was expected.
    Size([u32; 2]),
    Numbers(CameraError),
}

impl Calibration {
    /// Of a depth camera alone.
    pub(super) fn of_depth(depth: Intrinsics, because: impl Into<String>) -> Self {
        Self {
            depth,
            color: None,
            units_per_metre: None,
            because: because.into(),
            is_assumed: false,
        }
    }

    /// The numbers of cameras that are known already.
    pub(super) fn of_rig(rig: &Rig, because: impl Into<String>) -> Self {
        let color = rig.color.as_ref();
        Self {
            color: color.map(|color| (Intrinsics::of_camera(&color.camera), color.color_from_depth)),
            ..Self::of_depth(Intrinsics::of_camera(&rig.depth), because)
        }
    }

    /// What holds for recordings of a kind unless they say otherwise: images of 640 × 480.
    pub(super) fn usual(numbers: [f64; 4], kind: &str) -> Self {
        Self {
            is_assumed: true,
            ..Self::of_depth(
                Intrinsics::pinhole(numbers, Some([640, 480])),
                format!("the usual camera of {kind}"),
            )
        }
    }

    /// The cameras of images of these sizes.
    pub(super) fn rig(&self, depth_px: [u32; 2], color_px: Option<[u32; 2]>) -> Result<Rig, NoCamera> {
        let color = match (&self.color, color_px) {
            (Some((intrinsics, color_from_depth)), Some(size)) => Some(ColorCamera {
                camera: intrinsics.camera(size)?,
                color_from_depth: *color_from_depth,
            }),
            _ => None,
        };
        Ok(Rig {
            depth: self.depth.camera(depth_px)?,
            color,
        })
    }

    /// What a person names: `fx,fy,cx,cy`, or a file.
    pub(super) fn of_option(text: &str) -> Result<Self, RgbdError> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        match numbers.map(<[f64; 4]>::try_from) {
            Ok(Ok(numbers)) => Ok(Self::of_depth(Intrinsics::pinhole(numbers, None), "--intrinsics")),
            Ok(Err(numbers)) => Err(RgbdError::Calibration {
                path: text.into(),
                reason: format!("it is {} numbers", numbers.len()),
            }),
            Err(_) => Self::read(Path::new(text)),
        }
    }

    /// What the file at `path` says, of any of the formats of [`RgbdError::Calibration`].
    pub(super) fn read(path: &Path) -> Result<Self, RgbdError> {
        let wrong = |reason: String| RgbdError::Calibration {
            path: path.to_owned(),
            reason,
        };
        let because = path.display().to_string();
        if has_extension(name_of(path), &["npy"]) {
            let (_, numbers) = array(path)?;
            let pinhole =
                text::pinhole_of(&numbers).ok_or_else(|| wrong(format!("it has {} numbers", numbers.len())))?;
            return Ok(Self::of_depth(Intrinsics::pinhole(pinhole, None), because));
        }
        let text = read(path)?;
        let calibration = match text.trim_start().chars().next() {
            Some('{') => json::calibration(&text, because).map_err(wrong)?,
            Some('<') => xml::calibration(&text, because).map_err(wrong)?,
            _ => text::calibration(path, &text, because)?,
        };
        // A camera that is none is said here, and not at each frame.
        let sizes = [
            &Some(&calibration.depth),
            &calibration.color.as_ref().map(|(color, _)| color),
        ];
        for intrinsics in sizes.into_iter().flatten() {
            let size = intrinsics.for_size_px.unwrap_or([640, 480]);
            if let Err(NoCamera::Numbers(error)) = intrinsics.camera(size) {
                return Err(wrong(error.to_string()));
            }
        }
        Ok(calibration)
    }
}
