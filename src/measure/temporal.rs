//! Temporal error: how far the change from one image to the next is from the change of the truth.
//!
//! How it works: an image that is wrong in the same way in every frame has a spatial error and no temporal one; an
//! image that *flickers* has changes that the truth does not have. So changes are compared, not images:
//!
//! - FLIP between two consecutive images measures the change that a viewer sees when one replaces the other. The same
//!   is done with the truth, and the two are subtracted pixel by pixel. Where the truth is at rest this is the FLIP
//!   between the images.
//! - The difference of the difference images measures by how much each channel changes too much or too little, without
//!   a model of an observer.
//!
//! Both are means over the pixels that show the object in any of the four images; the background never changes.

use super::flip::Perceived;
use super::{ErrorMap, PIXELS_PER_DEGREE, SizeMismatch, check_sizes, size_px};
use image::RgbaImage;

/// Two consecutive images of the same size.
#[derive(Debug, Clone, Copy)]
pub struct Consecutive<'a> {
    /// The earlier one.
    pub before: &'a RgbaImage,
    /// The later one.
    pub after: &'a RgbaImage,
}

/// Error of the change between two consecutive images.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TemporalError {
    /// Mean absolute difference between the FLIP of the images and the FLIP of the truth, 0 to 1.
    pub flip: f64,
    /// Root mean square of the difference of the difference images, as a share of the range of a channel.
    pub difference_rms: f64,
    /// Pixels that are means over.
    pub pixels: usize,
}

impl TemporalError {
    /// Compares the change of `drawn` with that of `truth`, over the pixels for which `is_object` is true. `None` as
    /// truth is a scene at rest under a camera at rest. Without such pixels all is 0.
    ///
    /// # Errors
    /// If the images are not of one size.
    pub fn of(
        truth: Option<Consecutive<'_>>,
        drawn: Consecutive<'_>,
        is_object: impl Fn(usize) -> bool,
    ) -> Result<Self, SizeMismatch> {
        let drawn_flip = drawn.flip()?;
        let truth_flip = truth.map(|truth| truth.flip()).transpose()?;
        if let Some(truth) = truth {
            check_sizes(size_px(truth.after), size_px(drawn.after))?;
        }
        let mut sums = Sums::default();
        for pixel in (0..drawn_flip.errors.len()).filter(|&pixel| is_object(pixel)) {
            let truth_flip = truth_flip.as_ref().map_or(0.0, |flip| flip.errors[pixel]);
            let change = drawn.change(pixel);
            let truth_change = truth.map_or([0; 3], |truth| truth.change(pixel));
            sums.flip += f64::from((drawn_flip.errors[pixel] - truth_flip).abs());
            sums.squared += (0..3)
                .map(|channel| f64::from(change[channel] - truth_change[channel]).powi(2))
                .sum::<f64>();
            sums.pixels += 1;
        }
        Ok(sums.means())
    }
}

#[derive(Default)]
struct Sums {
    flip: f64,
    /// Sum over all three channels, in steps of 8 bits.
    squared: f64,
    pixels: usize,
}

impl Sums {
    fn means(&self) -> TemporalError {
        let count = self.pixels.max(1) as f64;
        TemporalError {
            flip: self.flip / count,
            difference_rms: (self.squared / (3.0 * count)).sqrt() / 255.0,
            pixels: self.pixels,
        }
    }
}

impl Consecutive<'_> {
    fn flip(&self) -> Result<ErrorMap, SizeMismatch> {
        let [before, after] = [self.before, self.after].map(|image| Perceived::of(image, PIXELS_PER_DEGREE));
        before.flip(&after)
    }

    /// Change of red, green and blue of a pixel, in steps of 8 bits.
    fn change(&self, pixel: usize) -> [i32; 3] {
        let width = self.before.width() as usize;
        let [x, y] = [pixel % width, pixel / width].map(|at| at as u32);
        let [before, after] = [self.before, self.after].map(|image| image.get_pixel(x, y).0);
        [0, 1, 2].map(|channel| i32::from(after[channel]) - i32::from(before[channel]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::flip;
    use image::Rgba;

    fn gray(value: u8) -> RgbaImage {
        RgbaImage::from_pixel(32, 24, Rgba([value, value, value, 255]))
    }

    fn error(truth: Option<[&RgbaImage; 2]>, [before, after]: [&RgbaImage; 2]) -> TemporalError {
        let truth = truth.map(|[before, after]| Consecutive { before, after });
        TemporalError::of(truth, Consecutive { before, after }, |_| true).unwrap()
    }

    #[test]
    fn what_is_wrong_in_the_same_way_does_not_flicker() {
        let [truth, drawn] = [gray(200), gray(20)];
        let still = error(Some([&truth, &truth]), [&drawn, &drawn]);
        assert_eq!([still.flip, still.difference_rms], [0.0, 0.0]);
        assert_eq!(still.pixels, 32 * 24);
    }

    #[test]
    fn a_change_that_the_truth_does_not_have_is_the_error() {
        let [before, after] = [gray(100), gray(151)];
        let resting = error(None, [&before, &after]);
        assert!((resting.difference_rms - 0.2).abs() < 1e-12);
        assert!((resting.flip - flip(&before, &after).unwrap().mean()).abs() < 1e-9);
        assert_eq!(error(Some([&before, &before]), [&before, &after]), resting);
        // The same change everywhere, but of a truth that is darker throughout.
        let moving = error(Some([&gray(90), &gray(141)]), [&before, &after]);
        assert_eq!(moving.difference_rms, 0.0);
        // Half of the image, where nothing is shown.
        let missed = error(Some([&before, &after]), [&before, &before]);
        assert_eq!(missed, resting);
    }

    #[test]
    fn only_pixels_of_the_object_count() {
        let before = gray(0);
        let mut after = gray(0);
        after.put_pixel(5, 1, Rgba([255, 0, 0, 255]));
        let drawn = Consecutive {
            before: &before,
            after: &after,
        };
        let one = TemporalError::of(None, drawn, |pixel| pixel == 32 + 5).unwrap();
        assert_eq!((one.pixels, one.difference_rms), (1, (1.0f64 / 3.0).sqrt()));
        let none = TemporalError::of(None, drawn, |_| false).unwrap();
        assert_eq!(none, TemporalError::default());
        let small = RgbaImage::new(3, 3);
        let other = Consecutive {
            before: &small,
            after: &small,
        };
        assert!(TemporalError::of(Some(other), drawn, |_| true).is_err());
    }
}
