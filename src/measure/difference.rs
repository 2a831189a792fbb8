//! Image difference: the pixels in which two images differ, and the maximum difference.

use super::{SizeMismatch, check_sizes, size_px};
use image::RgbaImage;

/// Pixels whose red, green or blue differ. Alpha is not compared: images are opaque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelDifference {
    /// Pixels of each image.
    pub pixel_count: u64,
    /// Number of differing pixels.
    pub different_count: u64,
    /// The largest difference of a channel, 0 to 255.
    pub largest: u8,
}

impl PixelDifference {
    /// Compares every pixel of `test` with that of `reference`.
    pub fn of(reference: &RgbaImage, test: &RgbaImage) -> Result<Self, SizeMismatch> {
        check_sizes(size_px(reference), size_px(test))?;
        let (mut different_count, mut largest) = (0, 0);
        for (reference, test) in reference.pixels().zip(test.pixels()) {
            let channels = reference.0.iter().zip(test.0).take(3);
            let difference = channels.map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
            different_count += u64::from(difference > 0);
            largest = largest.max(difference);
        }
        Ok(Self {
            pixel_count: u64::from(reference.width()) * u64::from(reference.height()),
            different_count,
            largest,
        })
    }

    /// Part of the pixels that differ, 0 to 1; 0 without any.
    pub fn share(&self) -> f64 {
        self.different_count as f64 / self.pixel_count.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn pixels_are_counted_once_and_alpha_is_not_compared() {
        let reference = RgbaImage::from_pixel(5, 2, Rgba([10, 20, 30, 255]));
        let mut test = reference.clone();
        test.put_pixel(0, 0, Rgba([10, 20, 30, 0]));
        let equal = PixelDifference::of(&reference, &test).unwrap();
        assert_eq!((equal.different_count, equal.largest), (0, 0));
        test.put_pixel(1, 0, Rgba([11, 19, 31, 255]));
        test.put_pixel(4, 1, Rgba([10, 20, 0, 255]));
        let difference = PixelDifference::of(&reference, &test).unwrap();
        assert_eq!((difference.different_count, difference.largest), (2, 30));
        assert_eq!(difference.share(), 0.2);
    }

    #[test]
    fn empty_images_do_not_differ_and_sizes_must_match() {
        let none = RgbaImage::new(0, 0);
        assert_eq!(PixelDifference::of(&none, &none).unwrap().share(), 0.0);
        assert!(PixelDifference::of(&none, &RgbaImage::new(1, 1)).is_err());
    }
}
