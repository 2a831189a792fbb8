//! Posed image: its file, its camera model and its camera pose.
//!
//! Camera coordinates are x to the right, y down, z forward; centres of pixels are at integers. Readers convert the
//! conventions of their formats to these, so that nothing behind them has to know any other.

use crate::photos::depth_file::DepthFile;
use crate::rgbd::{Camera, CameraError};
use glam::{DAffine3, DVec2, DVec3};
use std::path::PathBuf;

/// Image with a known camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    /// Its name in the file that lists it, as it is written there.
    pub name: String,
    /// Image file; empty if its camera has no image for the time step ([`Photo::has_file`]).
    pub path: PathBuf,
    /// The camera, of the size of the file's image.
    pub camera: Camera,
    /// Coordinates of the camera from those of the world: a rotation and a translation, in the unit of the world.
    pub camera_from_world: DAffine3,
    /// A mask image: pixels of the object are bright, all others dark.
    pub mask: Option<PathBuf>,
    /// Depth map information, if any.
    pub depth: Option<DepthFile>,
    /// Depths between which all that it shows lies, in the unit of the world, if the format has it: the nearer is above
    /// 0, the other one farther.
    pub depth_range: Option<[f64; 2]>,
}

impl Photo {
    /// Returns true if there is an image, not just a camera that has none for a time step.
    pub fn has_file(&self) -> bool {
        !self.path.as_os_str().is_empty()
    }

    /// Returns the camera centre in world coordinates.
    pub fn center(&self) -> DVec3 {
        center_of(self.camera_from_world)
    }

    /// The direction that its camera looked to, of length 1, in the world.
    pub fn forward(&self) -> DVec3 {
        self.camera_from_world.matrix3.row(2)
    }

    /// Projects a world point into the image, regardless of the image bounds; `None` behind the camera and outside the
    /// field of view of its lens.
    pub fn project(&self, point_in_world: DVec3) -> Option<DVec2> {
        self.camera
            .pixel(self.camera_from_world.transform_point3(point_in_world))
    }

    /// The pixel that shows a point of the world, if it is inside the image. Occlusion is not checked.
    pub fn pixel(&self, point_in_world: DVec3) -> Option<DVec2> {
        self.project(point_in_world)
            .filter(|&pixel| self.camera.contains(pixel))
    }

    /// Distance of a point of the world along the axis of the camera; negative behind it.
    pub fn depth_of(&self, point_in_world: DVec3) -> f64 {
        self.camera_from_world.transform_point3(point_in_world).z
    }
}

/// Returns the camera centre in world coordinates. Precondition: `camera_from_world` is a rigid transform (a rotation
/// and a translation).
pub fn center_of(camera_from_world: DAffine3) -> DVec3 {
    -(camera_from_world.matrix3.transpose() * camera_from_world.translation)
}

/// The camera of the same image with `size_px` pixels: borders stay borders, so centres of pixels move.
///
/// # Errors
/// [`CameraError`], for an image without pixels.
pub fn resized(camera: &Camera, size_px: [u32; 2]) -> Result<Camera, CameraError> {
    let size = |[width, height]: [u32; 2]| DVec2::new(f64::from(width), f64::from(height));
    let scale = size(size_px) / size(camera.size_px());
    let principal_px = (camera.principal_px() + 0.5) * scale - 0.5;
    Camera::new(size_px, camera.focal_px() * scale, principal_px, *camera.distortion())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::Distortion;
    use glam::DQuat;

    fn photo() -> Photo {
        let camera = Camera::new(
            [640, 480],
            DVec2::splat(500.0),
            DVec2::new(319.5, 239.5),
            Distortion::None,
        );
        let turn = DQuat::from_euler(glam::EulerRot::YXZ, 0.4, -0.2, 0.1);
        Photo {
            name: "a.jpg".into(),
            path: "a.jpg".into(),
            camera: camera.unwrap(),
            camera_from_world: DAffine3::from_rotation_translation(turn, DVec3::new(0.3, -0.1, 2.0)),
            mask: None,
            depth: None,
            depth_range: None,
        }
    }

    #[test]
    fn a_camera_is_at_the_origin_of_its_own_coordinates() {
        let photo = photo();
        assert!(photo.camera_from_world.transform_point3(photo.center()).length() < 1e-12);
        let ahead = photo.center() + 3.0 * photo.forward();
        assert!((photo.depth_of(ahead) - 3.0).abs() < 1e-12);
        let pixel = photo.pixel(ahead).unwrap();
        assert!(pixel.distance(photo.camera.principal_px()) < 1e-9, "{pixel}");
        assert_eq!(photo.project(photo.center() - photo.forward()), None);
    }

    #[test]
    fn a_downscaled_image_retains_its_borders() {
        let photo = photo();
        let half = resized(&photo.camera, [320, 240]).unwrap();
        // The left border, −½, stays the left border; the centre of the first four pixels becomes the first pixel.
        assert_eq!(half.principal_px(), DVec2::new(159.5, 119.5));
        assert_eq!(half.focal_px(), DVec2::splat(250.0));
        let wide = resized(&photo.camera, [640, 960]).unwrap();
        assert_eq!(wide.focal_px(), DVec2::new(500.0, 1000.0));
        assert!(resized(&photo.camera, [0, 1]).is_err());
    }
}
