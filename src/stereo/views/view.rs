//! Posed images with their cameras.

use crate::rgbd::{Camera, ColorImage, Distortion};
use crate::stereo::StereoError;
use glam::{DAffine3, DMat3, DVec2, DVec3};

/// Tolerance of the columns of a rotation: files have them with a few digits.
const ROTATION_ERROR: f64 = 1e-4;

/// Posed image and the pinhole camera that took it.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Input image.
    pub image: &'a ColorImage,
    /// A pinhole of its size; centres of pixels are at integers.
    pub camera: &'a Camera,
    /// A rotation and a translation into the frame of the camera: x to the right, y down, z forward.
    pub camera_from_world: DAffine3,
}

impl View<'_> {
    /// # Errors
    /// [`StereoError`] for a requirement that this view does not meet; `index` is its place among the views.
    pub(in crate::stereo) fn check(&self, index: usize) -> Result<(), StereoError> {
        let (image, camera) = (self.image.size_px(), self.camera.size_px());
        if image != camera {
            return Err(StereoError::OtherCamera {
                view: index,
                image,
                camera,
            });
        }
        check_pinhole(self.camera, self.camera_from_world, index)
    }
}

/// # Errors
/// [`StereoError::NoPinhole`], [`StereoError::NoPose`].
pub(in crate::stereo) fn check_pinhole(
    camera: &Camera,
    camera_from_world: DAffine3,
    index: usize,
) -> Result<(), StereoError> {
    if *camera.distortion() != Distortion::None {
        return Err(StereoError::NoPinhole { view: index });
    }
    let rotation = camera_from_world.matrix3;
    let off = rotation * rotation.transpose() - DMat3::IDENTITY;
    let is_rotation =
        off.to_cols_array().iter().all(|entry| entry.abs() <= ROTATION_ERROR) && rotation.determinant() > 0.0;
    if is_rotation && camera_from_world.translation.is_finite() {
        Ok(())
    } else {
        Err(StereoError::NoPose { view: index })
    }
}

/// Pixels from directions of length 1 along z.
pub(in crate::stereo) fn pixels_from_rays(camera: &Camera) -> DMat3 {
    let (focal, principal) = (camera.focal_px(), camera.principal_px());
    DMat3::from_cols(
        DVec3::new(focal.x, 0.0, 0.0),
        DVec3::new(0.0, focal.y, 0.0),
        principal.extend(1.0),
    )
}

/// A pixel through a homography, `None` where it leads behind the camera.
pub(in crate::stereo) fn through(homography: &DMat3, pixel: DVec2) -> Option<DVec2> {
    let to = *homography * pixel.extend(1.0);
    (to.z > 0.0).then(|| to.truncate() / to.z)
}
