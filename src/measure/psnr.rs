//! Peak signal-to-noise ratio (PSNR).
//!
//! How it works: the mean of the squared differences over all pixels and the three colour channels, against the square
//! of the largest possible value, 255. Alpha is not compared: images are opaque. Values are compared as they are stored
//! (display-referred), as in published figures.

use super::{SizeMismatch, check_sizes, size_px};
use image::RgbaImage;

/// The largest value of a channel.
const PEAK: f64 = 255.0;

/// Mean squared difference of red, green and blue, 0 to 255²; 0 for images without pixels.
pub fn mean_squared_error(reference: &RgbaImage, test: &RgbaImage) -> Result<f64, SizeMismatch> {
    check_sizes(size_px(reference), size_px(test))?;
    let sum: u64 = reference
        .pixels()
        .zip(test.pixels())
        .flat_map(|(reference, test)| (0..3).map(|channel| reference[channel].abs_diff(test[channel])))
        .map(|difference| u64::from(difference).pow(2))
        .sum();
    let channels = 3 * u64::from(reference.width()) * u64::from(reference.height());
    Ok(sum as f64 / channels.max(1) as f64)
}

/// The ratio in decibels for a mean squared error of 8-bit channels: 0 for black against white, infinite for equal
/// images. The mean of several images is computed over their errors, not their decibels.
pub fn psnr_db(mean_squared_error: f64) -> f64 {
    10.0 * (PEAK * PEAK / mean_squared_error).log10()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn known_answers() {
        let black = RgbaImage::from_pixel(4, 3, Rgba([0, 0, 0, 255]));
        let white = RgbaImage::from_pixel(4, 3, Rgba([255; 4]));
        assert_eq!(psnr_db(mean_squared_error(&black, &black).unwrap()), f64::INFINITY);
        assert_eq!(mean_squared_error(&black, &white), Ok(PEAK * PEAK));
        assert_eq!(psnr_db(PEAK * PEAK), 0.0);
        // One step in every channel: 20 log10(255).
        let one = RgbaImage::from_pixel(4, 3, Rgba([1, 1, 1, 255]));
        let ratio = psnr_db(mean_squared_error(&black, &one).unwrap());
        assert!((ratio - 48.130_8).abs() < 1e-4, "{ratio}");
        // A tenth of the amplitude is 20 dB.
        assert!((psnr_db(0.01) - psnr_db(1.0) - 20.0).abs() < 1e-9);
    }

    #[test]
    fn alpha_is_ignored_and_every_channel_counts_equally() {
        let reference = RgbaImage::from_pixel(2, 2, Rgba([10, 20, 30, 255]));
        let mut test = reference.clone();
        test.put_pixel(1, 0, Rgba([10, 20, 30, 0]));
        assert_eq!(mean_squared_error(&reference, &test), Ok(0.0));
        for channel in 0..3 {
            let mut test = reference.clone();
            test.get_pixel_mut(1, 1)[channel] += 6;
            assert_eq!(mean_squared_error(&reference, &test), Ok(36.0 / 12.0));
        }
    }

    #[test]
    fn sizes_must_match() {
        let error = mean_squared_error(&RgbaImage::new(4, 3), &RgbaImage::new(3, 4)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a picture of 3x4 pixels cannot be compared with one of 4x3"
        );
    }
}
