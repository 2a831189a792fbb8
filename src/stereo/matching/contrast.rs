//! Contrast check: rejects uniform windows, where there is nothing to match.
//!
//! Sums along paths carry disparities from where they were seen over areas without texture, such as a black background
//! or a sky that is white all over: an object would get a skirt, and all views would agree on it. So a pixel whose
//! window, the 9 × 7 of the census, varies by 2 levels of 255 or less has no label.

use super::constants::{CENSUS_HALF_HEIGHT as HALF_HEIGHT, CENSUS_HALF_WIDTH as HALF_WIDTH, EVEN_WINDOW};
use crate::stereo::GrayImage;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Takes the labels of pixels in even windows away. Precondition: a label a pixel.
pub(in crate::stereo) fn remove_even(image: &GrayImage, labels: &mut [f32]) {
    let [width, height] = [image.width(), image.height()];
    labels.par_chunks_exact_mut(width).enumerate().for_each_init(
        || [vec![0; width], vec![0; width]],
        |[min, max], (y, labels)| {
            dispatch!(Level::new(), _simd => {
                min.fill(u8::MAX);
                max.fill(0);
                for row in y.saturating_sub(HALF_HEIGHT)..(y + HALF_HEIGHT + 1).min(height) {
                    for ((min, max), &pixel) in min.iter_mut().zip(&mut *max).zip(image.row(row)) {
                        *min = (*min).min(pixel);
                        *max = (*max).max(pixel);
                    }
                }
            });
            for (x, label) in labels.iter_mut().enumerate().filter(|(_, label)| !label.is_nan()) {
                let columns = x.saturating_sub(HALF_WIDTH)..(x + HALF_WIDTH + 1).min(width);
                let min = min[columns.clone()].iter().fold(u8::MAX, |min, &pixel| min.min(pixel));
                let max = max[columns].iter().fold(0, |max: u8, &pixel| max.max(pixel));
                if max - min <= EVEN_WINDOW {
                    *label = f32::NAN;
                }
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_near_a_spot_are_retained() {
        let [width, height] = [30, 20];
        for (level, is_seen) in [(52, false), (53, true)] {
            let mut pixels = vec![50; width * height];
            pixels[8 * width + 12] = level;
            let image = GrayImage::new([width as u32, height as u32], pixels).unwrap();
            let mut labels = vec![1.0; width * height];
            remove_even(&image, &mut labels);
            for (at, label) in labels.into_iter().enumerate() {
                let is_near = (at % width).abs_diff(12) <= 4 && (at / width).abs_diff(8) <= 3;
                assert_eq!(!label.is_nan(), is_near && is_seen, "pixel {at}");
            }
        }
    }
}
