//! Pictures that are not upright, or whose middle is not on the view axis.

use glam::{DMat3, DVec2};

/// Where the picture of a camera is on its view axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PicturePlane {
    /// Turn of the camera about its view axis, degrees; grows as the picture turns clockwise.
    pub roll_deg: f64,
    /// Where the view axis meets the picture: from its middle to the right and upwards, in heights of the picture.
    pub shift: DVec2,
    /// What a length is wide in pixels where it is one pixel high.
    pub pixel_aspect: f64,
}

impl PicturePlane {
    /// Upright, with the view axis in the middle and square pixels.
    pub const CENTERED: Self = Self {
        roll_deg: 0.0,
        shift: DVec2::ZERO,
        pixel_aspect: 1.0,
    };

    /// The same turn, with the view axis in the middle and square pixels.
    #[must_use]
    pub fn centered(self) -> Self {
        Self {
            roll_deg: self.roll_deg,
            ..Self::CENTERED
        }
    }

    /// Columns right, up, back of the picture in the axes of the upright one.
    pub(in crate::scene) fn rotation(&self) -> DMat3 {
        DMat3::from_rotation_z(self.roll_deg.to_radians())
    }

    /// [`crate::scene::ViewTransform::center_ndc`] of a picture of this size.
    pub(in crate::scene) fn center_ndc(&self, [width, height]: [f64; 2]) -> DVec2 {
        2.0 * self.shift * DVec2::new(height / width, 1.0)
    }
}

impl Default for PicturePlane {
    fn default() -> Self {
        Self::CENTERED
    }
}
