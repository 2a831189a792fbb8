//! Camera intrinsics as a format states them, before the image size is known.
//!
//! Half of the formats do not store the size of their images: the principal point is given relative to the image
//! centre, a focal length by the field of view. Also, images are often shipped smaller than they were calibrated. So a
//! camera is created only after its image file has been inspected.

use super::photo::resized;
use crate::rgbd::{Camera, Distortion};
use glam::DVec2;

/// Camera intrinsics as stated by a format.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::photos) struct Lens {
    /// The size of the image that was calibrated, where the format holds it.
    pub(in crate::photos) size_px: Option<[u32; 2]>,
    pub(in crate::photos) focal: Focal,
    /// The origin of pixel coordinates: of the principal point, and of tracks.
    pub(in crate::photos) origin: Origin,
    pub(in crate::photos) principal_px: DVec2,
    pub(in crate::photos) distortion: Distortion,
}

/// A focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::photos) enum Focal {
    Pixels(DVec2),
    /// The angle that the width of the image takes, in radians.
    WidthAngle(f64),
    /// The focal length of its height.
    HeightAngle(f64),
}

/// Origin of the pixel coordinates of a format, which increase to the right and down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::photos) enum Origin {
    /// Centre of the first pixel.
    FirstPixel,
    /// Corner of the first pixel: its centre is at (½, ½).
    Corner,
    /// Centre of the image.
    Center,
}

impl Lens {
    /// A pinhole.
    pub(in crate::photos) fn pinhole(
        size_px: Option<[u32; 2]>,
        focal_px: DVec2,
        origin: Origin,
        principal_px: DVec2,
    ) -> Self {
        Self {
            size_px,
            focal: Focal::Pixels(focal_px),
            origin,
            principal_px,
            distortion: Distortion::None,
        }
    }

    /// The camera of an image of `image_px` pixels, or the reason why there is none.
    pub(in crate::photos) fn camera(&self, image_px: [u32; 2]) -> Result<Camera, String> {
        let size_px = self.size_px.unwrap_or(image_px);
        let focal_px = match self.focal {
            Focal::Pixels(focal_px) => focal_px,
            Focal::WidthAngle(angle) => DVec2::splat(0.5 * f64::from(size_px[0]) / (0.5 * angle).tan()),
            Focal::HeightAngle(angle) => DVec2::splat(0.5 * f64::from(size_px[1]) / (0.5 * angle).tan()),
        };
        let principal_px = self.counted_from_first(self.principal_px, size_px);
        let camera =
            Camera::new(size_px, focal_px, principal_px, self.distortion).map_err(|error| error.to_string())?;
        if size_px == image_px {
            return Ok(camera);
        }
        if !is_same_shape(size_px, image_px) {
            let [width, height] = image_px;
            return Err(format!(
                "it has {width} × {height} pixels but was calibrated with {} × {}: put the calibrated image there",
                size_px[0], size_px[1]
            ));
        }
        resized(&camera, image_px).map_err(|error| error.to_string())
    }

    /// A pixel of the format, in an image of `image_px` pixels whose centres are at integers.
    pub(in crate::photos) fn pixel(&self, at: DVec2, image_px: [u32; 2]) -> DVec2 {
        let size_px = self.size_px.unwrap_or(image_px);
        let at = self.counted_from_first(at, size_px);
        if size_px == image_px {
            return at;
        }
        (at + 0.5) * sides(image_px) / sides(size_px) - 0.5
    }

    fn counted_from_first(&self, at: DVec2, size_px: [u32; 2]) -> DVec2 {
        match self.origin {
            Origin::FirstPixel => at,
            Origin::Corner => at - 0.5,
            Origin::Center => 0.5 * (sides(size_px) - 1.0) + at,
        }
    }
}

fn sides([width, height]: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(width), f64::from(height))
}

/// Returns true if one size is a scaled version of the other, i.e. both have the same aspect ratio up to the rounding
/// of the sides to pixels.
fn is_same_shape([width, height]: [u32; 2], [other_width, other_height]: [u32; 2]) -> bool {
    let x = f64::from(other_width) / f64::from(width);
    let y = f64::from(other_height) / f64::from(height);
    let rounding = 1.0 / f64::from(width.max(1)) + 1.0 / f64::from(height.max(1));
    (x - y).abs() <= rounding.max(x.max(y) * rounding)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(origin: Origin, principal_px: DVec2) -> Lens {
        Lens::pinhole(Some([640, 480]), DVec2::splat(500.0), origin, principal_px)
    }

    #[test]
    fn the_center_of_an_image_is_between_its_pixels() {
        let center = DVec2::new(319.5, 239.5);
        for (origin, principal_px) in [
            (Origin::FirstPixel, center),
            (Origin::Corner, DVec2::new(320.0, 240.0)),
            (Origin::Center, DVec2::ZERO),
        ] {
            let lens = lens(origin, principal_px);
            assert_eq!(lens.camera([640, 480]).unwrap().principal_px(), center, "{origin:?}");
            assert_eq!(lens.pixel(principal_px, [640, 480]), center, "{origin:?}");
            assert_eq!(
                lens.pixel(principal_px, [320, 240]),
                DVec2::new(159.5, 119.5),
                "{origin:?}"
            );
        }
    }

    #[test]
    fn an_angle_of_view_becomes_a_focal_length_once_the_width_is_known() {
        let mut lens = lens(Origin::Center, DVec2::ZERO);
        lens.size_px = None;
        lens.focal = Focal::WidthAngle(2.0 * 0.5_f64.atan());
        assert_eq!(lens.camera([800, 600]).unwrap().focal_px().round(), DVec2::splat(800.0));
        lens.focal = Focal::HeightAngle(2.0 * 0.5_f64.atan());
        assert_eq!(lens.camera([800, 600]).unwrap().focal_px().round(), DVec2::splat(600.0));
        lens.focal = Focal::WidthAngle(0.0);
        assert!(lens.camera([800, 600]).unwrap_err().contains("focal lengths"));
    }

    #[test]
    fn downscaled_images_have_scaled_cameras() {
        let lens = lens(Origin::Center, DVec2::new(8.0, 0.0));
        let camera = lens.camera([160, 120]).unwrap();
        assert_eq!(camera.principal_px(), DVec2::new(81.5, 59.5));
        assert_eq!(camera.focal_px(), DVec2::splat(125.0));
        // 641 / 4 and 479 / 4, rounded in either direction.
        let odd = Lens {
            size_px: Some([641, 479]),
            ..lens.clone()
        };
        for size in [[160, 120], [161, 119], [160, 119]] {
            assert!(odd.camera(size).is_ok(), "{size:?}");
        }
        for size in [[480, 640], [640, 360], [160, 100]] {
            assert!(
                lens.camera(size).unwrap_err().contains("calibrated with 640 × 480"),
                "{size:?}"
            );
        }
    }
}
