//! Numbers of cameras, before it is known how large their images are.

use crate::rgbd::{Camera, CameraError, ColorCamera, Distortion, Rig};
use glam::{DAffine3, DVec2};

/// Camera intrinsics before the size of its images is known.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::source::rgbd) struct Intrinsics {
    pub(in crate::source::rgbd) focal_px: DVec2,
    pub(in crate::source::rgbd) principal_px: DVec2,
    pub(in crate::source::rgbd) distortion: Distortion,
    /// The size of the images that the numbers are for.
    pub(in crate::source::rgbd) for_size_px: Option<[u32; 2]>,
}

/// Calibration of a sensor's cameras.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::source::rgbd) struct Calibration {
    pub(in crate::source::rgbd) depth: Intrinsics,
    /// Colour camera calibration, if its position or lens differs from the depth camera's.
    pub(in crate::source::rgbd) color: Option<(Intrinsics, DAffine3)>,
    /// Units of the depth images per metre, if it states that too.
    pub(in crate::source::rgbd) units_per_metre: Option<f64>,
    /// Human-readable origin of the calibration.
    pub(in crate::source::rgbd) because: String,
    /// True if the calibration is assumed because nothing in the recording states it.
    pub(in crate::source::rgbd) is_assumed: bool,
}

impl Intrinsics {
    /// Without distortion.
    pub(in crate::source::rgbd) fn pinhole([fx, fy, cx, cy]: [f64; 4], for_size_px: Option<[u32; 2]>) -> Self {
        Self {
            focal_px: DVec2::new(fx, fy),
            principal_px: DVec2::new(cx, cy),
            distortion: Distortion::None,
            for_size_px,
        }
    }

    /// Returns the intrinsics of `camera`.
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
    pub(super) fn camera(&self, size_px: [u32; 2]) -> Result<Camera, NoCamera> {
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
        // Pixel centres are at integers: the corner of the image is at −½ in every size.
        let principal = scale * (self.principal_px + 0.5) - 0.5;
        Camera::new(size_px, scale * self.focal_px, principal, self.distortion).map_err(NoCamera::Numbers)
    }
}

/// Reasons why there is no camera for an image.
pub(in crate::source::rgbd) enum NoCamera {
    /// Another size was expected.
    Size([u32; 2]),
    Numbers(CameraError),
}

impl Calibration {
    /// Creates the calibration of a depth camera alone.
    pub(in crate::source::rgbd) fn of_depth(depth: Intrinsics, because: impl Into<String>) -> Self {
        Self {
            depth,
            color: None,
            units_per_metre: None,
            because: because.into(),
            is_assumed: false,
        }
    }

    /// The numbers of cameras that are known already.
    pub(in crate::source::rgbd) fn of_rig(rig: &Rig, because: impl Into<String>) -> Self {
        let color = rig.color.as_ref();
        Self {
            color: color.map(|color| (Intrinsics::of_camera(&color.camera), color.color_from_depth)),
            ..Self::of_depth(Intrinsics::of_camera(&rig.depth), because)
        }
    }

    /// Returns the default calibration for recordings of a kind that do not state their own: images of 640 × 480.
    pub(in crate::source::rgbd) fn usual(numbers: [f64; 4], kind: &str) -> Self {
        Self {
            is_assumed: true,
            ..Self::of_depth(
                Intrinsics::pinhole(numbers, Some([640, 480])),
                format!("the usual camera of {kind}"),
            )
        }
    }

    /// The cameras of images of these sizes.
    pub(in crate::source::rgbd) fn rig(&self, depth_px: [u32; 2], color_px: Option<[u32; 2]>) -> Result<Rig, NoCamera> {
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
}
