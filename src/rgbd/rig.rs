//! The cameras of a sensor, and where the sensor was.

use super::camera::Camera;
use super::registration::ColorCamera;
use glam::DAffine3;
use std::sync::Arc;

/// A depth camera and the camera that its colours come from.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The camera of the depth image.
    pub depth: Camera,
    /// The camera of the colour image; `None` where that is seen from the same place by the same lens, pixel by pixel.
    pub color: Option<ColorCamera>,
}

/// Sensor that captured a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Its cameras.
    pub rig: Arc<Rig>,
    /// Pose of the sensor, as far as it is known: from the depth camera's frame to the world's.
    pub world_from_camera: Option<DAffine3>,
}
