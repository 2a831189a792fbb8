//! Picture plane of images that are not upright, or whose centre is not on the view axis.

use glam::{DMat3, DVec2};

/// Picture plane: position of a camera's image on its view axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PicturePlane {
    /// Turn of the camera about its view axis, degrees; grows as the image turns clockwise.
    pub roll_deg: f64,
    /// Principal point offset: where the view axis meets the image, from its centre to the right and upwards, in image
    /// heights.
    // Costs the renderers nothing: they already drew parts of large images, whose centres are off-axis.
    pub shift: DVec2,
    /// Pixel aspect ratio: the width in pixels of a length that is one pixel high.
    pub pixel_aspect: f64,
}

impl PicturePlane {
    /// Upright, with the view axis in the centre and square pixels.
    pub const CENTERED: Self = Self {
        roll_deg: 0.0,
        shift: DVec2::ZERO,
        pixel_aspect: 1.0,
    };

    /// Returns a picture plane with the same rotation, the view axis in the centre and square pixels.
    #[must_use]
    pub fn centered(self) -> Self {
        Self {
            roll_deg: self.roll_deg,
            ..Self::CENTERED
        }
    }

    /// Columns right, up, back of the image in the axes of the upright one.
    pub(in crate::scene) fn rotation(&self) -> DMat3 {
        DMat3::from_rotation_z(self.roll_deg.to_radians())
    }

    /// [`crate::scene::ViewTransform::center_ndc`] of an image of this size.
    pub(in crate::scene) fn center_ndc(&self, [width, height]: [f64; 2]) -> DVec2 {
        2.0 * self.shift * DVec2::new(height / width, 1.0)
    }
}

impl Default for PicturePlane {
    fn default() -> Self {
        Self::CENTERED
    }
}
