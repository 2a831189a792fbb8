//! An input image prepared for drawing: read, masked, undistorted, and as small as it has to be.

use super::mips::halved;
use super::photo_image::PhotoImage;
use super::undistort::{Extent, pinhole_of, undistort};
use crate::photos::error::PhotosError;
use crate::photos::sets::photo::{Photo, resized};
use crate::rgbd::Camera;
use glam::{DAffine3, DVec2, DVec3};

/// An input image through a pinhole.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparedPhoto {
    /// The pinhole; of the size of the image.
    pub camera: Camera,
    /// Coordinates of the camera from those of the world.
    pub camera_from_world: DAffine3,
    /// Undistorted pixels; alpha is 0 where the input image shows nothing.
    pub image: PhotoImage,
}

impl PreparedPhoto {
    /// Reads `photo`, takes its lens off it and halves it `halvings` times.
    ///
    /// # Errors
    /// The errors of [`PhotoImage::read`].
    pub fn read(photo: &Photo, extent: Extent, halvings: u32) -> Result<Self, PhotosError> {
        Ok(Self::of(photo, &PhotoImage::read(photo)?, extent, halvings))
    }

    /// Prepares an image that was already read or created.
    pub fn of(photo: &Photo, image: &PhotoImage, extent: Extent, halvings: u32) -> Self {
        let mut camera = pinhole_of(&photo.camera, extent);
        let mut image = undistort(image, &photo.camera, &camera);
        for _ in 0..halvings {
            image = halved(&image);
        }
        if let Ok(smaller) = resized(&camera, image.size_px()) {
            camera = smaller;
        }
        Self {
            camera,
            camera_from_world: photo.camera_from_world,
            image,
        }
    }

    /// The mean colour, of 255, of the square of 2 · `radius_px` + 1 pixels around where a point of the world is;
    /// `None` where the square is not on the image, or not all of it is of the object.
    pub fn color_around(&self, point_in_world: DVec3, radius_px: u32) -> Option<[f32; 3]> {
        let at = self
            .camera
            .pixel(self.camera_from_world.transform_point3(point_in_world))?;
        let [width, height] = self.image.size_px().map(f64::from);
        let radius = f64::from(radius_px);
        let is_inside = at.cmpge(DVec2::splat(radius)).all()
            && at.cmple(DVec2::new(width - 1.0 - radius, height - 1.0 - radius)).all();
        if !is_inside {
            return None;
        }
        let (column, row) = (at.x.round() as usize, at.y.round() as usize);
        let radius = radius_px as usize;
        let columns = column.saturating_sub(radius)..(column + radius + 1).min(self.image.width());
        let mut sum = [0.0; 3];
        let mut count = 0.0;
        for row in row.saturating_sub(radius)..(row + radius + 1).min(self.image.size_px()[1] as usize) {
            for column in columns.clone() {
                let [r, g, b, alpha] = self.image.pixels()[row * self.image.width() + column];
                if alpha < u8::MAX {
                    return None;
                }
                for (sum, channel) in sum.iter_mut().zip([r, g, b]) {
                    *sum += f32::from(channel);
                }
                count += 1.0;
            }
        }
        Some(sum.map(|sum| sum / count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::Distortion;

    /// An image whose red is its column.
    fn prepared(halvings: u32) -> PreparedPhoto {
        let lens = Distortion::None;
        let photo = Photo {
            name: "a".into(),
            path: "a".into(),
            camera: Camera::new([100, 50], DVec2::splat(100.0), DVec2::new(49.5, 24.5), lens).unwrap(),
            camera_from_world: DAffine3::IDENTITY,
            mask: None,
            depth: None,
            depth_range: None,
        };
        let pixels = (0..5000).map(|at| [2 * (at % 100) as u8, 7, 9, 255]).collect();
        let image = PhotoImage::new([100, 50], pixels).unwrap();
        PreparedPhoto::of(&photo, &image, Extent::Same, halvings)
    }

    #[test]
    fn downscaled_images_show_the_same_at_the_same_place() {
        for halvings in 0..3 {
            let photo = prepared(halvings);
            assert_eq!(photo.image.size_px(), photo.camera.size_px());
            for x in [-0.3, 0.0, 0.2] {
                let pixel = photo.camera.pixel(DVec3::new(x, 0.0, 1.0)).unwrap();
                let red = photo.image.bilinear(pixel)[0];
                let expected = 2.0 * (100.0 * x as f32 + 49.5);
                assert!((red - expected).abs() < 1.5, "{red}, expected {expected} at {halvings}");
            }
        }
    }

    #[test]
    fn colors_around_a_point_need_a_complete_square() {
        let photo = prepared(0);
        assert_eq!(
            photo.color_around(DVec3::new(0.005, 0.005, 1.0), 2),
            Some([100.0, 7.0, 9.0])
        );
        assert_eq!(photo.color_around(DVec3::new(-0.49, 0.0, 1.0), 2), None);
        assert_eq!(photo.color_around(DVec3::new(0.0, 0.0, -1.0), 0), None);
    }
}
